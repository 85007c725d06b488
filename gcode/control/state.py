"""The state of the control between two blocks, as immutable values: a refused block leaves it unchanged."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from types import MappingProxyType
from typing import Any

from gcode.control.coordinates import ORIGIN, SAME_POSITION_MM, CoordinateFrame, Transform, coordinate_frame, rotation
from gcode.control.waiting import WaitingPath
from gcode.dialects import Dialect
from gcode.events import NO_EXTRA, Extra, MotionState, Point
from gcode.settings import MachineSettings, ToolOffset

MM_PER_INCH = 25.4
AXES = "XYZ"
#: Letters of `Extra`, in its order.
EXTRA_AXES = "ABCUVW"


@dataclass(frozen=True, slots=True, kw_only=True)
class Control:
    """The constant part of the state: the dialect and the machine's settings."""

    dialect: Dialect
    settings: MachineSettings

    @property
    def machine_unit_mm(self) -> float:
        """Length of the machine's own unit, in which offset variables count."""
        return MM_PER_INCH if self.settings.machine_units == "inch" else 1.0


@dataclass(frozen=True, slots=True, kw_only=True)
class WorkOffset:
    """One work offset: zero of the axes X, Y, Z (mm), of the further axes, and a rotation about z, degrees."""

    zero_mm: Point = ORIGIN
    extra: Extra = NO_EXTRA
    rotation_deg: float = 0.0


@dataclass(frozen=True, slots=True, kw_only=True)
class Setup:
    """Offset memory, which a program can change.

    Attributes:
        offsets: work offsets by name.
        external_mm: added to every work offset.
        tools: tool offset table by number.
        references: reference points by number, 1 that of G28; positions of the further axes are 0.
        shift: shift of coordinates by G92 (and by G52 where it is the same register).
        shift_on: False where G92.2 has suspended the shift.
        local_mm: local coordinate system (G52) where it is a register of its own.
    """

    offsets: Mapping[str, WorkOffset]
    external_mm: Point = ORIGIN
    tools: Mapping[int, ToolOffset] = field(default_factory=dict)
    references: Mapping[int, tuple[Point, Extra]] = field(default_factory=dict)
    shift: WorkOffset = WorkOffset()
    shift_on: bool = True
    local_mm: Point = ORIGIN


@dataclass(frozen=True, slots=True, kw_only=True)
class Modes:
    """Modal values that determine how words are read.

    Attributes:
        motion: active motion code, ``G0`` to ``G3``, a canned cycle, or ``G80`` for none.
        base_motion: the last motion code that was not a canned cycle.
        absolute: True for G90.
        unit_mm: length of the program's unit: 1 for G21, 25.4 for G20.
        absolute_centres: True where I, J, K are coordinates of an arc's centre.
        feed: programmed feed: mm/min (G94), 1/min (G93) or mm a revolution (G95); 0 before the first.
        next_tool: tool of the last T word, None before the first.
        length_code: ``G43``, ``G44`` or ``G49``.
        length_number: number of the last H word, None before the first.
        unmoved_length_mm: change of the length offset that no Z word has acted on yet.
        radius_number: number of the last D word, None before the first.
        mist: True while M7 is on.
        flood: True while M8 is on.
        program: number of the O word, None before it.
        return_to_r: True for G99.
        in_cycle: True once a block was run in the active canned cycle's mode.
        cycle_words: words that canned cycles keep, by letter.
        rigid_tapping: True after M29, until the cycle ends.
        initial_level_mm: level along the plane's normal (program coordinates) that G98 returns to.
        via_mm: intermediate point of the last return to a reference point, None before it.
        spline_lead_mm: first control point that a following G5 without I and J takes, from its start; None for none.
        polar: True while X, Y are a radius and an angle (G16).
        polar_centre_mm: centre of polar coordinates, program coordinates; None for the program zero.
        transforms: rotation, scaling and mirror image of program coordinates by the code that set them.
        surface_speed: G96's speed, m/min; None with G97.
        surface_speed_limit: largest spindle speed with G96, rpm; None without one.
        diameter: True while X words are diameters (G7).
        entering_data: True between G10 L3 or L50 and G11, where blocks are data.
    """

    motion: str
    base_motion: str = "G0"
    absolute: bool = True
    unit_mm: float = 1.0
    absolute_centres: bool = False
    feed: float = 0.0
    next_tool: int | None = None
    length_code: str = "G49"
    length_number: int | None = None
    unmoved_length_mm: float = 0.0
    radius_number: int | None = None
    mist: bool = False
    flood: bool = False
    program: int | None = None
    return_to_r: bool = False
    in_cycle: bool = False
    cycle_words: Mapping[str, float] = field(default_factory=dict)
    rigid_tapping: bool = False
    initial_level_mm: float = 0.0
    via_mm: Point | None = None
    spline_lead_mm: tuple[float, float] | None = None
    polar: bool = False
    polar_centre_mm: Point | None = None
    transforms: Mapping[str, Transform] = field(default_factory=dict)
    surface_speed: float | None = None
    surface_speed_limit: float | None = None
    diameter: bool = False
    entering_data: bool = False


