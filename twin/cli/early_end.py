"""A warning where an archive ends early."""

from __future__ import annotations

from pathlib import Path


def warn_of_early_end(run: Path) -> None:
    """Warn if the file is that of a run that was killed, or a part of a copy.

    Raises:
        ArchiveError: not the file of a run.
    """
    from twin.archive.container.frames import RunFile
    from twin.cli.console import warn

    with RunFile(run) as file:
        if file.footer() is None:
            warn(f"{run}: ends early; what it has up to there is used")
