"""The machine and its setup, as the interpreter needs them: offsets, tools, reference points, parameters."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field, fields, replace
from pathlib import Path
from types import MappingProxyType
from typing import Any, Literal

from gcode.events import Point

_ORIGIN: Point = (0.0, 0.0, 0.0)
#: Additional work offsets (G54.1 P) that a control has at most.
ADDITIONAL_OFFSETS = 300
#: Work offsets in the order in which G10 L2 P counts them.
NUMBERED_OFFSETS = (*(f"G{n}" for n in range(54, 60)), *(f"G59.{n}" for n in (1, 2, 3)))
#: Names of all work offsets.
ALL_OFFSETS = (*NUMBERED_OFFSETS, *(f"G54.1 P{n}" for n in range(1, ADDITIONAL_OFFSETS + 1)))


@dataclass(frozen=True, slots=True, kw_only=True)
class ToolOffset:
    """One row of the tool offset table. Lengths are mm.

    Attributes:
        length_mm: length geometry (H), along z.
        length_wear_mm: length wear, added to the geometry.
        radius_mm: radius geometry (D).
        radius_wear_mm: radius wear, added to the geometry.
        x_mm: tool offset in x (LinuxCNC).
        y_mm: tool offset in y (LinuxCNC).
        pocket: pocket in the tool magazine, None if it has none.
        orientation: tip orientation (1 to 9) of a lathe tool, 0 for a milling tool; 9 is treated as 0.
        comment: description.

    Raises:
        ValueError: for a length that is not finite, naming it.
    """

    length_mm: float = 0.0
    length_wear_mm: float = 0.0
    radius_mm: float = 0.0
    radius_wear_mm: float = 0.0
    x_mm: float = 0.0
    y_mm: float = 0.0
    pocket: int | None = None
    orientation: int = 0
    comment: str = ""

    def __post_init__(self) -> None:
        for entry in fields(self):
            if entry.name.endswith("_mm"):
                object.__setattr__(self, entry.name, _length(entry.name, getattr(self, entry.name)))

    def with_column(self, name: str, value: float) -> ToolOffset:
        """This row with another value in the column of that name."""
        return replace(self, **{name: value})  # type: ignore[arg-type]

    @property
    def whole_length_mm(self) -> float:
        """Length offset that H activates: geometry and wear."""
        return self.length_mm + self.length_wear_mm

    @property
    def whole_radius_mm(self) -> float:
        """Radius that D activates: geometry and wear."""
        return self.radius_mm + self.radius_wear_mm


@dataclass(frozen=True, slots=True, kw_only=True)
class Limits:
    """Limits beyond which a program is refused as a runaway.

    An endless loop takes about 25 us a block, so the defaults refuse one within ten seconds; a macro that mills a field
    of 500 by 500 points stays below them.

    Attributes:
        blocks: blocks executed in all.
        repeated: blocks executed beyond the number of lines of the program and its subprograms, that is again and
            again, by loops and repeats. Runs of plain lines are not counted.
        jumps: backward jumps executed in all: loops, and repeats of subprograms and macros.
        idle_jumps: backward jumps executed one after another without a motion between them.
        nesting: depth of subprogram and macro calls.
        errors: number of errors after which a check stops.
    """

    blocks: int = 20_000_000
    repeated: int = 300_000
    jumps: int = 1_000_000
    idle_jumps: int = 40_000
    nesting: int = 64
    errors: int = 200


@dataclass(frozen=True, slots=True, kw_only=True)
class MachineSettings:
    """A machine at the start of a program. All lengths are mm, in machine coordinates.

    Attributes:
        offsets: work offsets by name (`ALL_OFFSETS`): the position of each work zero; by default all are at machine
            zero. Only those given, and those that the program sets by G10, may be used.
        rotations_deg: rotation about z of each work offset, counter-clockwise; 0 for those not given.
        wcs: work offset that is active at the start of the program.
        shift_mm: G92 shift that is active at the start of the program.
        external_offset_mm: external (common) work offset, added to every work offset.
        home_mm: gauge point at the reference point of G28.
        reference_points_mm: gauge point at each further reference point (G30 P2, P3, P4), by number.
        start_mm: gauge point at the start of the program.
        tools: tool offset table: rows by number, which H, D or T name. None where it is not known: every length and
            radius then counts as 0, with a notice.
        tool: number of the tool in the spindle at the start of the program, 0 for none.
        variables: values of common variables or persistent parameters at the start of the program, by number.
        search_path: folders of subprogram files, searched after the folder of the program.
        arc_tolerance_mm: largest difference of the radii at the two ends of an arc; None for the dialect's own rule.
        arc_centres: I, J, K at the start of the program: ``incremental`` from the arc's start point, or ``absolute``.
        block_delete: True if the block delete switch is on.
        optional_stop: True if the optional stop switch is on; the `ProgramStop` event reports it.
        units: unit of lengths and feeds until the first G20 or G21.
        g70_units: G70 and G71 set inches and millimetres as G20 and G21 do, as on Mach3 and in some posts of NX.
        machine_units: unit of the machine's offset variables, as a program reads and sets them (LinuxCNC).
        decimal_point: numbers without a decimal point: ``calculator``: X100 is 100 mm; ``increment``: X100 is 100 least
            input increments (0.001 mm or 0.0001 inch each). FANUC: parameter 3401 bit 0.
        compensation_startup: type of start-up and cancel of FANUC's cutter compensation (parameter 5003 bits 0, 1).
        m_codes: M codes of the machine builder by number, which the dialect does not have: ``none``, the code moves
            nothing; each use is reported by a notice.
        limits: see `Limits`.

    Raises:
        ValueError: for a value that is not finite, or out of its range, naming it.
    """

    offsets: Mapping[str, Point] = field(default_factory=lambda: dict.fromkeys(ALL_OFFSETS, _ORIGIN))
    rotations_deg: Mapping[str, float] = field(default_factory=dict)
    wcs: str = "G54"
    shift_mm: Point = _ORIGIN
    external_offset_mm: Point = _ORIGIN
    home_mm: Point = _ORIGIN
    reference_points_mm: Mapping[int, Point] = field(default_factory=dict)
    start_mm: Point = _ORIGIN
    tools: Mapping[int, ToolOffset] | None = None
    tool: int = 0
    variables: Mapping[int, float] = field(default_factory=dict)
    search_path: tuple[Path, ...] = ()
    arc_tolerance_mm: float | None = None
    arc_centres: Literal["incremental", "absolute"] = "incremental"
    block_delete: bool = False
    optional_stop: bool = False
    units: Literal["mm", "inch"] = "mm"
    g70_units: bool = False
    machine_units: Literal["mm", "inch"] = "mm"
    decimal_point: Literal["calculator", "increment"] = "calculator"
    compensation_startup: Literal["A", "B"] = "A"
    m_codes: Mapping[int, Literal["none"]] = field(default_factory=dict)
    limits: Limits = Limits()

    def __post_init__(self) -> None:
        self._freeze("offsets", {name: _point(f"offsets[{name!r}]", value) for name, value in self.offsets.items()})
        self._freeze("rotations_deg", {n: _length(f"rotations_deg[{n!r}]", v) for n, v in self.rotations_deg.items()})
        points = {n: _point(f"reference_points_mm[{n}]", v) for n, v in self.reference_points_mm.items()}
        self._freeze("reference_points_mm", points)
        if self.tools is not None:
            self._freeze("tools", {**self.tools})
        self._freeze("variables", {n: _length(f"variables[{n}]", v) for n, v in self.variables.items()})
        for number, effect in self.m_codes.items():
            if number < 0:
                raise ValueError(f"m_codes: {number} is not the number of an M code")
            _choice(f"m_codes[{number}]", effect, ("none",))
        self._freeze("m_codes", {**self.m_codes})
        for name in ("shift_mm", "external_offset_mm", "home_mm", "start_mm"):
            object.__setattr__(self, name, _point(name, getattr(self, name)))
        object.__setattr__(self, "search_path", tuple(Path(folder) for folder in self.search_path))
        if self.tool < 0:
            raise ValueError(f"tool must be 0 or more, got {self.tool}")
        if self.arc_tolerance_mm is not None and _length("arc_tolerance_mm", self.arc_tolerance_mm) < 0.0:
            raise ValueError(f"arc_tolerance_mm must be 0 or more, got {self.arc_tolerance_mm}")
        _choice("arc_centres", self.arc_centres, ("incremental", "absolute"))
        _choice("units", self.units, ("mm", "inch"))
        _choice("machine_units", self.machine_units, ("mm", "inch"))
        _choice("decimal_point", self.decimal_point, ("calculator", "increment"))
        _choice("compensation_startup", self.compensation_startup, ("A", "B"))

    def _freeze(self, name: str, values: Mapping[Any, Any]) -> None:
        object.__setattr__(self, name, MappingProxyType(values))


def _length(name: str, value: float) -> float:
    if not math.isfinite(value):
        raise ValueError(f"{name} must be finite, got {value}")
    return float(value)


def _point(name: str, value: Point) -> Point:
    if len(value) != 3 or not all(math.isfinite(x) for x in value):
        raise ValueError(f"{name} must be three finite lengths, got {value}")
    return (float(value[0]), float(value[1]), float(value[2]))


def _choice(name: str, value: str, allowed: tuple[str, ...]) -> None:
    if value not in allowed:
        raise ValueError(f"{name} must be one of {', '.join(allowed)}, got {value!r}")
