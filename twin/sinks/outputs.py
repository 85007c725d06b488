"""Outputs of a run: opened together, completed together, and removed when the run fails."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, TypeAlias

from twin.errors import ArchiveError
from twin.record import Record

if TYPE_CHECKING:
    from twin.sinks.mcap_sink import McapSink
    from twin.sinks.rerun.sink import RerunSink
    from twin.sinks.rerun.web import WebServer

Write: TypeAlias = Callable[[Record], None]


@contextmanager
def opened(
    mcap: Path | None,
    rrd: Path | None,
    *,
    view: bool,
    web: WebServer | None = None,
    force: bool,
    job: Path | None = None,
) -> Iterator[Write]:
    """Open the requested outputs; yields a function that writes a record to all of them.

    They are completed at the end. If the block ends by an exception they are discarded, and no file is left except the
    partial file of an output that could not be written.

    Args:
        mcap: archive to write.
        rrd: rerun recording to write.
        view: show the run in the viewer.
        web: show it in a browser.
        force: replace files that exist.
        job: job file of the run: outputs that were made from it are replaced without ``force``.

    Raises:
        ArchiveError: a file that already exists, cannot be written, or has a wrong suffix.
    """
    sinks: list[McapSink | RerunSink] = []
    _check_suffix(mcap, ".mcap")
    _check_suffix(rrd, ".rrd")
    try:
        if mcap is not None:
            from twin.sinks.mcap_sink import McapSink

            sinks.append(McapSink(mcap, force=force, job=job))
        if rrd is not None or view or web is not None:
            from twin.sinks.rerun.sink import RerunSink

            sinks.append(RerunSink(rrd=rrd, spawn=view, web=web, force=force, job=job))

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
    """Viewers detect the kind of a file by its suffix."""
    if path is not None and path.suffix.lower() != suffix:
        raise ArchiveError(f"{path}: expected a file name that ends in {suffix}")
