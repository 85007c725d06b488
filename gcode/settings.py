"""What the interpreter must be told about the machine and the setup: offsets, reference point, start-up units."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from types import MappingProxyType
from typing import Literal

from gcode.events import Point

_ORIGIN: Point = (0.0, 0.0, 0.0)


@dataclass(frozen=True, slots=True, kw_only=True)
class MachineSettings:
    """A machine as it stands when the program starts. All lengths are mm, in machine coordinates.

    Attributes:
        offsets: work offsets by name (``G54``): the place of each work zero. Only those given may be used.
        home_mm: gauge point at the reference point that G28 goes to.
        start_mm: gauge point when the program starts.
        length_offsets_mm: tool length offsets by H number; H0 is always 0 in controls that count offsets from 1.
        tool: number of the tool in the spindle when the program starts, 0 for none.
        arc_tolerance_mm: how far the radii at an arc's two ends may differ; None for the dialect's own rule.
        arc_centres: whether I, J, K at start-up are measured from the arc's start or are coordinates.
        block_delete: True where the block delete switch is on.
        units: what lengths and feeds mean until the program says G20 or G21.

    Raises:
        ValueError: for a value that is not finite, or out of its range, naming it.
    """

    offsets: Mapping[str, Point] = field(default_factory=lambda: {"G54": _ORIGIN})
    home_mm: Point = _ORIGIN
    start_mm: Point = _ORIGIN
    length_offsets_mm: Mapping[int, float] = field(default_factory=dict)
    tool: int = 0
    arc_tolerance_mm: float | None = None
    arc_centres: Literal["incremental", "absolute"] = "incremental"
    block_delete: bool = False
    units: Literal["mm", "inch"] = "mm"

    def __post_init__(self) -> None:
        offsets = {name: _point(f"offsets[{name!r}]", value) for name, value in self.offsets.items()}
        lengths = {number: _length(f"length_offsets_mm[{number}]", v) for number, v in self.length_offsets_mm.items()}
        object.__setattr__(self, "offsets", MappingProxyType(offsets))
        object.__setattr__(self, "length_offsets_mm", MappingProxyType(lengths))
        object.__setattr__(self, "home_mm", _point("home_mm", self.home_mm))
        object.__setattr__(self, "start_mm", _point("start_mm", self.start_mm))
        if self.tool < 0:
            raise ValueError(f"tool must be 0 or more, got {self.tool}")
        if self.arc_tolerance_mm is not None and _length("arc_tolerance_mm", self.arc_tolerance_mm) < 0.0:
            raise ValueError(f"arc_tolerance_mm must be 0 or more, got {self.arc_tolerance_mm}")
        _choice("arc_centres", self.arc_centres, ("incremental", "absolute"))
        _choice("units", self.units, ("mm", "inch"))


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
