"""Checks of output files before long work: names, folders, and files that exist already."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from pathlib import Path

from gcode.report.plot import PlotError, check_picture
from twin.errors import ToolPathError


def refuse_existing(paths: Iterable[Path], *, force: bool) -> None:
    """Check that no file would be replaced.

    Raises:
        ToolPathError: a file exists already, unless ``force``.
    """
    for path in paths:
        if path.exists() and not force:
            raise ToolPathError(f"{path}: already exists; replace it with --force")


def check_outputs(files: Mapping[str, Path | None], *, force: bool) -> None:
    """Check that files can be written.

    Args:
        files: by kind, None for a file that is not requested; kinds ``picture`` and ``recording`` have their suffixes.
        force: whether files that exist may be replaced.

    Raises:
        ToolPathError: a missing folder, a wrong suffix, a file that exists already, or two outputs with one name.
    """
    given = {kind: path for kind, path in files.items() if path is not None}
    for kind, path in given.items():
        if not path.absolute().parent.is_dir():
            raise ToolPathError(f"{path}: there is no folder {path.parent}; expected one that exists")
        if kind == "recording" and path.suffix.lower() != ".rrd":
            raise ToolPathError(f"{path}: expected a file name that ends in .rrd")
        if kind == "picture":
            try:
                check_picture(path)
            except PlotError as error:
                raise ToolPathError(str(error)) from None
    refuse_existing(given.values(), force=force)
    if len(set(given.values())) < len(given):
        raise ToolPathError("two outputs have the same name; expected a name for each")
