"""The control's memory between two blocks, as immutable values: a refused block cannot leave half a change behind."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from types import MappingProxyType
from typing import Any

from gcode.dialects import Dialect
from gcode.events import MotionState, Point
from gcode.settings import MachineSettings

MM_PER_INCH = 25.4


@dataclass(frozen=True, slots=True, kw_only=True)
class Control:
    """What does not change while a program runs: the dialect and the machine's settings."""

    dialect: Dialect
    settings: MachineSettings


@dataclass(frozen=True, slots=True, kw_only=True)
class Modes:
    """Modal values that decide how words are read.

    Attributes:
        motion: active motion code, ``G0`` to ``G3``, or ``G80`` for none.
        absolute: True for G90.
        unit_mm: length of the program's unit: 1 for G21, 25.4 for G20.
        absolute_centres: True where I, J, K are coordinates of an arc's centre.
        feed_mm_min: programmed feed, 0 before the first.
        next_tool: tool of the last T word, None before the first.
        length_code: ``G43``, ``G44`` or ``G49``.
        length_number: number of the last H word, None before the first.
        unmoved_length_mm: change of the length offset that no Z word has acted on yet.
        mist: True while M7 is on.
        flood: True while M8 is on.
        program: number of the O word, None before it.
    """

    motion: str
    absolute: bool = True
    unit_mm: float = 1.0
    absolute_centres: bool = False
    feed_mm_min: float = 0.0
    next_tool: int | None = None
    length_code: str = "G49"
    length_number: int | None = None
    unmoved_length_mm: float = 0.0
    mist: bool = False
    flood: bool = False
    program: int | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class State:
    """Everything that the next block depends on.

    Attributes:
        control: dialect and settings.
        modes: how words are read.
        machine: the modal values that motions carry.
        position_mm: controlled point in machine coordinates, mm.
        started: True once a percent sign or a block with words was read.
        ended: True after the program's end.
    """

    control: Control
    modes: Modes
    machine: MotionState
    position_mm: Point
    started: bool = False
    ended: bool = False

    @property
    def gauge_mm(self) -> Point:
        """Gauge point in machine coordinates: the controlled point and the active length offset."""
        x, y, z = self.position_mm
        return (x, y, z + self.machine.length_offset_mm)

    def tip_of(self, gauge_mm: Point) -> Point:
        """Controlled point where the gauge point is at `gauge_mm`."""
        x, y, z = gauge_mm
        return (x, y, z - self.machine.length_offset_mm)

    def with_modes(self, **changes: Any) -> State:
        """This state with other modes."""
        return replace(self, modes=replace(self.modes, **changes))

    def with_machine(self, **changes: Any) -> State:
        """This state with other values of `MotionState`."""
        return replace(self, machine=replace(self.machine, **changes))


#: Field of `Modes` and its value, for every code whose whole effect is one mode.
MODE_OF_CODE: Mapping[str, tuple[str, object]] = MappingProxyType(
    {
        **{code: ("motion", code) for code in ("G0", "G1", "G2", "G3", "G80")},
        "G20": ("unit_mm", MM_PER_INCH),
        "G21": ("unit_mm", 1.0),
        "G90": ("absolute", True),
        "G91": ("absolute", False),
        "G90.1": ("absolute_centres", True),
        "G91.1": ("absolute_centres", False),
    }
)

#: Plane of every plane code.
PLANE_OF_CODE: Mapping[str, int] = MappingProxyType({"G17": 17, "G18": 18, "G19": 19})


def initial_state(dialect: Dialect, settings: MachineSettings) -> State:
    """The control at power-on: G54, G17, G90, G94, G49, no feed, the spindle stopped."""
    modes = Modes(
        motion=dialect.power_on_motion,
        unit_mm=MM_PER_INCH if settings.units == "inch" else 1.0,
        absolute_centres=settings.arc_centres == "absolute",
    )
    return State(
        control=Control(dialect=dialect, settings=settings),
        modes=modes,
        machine=MotionState(tool=settings.tool, wcs="G54"),
        position_mm=settings.start_mm,
    )
