"""Differences between controls in the programs written for them, as a table.

Codes and words of a control are in the interpreter's own tables (`gcode.dialects`).
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from types import MappingProxyType
from typing import Literal


@dataclass(frozen=True, slots=True, kw_only=True)
class OutputRules:
    """How programs for one control are written.

    Attributes:
        safe_start: words of the block that sets known modes at the program's start.
        decimals: digits after the point by unit.
        percent: whether a program is enclosed in percent signs; None where the control has none.
        program_digits: digits of the O number, 0 where a program has none.
        most_block_number: largest N; after it numbers start again.
        speed_decimals: digits after the point of S.
        tap: ``cycle`` for G84 and G74, ``stroke`` for G33.1, ``none``.
    """

    safe_start: str
    decimals: Mapping[str, int]
    percent: bool | None
    program_digits: int
    most_block_number: int
    speed_decimals: int
    tap: Literal["cycle", "stroke", "none"]


_FANUC = OutputRules(
    safe_start="G17 G40 G49 G80 G90 G94",
    decimals=MappingProxyType({"mm": 3, "inch": 4}),
    percent=True,
    program_digits=4,
    most_block_number=99_999,
    speed_decimals=0,
    tap="cycle",
)
_LINUXCNC = OutputRules(
    safe_start="G17 G40 G49 G80 G90 G91.1 G94",
    decimals=MappingProxyType({"mm": 4, "inch": 5}),
    percent=False,
    program_digits=0,
    most_block_number=99_999,
    speed_decimals=3,
    tap="stroke",
)

#: The rules by the dialect's name.
RULES: Mapping[str, OutputRules] = MappingProxyType(
    {
        "fanuc": _FANUC,
        "haas": replace(_FANUC, program_digits=5),
        "linuxcnc": _LINUXCNC,
        "grbl": replace(_LINUXCNC, percent=None, tap="none"),
    }
)
