"""Files given to the wrong command: recognised by their suffix, text or tables, and named with the right command."""

from __future__ import annotations

import re
import tomllib
from collections.abc import Mapping
from pathlib import Path
from typing import Any

_NC = "an NC program; make its job file with twin job, or check it with: gcode check"
_RUN = "the recording of a run; see: twin info"
_SUFFIXES: dict[str, str] = {
    **dict.fromkeys((".nc", ".ngc", ".tap", ".cnc", ".gcode", ".mpf", ".eia", ".min", ".nct"), _NC),
    **dict.fromkeys((".mcap", ".rrd"), _RUN),
    ".stl": "an STL file; name it in a job file as stock.stl, or plan its paths with: twin paths",
}
_NC_LINE = re.compile(r"\s*(?:%|O\d+|N\d+|/?G\d+|[TSM]\d+|\()", re.IGNORECASE)
#: A table that only one kind of settings file has, the kind, and its command.
_TABLES = (
    ("program", "a replay job", "twin replay"),
    ("part", "a mold job", "twin mold"),
    ("cuts", "a file of test cuts", "twin identify"),
)


def is_nc_program(path: Path) -> bool:
    """Whether a file is an NC program rather than a settings file, by its suffix, else by its text."""
    if path.suffix.lower() == ".toml" or not path.is_file():
        return _SUFFIXES.get(path.suffix.lower()) == _NC
    if path.suffix.lower() in _SUFFIXES:
        return _SUFFIXES[path.suffix.lower()] == _NC
    try:
        tomllib.loads(path.read_text("utf-8", errors="replace"))
    except tomllib.TOMLDecodeError:
        return True
    return False


def kind_by_suffix(path: Path) -> str | None:
    """The kind of a file that is not a settings file, with its command; None for other suffixes."""
    kind = _SUFFIXES.get(path.suffix.lower())
    return None if kind is None else f"{kind} {path}"


def kind_by_text(path: Path, text: str) -> str | None:
    """The kind of a text that is not TOML, with its command; None where it is not recognised."""
    first = next((line for line in text.splitlines() if line.strip()), "")
    return f"{_NC} {path}" if _NC_LINE.match(first) else None


def other_kind(path: Path, data: Mapping[str, Any], own: str) -> str | None:
    """The kind of a settings file, with its command, where it is another one than expected.

    Args:
        own: the table that only the expected kind has.
    """
    if own in data:
        return None
    return next((f"{kind}; run: {command} {path}" for table, kind, command in _TABLES if table in data), None)
