"""Files of a result, each whole or not at all: all are written under temporary names before one gets its own."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

from twin.archive.container.partial import PartialFile


def refuse_existing(paths: list[Path], *, force: bool) -> None:
    """Refuse names that are taken, before any work is done.

    Raises:
        ArchiveError: a file is there and ``force`` is not.
    """
    for path in paths:
        PartialFile(path, force=force).discard()


def write_files(contents: Mapping[Path, bytes], *, force: bool) -> None:
    """Write files.

    Args:
        force: replace files that are there.

    Raises:
        ArchiveError: a file is there already, or cannot be written; then no file is left.
    """
    files: list[PartialFile] = []
    try:
        for path, data in contents.items():
            files.append(PartialFile(path, force=force))
            files[-1].write(data)
        for file in files:
            file.commit()
    except BaseException:
        for file in files:
            file.discard()
        raise
