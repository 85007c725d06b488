"""Where the records of a run go: opened together, finished together, and gone when the run fails."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TypeAlias

from twin.errors import ArchiveError
from twin.record import Record

Write: TypeAlias = Callable[[Record], None]


@contextmanager
def opened(mcap: Path | None, rrd: Path | None, *, view: bool, force: bool) -> Iterator[Write]:
    """Open the outputs asked for and give what writes a record to all of them.

    They are finished at the end. When the block ends by an exception they are given up, and no file is left, but for
    what an output that could not be written keeps itself under its partial name.

    Args:
        view: show the run in the viewer.
        force: replace files that are there.

    Raises:
        ArchiveError: a file that is there already, or cannot be written, or has a wrong suffix.
    """
    sinks: list[McapSink | RerunSink] = []
    _check_suffix(mcap, ".mcap")
    _check_suffix(rrd, ".rrd")
    try:
        if mcap is not None:
            from twin.sinks.mcap_sink import McapSink

            sinks.append(McapSink(mcap, force=force))
        if rrd is not None or view:
            from twin.sinks.rerun.sink import RerunSink

            sinks.append(RerunSink(rrd=rrd, spawn=view, force=force))

        def write(record: Record) -> None:
            for sink in sinks:
                sink.write(record)

        yield write
        for sink in sinks:
            sink.close()
    except BaseException:
        for sink in sinks:
            sink.discard()
        raise


def _check_suffix(path: Path | None, suffix: str) -> None:
    """Viewers go by it."""
    if path is not None and path.suffix.lower() != suffix:
        raise ArchiveError(f"{path}: expected a file name that ends in {suffix}")
