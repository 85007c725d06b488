"""Dialects as data: the codes, words and rules of each control."""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType

from gcode.dialects.dialect import ArcTolerance, Dialect, DwellWord
from gcode.dialects.fanuc import FANUC
from gcode.dialects.grbl import GRBL
from gcode.dialects.haas import HAAS
from gcode.dialects.linuxcnc import LINUXCNC

__all__ = [
    "AUTO",
    "DIALECTS",
    "FANUC",
    "GRBL",
    "HAAS",
    "LINUXCNC",
    "ArcTolerance",
    "Dialect",
    "DwellWord",
    "dialect_named",
]

#: Stands for the dialect that a program fits best.
AUTO = "auto"
DIALECTS: Mapping[str, Dialect] = MappingProxyType({d.name: d for d in (FANUC, HAAS, LINUXCNC, GRBL)})


def dialect_named(name: str) -> Dialect:
    """The dialect of that name.

    Raises:
        ValueError: for a name that is none of `DIALECTS`.
    """
    if name not in DIALECTS:
        raise ValueError(f"unknown dialect {name!r}; expected one of {', '.join(DIALECTS)}")
    return DIALECTS[name]