@dataclass(frozen=True, slots=True, kw_only=True)
class State:
    """Everything that the next block depends on, except variables and the line in the program.

    Attributes:
        control: dialect and settings.
        modes: how words are read.
        machine: the modal values that motions carry.
        setup: offset memory.
        frame: program coordinates in machine coordinates; follows from the others (`reframed`).
        position_mm: controlled point as programmed, machine coordinates, mm.
        extra: positions of the further axes, machine coordinates.
        waiting: corner and cutter compensation that wait for the next motion, None where nothing waits.
        started: True once a percent sign or a block with words was read.
        ended: True after the program's end.
    """

    control: Control
    modes: Modes
    machine: MotionState
    setup: Setup
    frame: CoordinateFrame
    position_mm: Point
    extra: Extra = NO_EXTRA
    waiting: WaitingPath | None = None
    started: bool = False
    ended: bool = False

    @property
    def compensates(self) -> bool:
        """True while cutter compensation is on."""
        return self.waiting is not None and self.waiting.compensates

    @property
    def tool_offset_mm(self) -> Point:
        """Active tool offset: gauge point less controlled point."""
        x, y = self.machine.tool_offset_xy_mm
        return (x, y, self.machine.length_offset_mm)

    @property
    def gauge_mm(self) -> Point:
        """Gauge point in machine coordinates: the controlled point and the active tool offset."""
        (x, y, z), (a, b, c) = self.position_mm, self.tool_offset_mm
        return (x + a, y + b, z + c)

    @property
    def program_mm(self) -> Point:
        """Controlled point in program coordinates."""
        return self.frame.to_program(self.position_mm)

    def tip_of(self, gauge_mm: Point) -> Point:
        """Controlled point where the gauge point is at `gauge_mm`."""
        (x, y, z), (a, b, c) = gauge_mm, self.tool_offset_mm
        return (x - a, y - b, z - c)

    def with_modes(self, **changes: Any) -> State:
        """This state with other modes."""
        return replace(self, modes=replace(self.modes, **changes))

    def with_machine(self, **changes: Any) -> State:
        """This state with other values of `MotionState`."""
        return replace(self, machine=replace(self.machine, **changes))

    def with_setup(self, **changes: Any) -> State:
        """This state with other offsets, and the frame that follows."""
        return replace(self, setup=replace(self.setup, **changes)).reframed()

    def reframed(self) -> State:
        """This state with the frame that its offsets and modes make."""
        return replace(self, frame=_frame(self))


#: Order in which the maps of program coordinates act on a point.
TRANSFORM_ORDER = ("mirror", "scaling", "rotation")


def _frame(state: State) -> CoordinateFrame:
    setup, dialect = state.setup, state.control.dialect
    offset = setup.offsets.get(state.machine.wcs, WorkOffset())
    shift = setup.shift if setup.shift_on else WorkOffset()
    zero = tuple(map(sum, zip(offset.zero_mm, setup.external_mm, setup.local_mm, strict=True)))
    extra = tuple(a + b for a, b in zip(offset.extra, shift.extra, strict=True))
    transforms = tuple(state.modes.transforms[name] for name in TRANSFORM_ORDER if name in state.modes.transforms)
    if offset.rotation_deg:
        transforms = (*transforms, rotation(17, offset.rotation_deg))
    if dialect.shift_is_rotated:
        return coordinate_frame(_point(zero), transforms, shift_mm=shift.zero_mm, extra=extra)  # type: ignore[arg-type]
    zero = tuple(a + b for a, b in zip(zero, shift.zero_mm, strict=True))
    return coordinate_frame(_point(zero), transforms, extra=extra)  # type: ignore[arg-type]


def _point(values: tuple[float, ...]) -> Point:
    return (values[0], values[1], values[2])


def same_position(a: Point, b: Point) -> bool:
    """True where two points differ by less than any control resolves."""
    return all(abs(p - q) <= SAME_POSITION_MM for p, q in zip(a, b, strict=True))


def initial_state(dialect: Dialect, settings: MachineSettings) -> State:
    """The control at power-on: G54, G17, G90, G94, G49, no feed, the spindle stopped."""
    unit = MM_PER_INCH if settings.units == "inch" else 1.0
    modes = Modes(
        motion=dialect.power_on_motion,
        return_to_r=dialect.power_on_return_to_r,
        unit_mm=unit,
        absolute_centres=settings.arc_centres == "absolute",
        transforms=MappingProxyType({}),
    )
    references = {1: (settings.home_mm, NO_EXTRA)}
    references.update({number: (point, NO_EXTRA) for number, point in settings.reference_points_mm.items()})
    rotations = settings.rotations_deg
    setup = Setup(
        offsets=MappingProxyType(
            {n: WorkOffset(zero_mm=p, rotation_deg=rotations.get(n, 0.0)) for n, p in settings.offsets.items()}
        ),
        external_mm=settings.external_offset_mm,
        shift=WorkOffset(zero_mm=settings.shift_mm),
        tools=settings.tools or MappingProxyType({}),
        references=MappingProxyType(references),
    )
    state = State(
        control=Control(dialect=dialect, settings=settings),
        modes=modes,
        machine=MotionState(tool=settings.tool, wcs=settings.wcs),
        setup=setup,
        frame=CoordinateFrame(),
        position_mm=settings.start_mm,
    )
    return state.reframed()
