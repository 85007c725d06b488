"""Options of a written program."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace
from types import MappingProxyType
from typing import Literal

from gcode.dialects import FANUC, Dialect
from gcode.events import Point
from gcode.settings import ALL_OFFSETS, MachineSettings, ToolOffset
from gcode.write.numbers import MM_PER_INCH, Grid
from gcode.write.output_rules import RULES, OutputRules

#: Most decimals; more are finer than the distance at which two positions are one.
MOST_DECIMALS = 6


@dataclass(frozen=True, slots=True, kw_only=True)
class WriteOptions:
    """How a program is written.

    Coordinates: events have controlled points in machine coordinates; a program has these less ``shift_mm``. With the
    default, program coordinates are machine coordinates, and the control needs its work offset at zero; with the
    position of the work zero as ``shift_mm`` the coordinates are those of the workpiece.

    Attributes:
        dialect: the control.
        units: unit of lengths and feeds: G21 or G20.
        distance: ``absolute`` (G90) or ``incremental`` (G91; the first motion, and the first after a change of tool or
            of its length offset, is in G90 all the same, because only that is safe).
        arcs: ``centre`` (I, J, K), or ``radius``: R where the control finds the same centre from it, which it does not
            near half a turn, for tiny arcs and for full circles; these keep I, J, K.
        decimals: digits after the point of coordinates, 0 to 6; None for the usual number: 3 in mm and 4 in inch for
            FANUC and Haas, one more for LinuxCNC and GRBL.
        modal: whether words that the control already holds are omitted.
        number_step: step of the block numbers, None for none.
        program_number: number of the O word, None for none; only FANUC and Haas have one.
        percent: whether the program is enclosed in percent signs; None for the usual choice.
        header: comments at the program's beginning, a line each; printable ASCII without parentheses.
        safe_start: whether a block at the beginning sets known modes (G17 G40 G49 G80 G90 G94).
        wcs: work offset to call at the beginning, e.g. ``G54`` or ``G54.1 P3``, None for none.
        shift_mm: work zero in machine coordinates, which is subtracted from all points.
        tools: tool offset table of the control that will run the program. Where it is given, each G43 is checked
            against it, and G44 is written where the stream subtracts a length. Without it every H is written as G43.
        tool: number of the tool that is in the spindle when the program starts.

    Raises:
        ValueError: for what the dialect does not have, or a value out of range, naming it.
    """

    dialect: Dialect = FANUC
    units: Literal["mm", "inch"] = "mm"
    distance: Literal["absolute", "incremental"] = "absolute"
    arcs: Literal["centre", "radius"] = "centre"
    decimals: int | None = None
    modal: bool = True
    number_step: int | None = None
    program_number: int | None = None
    percent: bool | None = None
    header: tuple[str, ...] = ()
    safe_start: bool = True
    wcs: str | None = "G54"
    shift_mm: Point = (0.0, 0.0, 0.0)
    tools: Mapping[int, ToolOffset] | None = None
    tool: int = 0

    def __post_init__(self) -> None:
        _choice("dialect", self.dialect.name, tuple(RULES))
        _choice("units", self.units, ("mm", "inch"))
        _choice("distance", self.distance, ("absolute", "incremental"))
        _choice("arcs", self.arcs, ("centre", "radius"))
        _within("decimals", self.decimals, 0, MOST_DECIMALS)
        _within("number_step", self.number_step, 1, 1000)
        if self.tool < 0:
            raise ValueError(f"tool must be 0 or more, got {self.tool}")
        if len(self.shift_mm) != 3 or not all(math.isfinite(value) for value in self.shift_mm):
            raise ValueError(f"shift_mm must be three finite lengths, got {self.shift_mm}")
        self._check_header()
        self._check_dialect()
        if self.tools is not None:
            object.__setattr__(self, "tools", MappingProxyType({**self.tools}))

    def _check_header(self) -> None:
        object.__setattr__(self, "header", tuple(self.header))
        for line in self.header:
            if not line.isascii() or not line.isprintable() or "(" in line or ")" in line:
                raise ValueError(f"header must be printable ASCII without parentheses, got {line!r}")

    def _check_dialect(self) -> None:
        name, rules = self.dialect.name, self.rules
        if self.program_number is not None and not rules.program_digits:
            raise ValueError(f"program_number: {name} has no program numbers, got {self.program_number}")
        _within("program_number", self.program_number, 1, 10**rules.program_digits - 1)
        if self.percent and rules.percent is None:
            raise ValueError(f"percent: {name} has no percent signs")
        offsets = [code for code, rule in self.dialect.codes.items() if "work-offset" in rule.groups]
        if self.wcs is not None and (self.wcs not in ALL_OFFSETS or self.wcs.partition(" ")[0] not in offsets):
            raise ValueError(f"wcs must be one of {', '.join(offsets)}, got {self.wcs!r}")

    def for_machine(self, settings: MachineSettings) -> WriteOptions:
        """These options with the zero of work offset `wcs`, the tool table and the tool of a machine."""
        x, y, z = settings.offsets.get(self.wcs or "", (0.0, 0.0, 0.0))
        dx, dy, dz = settings.external_offset_mm
        return replace(self, shift_mm=(x + dx, y + dy, z + dz), tools=settings.tools, tool=settings.tool)

    @property
    def rules(self) -> OutputRules:
        """The output rules of the dialect."""
        return RULES[self.dialect.name]

    @property
    def unit_mm(self) -> float:
        """Length of the program's unit."""
        return MM_PER_INCH if self.units == "inch" else 1.0

    @property
    def grid(self) -> Grid:
        """The points that the program can name."""
        decimals = self.rules.decimals[self.units] if self.decimals is None else self.decimals
        return Grid(self.unit_mm, decimals, self.shift_mm)

    @property
    def with_percent(self) -> bool:
        """Whether percent signs are written."""
        return bool(self.rules.percent if self.percent is None else self.percent)


def _choice(name: str, value: str, allowed: tuple[str, ...]) -> None:
    if value not in allowed:
        raise ValueError(f"{name} must be one of {', '.join(allowed)}, got {value!r}")


def _within(name: str, value: int | None, least: int, most: int) -> None:
    if value is not None and not least <= value <= most:
        raise ValueError(f"{name} must be from {least} to {most}, got {value}")
