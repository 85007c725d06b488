"""System variables: positions, modal values, offsets and tools as a program can read and write them.

Two tables, one for FANUC's custom macro and one for LinuxCNC. Lengths are in the program's unit in FANUC; in LinuxCNC
offsets are in the machine's unit and positions in the program's.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping
from dataclasses import replace
from types import MappingProxyType
from typing import Any

from gcode.control.coordinates import ORIGIN
from gcode.control.state import State, WorkOffset
from gcode.events import NO_EXTRA, Notice, ProgramStop
from gcode.flow.session import Session
from gcode.language.expressions import EvaluationError
from gcode.phases.offsets import to_extra
from gcode.settings import NUMBERED_OFFSETS, ToolOffset

_MESSAGE = re.compile(r"\(([^)]*)\)")
_FEED_CODES = {"inverse-time": 93, "per-minute": 94, "per-revolution": 95}
_SIDE_CODES = {"off": 40, "left": 41, "right": 42}


def _code(name: str) -> float:
    return float(name[1:])


def _wcs_code(state: State) -> float:
    return 54.1 if " " in state.machine.wcs else _code(state.machine.wcs)


#: FANUC's #4001...: the code of each modal group.
_GROUPS: Mapping[int, Callable[[State], float]] = {
    1: lambda s: _code(s.modes.base_motion),
    2: lambda s: float(s.machine.plane),
    3: lambda s: 90.0 if s.modes.absolute else 91.0,
    5: lambda s: float(_FEED_CODES[s.machine.feed_mode]),
    6: lambda s: 21.0 if s.modes.unit_mm == 1.0 else 20.0,
    7: lambda s: float(_SIDE_CODES[s.machine.compensation]),
    8: lambda s: _code(s.modes.length_code),
    9: lambda s: 80.0 if s.modes.motion == s.modes.base_motion else _code(s.modes.motion),
    10: lambda s: 99.0 if s.modes.return_to_r else 98.0,
    11: lambda s: 51.0 if "scaling" in s.modes.transforms else 50.0,
    13: lambda s: 97.0 if s.modes.surface_speed is None else 96.0,
    14: _wcs_code,
    16: lambda s: 68.0 if "rotation" in s.modes.transforms else 69.0,
    17: lambda s: 16.0 if s.modes.polar else 15.0,
    22: lambda s: 51.1 if "mirror" in s.modes.transforms else 50.1,
}
#: FANUC's #4101...: the value of each modal letter.
_LETTERS: Mapping[int, Callable[[State], float | None]] = {
    107: lambda s: s.modes.radius_number,
    109: lambda s: s.modes.feed if s.machine.feed_mode == "inverse-time" else s.modes.feed / s.modes.unit_mm,
    111: lambda s: s.modes.length_number,
    115: lambda s: s.modes.program,
    119: lambda s: s.machine.spindle_rpm,
    120: lambda s: s.modes.next_tool if s.modes.next_tool is not None else s.machine.tool,
    130: lambda s: float(s.machine.wcs.split("P")[1]) if " " in s.machine.wcs else 0.0,
}
#: Work offsets: first number, step and name of the n-th from 0.
_FANUC_OFFSETS: tuple[tuple[int, int, Callable[[int], str]], ...] = (
    (5221, 6, lambda n: f"G{54 + n}"),
    (7001, 48, lambda n: f"G54.1 P{n + 1}"),
    (14001, 300, lambda n: f"G54.1 P{n + 1}"),
)
#: Fields of `Setup` that every work offset has in common.
_COMMON_SHIFTS: Mapping[str, str] = {"external": "external_mm", "local": "local_mm"}
#: LinuxCNC's parameters are #1 to this less 1; one of them, 1 at the start, turns its debug messages on.
_PARAMETERS, _DEBUG_OUTPUT = 5602, 5599
_OFFSET_PARAMETERS = range(5161, 5391)
_UNKNOWN_CLOCKS = {3001: "a clock", 3002: "a clock", 3011: "the date", 3012: "the time"}
_IGNORED = {3003: "single-block control", 3004: "feed control", 3005: "settings", 3007: "mirror image status"}


class SystemVariables:
    """The variables that belong to the control of a `Session`."""

    def __init__(self, session: Session) -> None:
        self._session = session
        fanuc = session.dialect.macro.vacant
        self._read: Callable[[int], float | None] = self._read_fanuc if fanuc else self._read_linuxcnc
        self._write: Callable[[int, float | None], None] = self._write_fanuc if fanuc else self._write_linuxcnc

    @property
    def _state(self) -> State:
        return self._session.state

    def read(self, index: int) -> float | None:
        """Value of #index.

        Raises:
            EvaluationError: for a variable that does not exist, or that a simulation cannot know.
        """
        return self._read(index)

    def write(self, index: int, value: float | None) -> None:
        """Sets #index.

        Raises:
            EvaluationError: for a variable that cannot be set, and for an alarm (#3000).
        """
        self._write(index, value)

    # -- FANUC ---------------------------------------------------------------------------------------------------

    def _read_fanuc(self, index: int) -> float | None:
        state, unit = self._state, self._state.modes.unit_mm
        if index in _UNKNOWN_CLOCKS:
            raise _unknown(index, f"{_UNKNOWN_CLOCKS[index]}, which a simulation does not know")
        if index in _IGNORED:
            return 0.0
        if 4001 <= index <= 4030 and index - 4000 in _GROUPS:
            return _GROUPS[index - 4000](state)
        if 4101 <= index <= 4130 and index - 4000 in _LETTERS:
            return _LETTERS[index - 4000](state)
        if index == 4114:
            return float(self._session.last_label)
        position = self._fanuc_position(index)
        if position is not None:
            return position / unit
        offset = self._read_offset(index)
        if offset is not None:
            return offset / unit
        if self._counter(index):
            return 0.0
        raise _unknown(index, "not a variable of this control")

    def _read_offset(self, index: int) -> float | None:
        """A length of the offset memory, mm, None for another variable."""
        state = self._state
        place = _offset_place(state, index)
        if place is not None:
            name, axis = place
            if name in _COMMON_SHIFTS:
                return float(getattr(state.setup, _COMMON_SHIFTS[name])[axis])
            return state.setup.offsets.get(name, WorkOffset()).zero_mm[axis]
        column = _tool_column(state, index)
        return None if column is None else float(getattr(state.setup.tools.get(column[1], ToolOffset()), column[0]))

    def _counter(self, index: int) -> str:
        """The meaning of a counter of the control, which is 0 here and reported once; empty for another variable."""
        for first, count, meaning in self._state.control.dialect.counters:
            if first <= index < first + count:
                if index not in self._session.assumed:
                    self._session.assumed.add(index)
                    text = f"#{index} ({meaning}) counts as 0, because a simulation does not know it"
                    self._session.pending.append(Notice(place=self._session.place, code="assumed-zero", text=text))
                return meaning
        return ""

    def _fanuc_position(self, index: int) -> float | None:
        state = self._state
        points: Mapping[int, Callable[[], tuple[float, float, float]]] = {
            5000: lambda: state.program_mm,
            5020: lambda: state.gauge_mm,
            5040: lambda: state.frame.to_program(state.gauge_mm),
            5080: lambda: (0.0, 0.0, state.machine.length_offset_mm),
        }
        base = index - (index % 20) if index % 20 else 0
        if base in points and 1 <= index % 20 <= 3:
            return points[base]()[index % 20 - 1]
        return None

    def _write_fanuc(self, index: int, value: float | None) -> None:
        if index == 3000:
            number = self._state.control.dialect.first_alarm + int(value or 0.0)
            raise EvaluationError("alarm", f"the program raises alarm {number}: {self._message()}")
        if index == 3006:
            self._session.pending.append(
                ProgramStop(place=self._session.place, optional=False, end=False, message=self._message())
            )
            return
        meaning = _IGNORED.get(index) or _UNKNOWN_CLOCKS.get(index) or self._counter(index)
        if meaning:
            text = f"#{index} ({meaning}) has no effect on the simulated motion"
            self._session.pending.append(Notice(place=self._session.place, code="no-motion", text=text))
            return
        if not self._write_offset(index, value or 0.0):
            raise EvaluationError("read-only-variable", f"#{index} cannot be set", "a variable that can be written")

    def _message(self) -> str:
        found = _MESSAGE.search(self._session.place.text)
        return found[1].strip() if found else ""

    def _write_offset(self, index: int, value: float) -> bool:
        state, unit = self._state, self._state.modes.unit_mm
        place, column = _offset_place(state, index), _tool_column(state, index)
        if place is not None:
            self._session.state = _with_zero(state, place[0], place[1], value * unit)
            return True
        if column is not None:
            name, number = column
            row = state.setup.tools.get(number, ToolOffset()).with_column(name, value * unit)
            tools = MappingProxyType({**state.setup.tools, number: row})
            self._session.state = state.with_setup(tools=tools)
            return True
        return False

    # -- LinuxCNC ------------------------------------------------------------------------------------------------

    def _read_linuxcnc(self, index: int) -> float | None:
        state = self._state
        machine = state.control.machine_unit_mm
        stored = self._session.stored.get(index)
        if stored is not None and (stored[1] is state.setup or index not in _OFFSET_PARAMETERS):
            return stored[0]
        for numbers, reader in self._linuxcnc:
            if index in numbers:
                return reader(index - numbers[0], machine)
        if index in _LINUXCNC_TOOL:
            return _LINUXCNC_TOOL[index](state)
        if 0 < index < _PARAMETERS:
            return 1.0 if index == _DEBUG_OUTPUT else 0.0
        raise _unknown(index, "not a parameter of this control")

    @property
    def _linuxcnc(self) -> tuple[tuple[range, Callable[[int, float], float]], ...]:
        """Ranges of LinuxCNC's parameters, and what gives one from its place in the range and the machine's unit."""
        state = self._state
        setup, wcs = state.setup, state.machine.wcs
        first, second = (setup.references.get(n, (ORIGIN, NO_EXTRA)) for n in (1, 2))
        return (
            (range(5161, 5170), lambda n, unit: _nine(*first, unit)[n]),
            (range(5181, 5190), lambda n, unit: _nine(*second, unit)[n]),
            (range(5210, 5211), lambda _n, _unit: float(setup.shift_on and setup.shift != WorkOffset())),
            (range(5211, 5220), lambda n, unit: _nine(setup.shift.zero_mm, setup.shift.extra, unit)[n]),
            (
                range(5220, 5221),
                lambda _n, _unit: NUMBERED_OFFSETS.index(wcs) + 1.0 if wcs in NUMBERED_OFFSETS else 0.0,
            ),
            (range(5221, 5391), self._linuxcnc_offset),
            (range(5401, 5410), lambda n, unit: _nine(state.tool_offset_mm, NO_EXTRA, unit)[n]),
            (range(5420, 5429), lambda n, _unit: self._position()[n]),
        )

    def _position(self) -> tuple[float, ...]:
        state = self._state
        extra = to_extra([a - b for a, b in zip(state.extra, state.frame.extra, strict=True)])
        return _nine(state.program_mm, extra, state.modes.unit_mm)

    def _linuxcnc_offset(self, place: int, machine: float) -> float:
        number, axis = divmod(place, 20)
        offset = self._state.setup.offsets.get(NUMBERED_OFFSETS[number], WorkOffset())
        if axis == 9:
            return offset.rotation_deg
        return _nine(offset.zero_mm, offset.extra, machine)[axis] if axis < 9 else 0.0

    def _write_linuxcnc(self, index: int, value: float | None) -> None:
        """Stores a parameter. LinuxCNC reads work offsets from parameters only when it starts, so none moves."""
        if not 0 < index < _PARAMETERS or index in range(5400, 5430):
            raise EvaluationError("read-only-variable", f"#{index} cannot be set", "a parameter that can be written")
        for number, first in ((1, 5161), (2, 5181)):
            if first <= index < first + 3:
                length = (value or 0.0) * self._state.control.machine_unit_mm
                self._session.state = _with_reference(self._state, number, index - first, length)
                return
        self._session.stored[index] = (value or 0.0, self._state.setup)

    def named(self, name: str) -> float | None:
        """Value of one of the control's named parameters, None for an unknown name."""
        if name in _CONSTANTS:
            return _CONSTANTS[name]
        reader = _NAMED.get(name)
        if reader is not None:
            return float(reader(self._state))
        axis = "xyzabcuvw".find(name[1:]) if len(name) == 2 and name[0] == "_" else -1
        if axis >= 0:
            return self._position()[axis]
        if name.startswith("_abs_") and len(name) == 6 and name[5] in "xyzabcuvw":
            state = self._state
            return _nine(state.gauge_mm, state.extra, state.modes.unit_mm)["xyzabcuvw".index(name[5])]
        if name == "_call_level":
            return float(sum(level.kind == "routine" for level in self._session.levels))
        return float(self._session.place.line) if name == "_line" else None


def _nine(point: tuple[float, float, float], extra: tuple[float, ...], unit: float) -> tuple[float, ...]:
    """X Y Z A B C U V W in a unit."""
    x, y, z = point
    a, b, c, u, v, w = extra
    return (x / unit, y / unit, z / unit, a, b, c, u / unit, v / unit, w / unit)


def _unknown(index: int, reason: str) -> EvaluationError:
    return EvaluationError("unknown-variable", f"#{index} is {reason}", "a variable that exists")


def _offset_place(state: State, index: int) -> tuple[str, int] | None:
    """The work offset and axis of a FANUC or Haas variable."""
    if 5201 <= index <= 5203:
        return state.control.dialect.common_shift_variables, index - 5201
    for first, count, name in _FANUC_OFFSETS:
        number, axis = divmod(index - first, 20)
        if 0 <= number < count and axis < 3:
            return name(number), axis
    return None


def _tool_column(state: State, index: int) -> tuple[str, int] | None:
    """The column and row of the tool offset table of a FANUC or Haas variable."""
    for first, count, name in state.control.dialect.tool_variables:
        if first <= index < first + count:
            return name, index - first + 1
    return None


def _changed(point: tuple[float, float, float], axis: int, value: float) -> tuple[float, float, float]:
    changed = list(point)
    changed[axis] = value
    return (changed[0], changed[1], changed[2])


def _with_zero(state: State, name: str, axis: int, value_mm: float) -> State:
    if name in _COMMON_SHIFTS:
        field = _COMMON_SHIFTS[name]
        return state.with_setup(**{field: _changed(getattr(state.setup, field), axis, value_mm)})
    old = state.setup.offsets.get(name, WorkOffset())
    new = replace(old, zero_mm=_changed(old.zero_mm, axis, value_mm))
    return state.with_setup(offsets=MappingProxyType({**state.setup.offsets, name: new}))


def _with_reference(state: State, number: int, axis: int, value_mm: float) -> State:
    point, extra = state.setup.references.get(number, (ORIGIN, NO_EXTRA))
    references = MappingProxyType({**state.setup.references, number: (_changed(point, axis, value_mm), extra)})
    return state.with_setup(references=references)


_LINUXCNC_TOOL: Mapping[int, Callable[[State], float]] = {
    5400: lambda s: float(s.machine.tool),
    5410: lambda s: 2.0 * s.setup.tools.get(s.machine.tool, ToolOffset()).radius_mm / s.control.machine_unit_mm,
}
_NAMED: Mapping[str, Callable[[State], Any]] = {
    "_motion_mode": lambda s: 10.0 * _code(s.modes.motion),
    "_plane": lambda s: 10.0 * s.machine.plane,
    "_ccomp": lambda s: 10.0 * _SIDE_CODES[s.machine.compensation],
    "_metric": lambda s: s.modes.unit_mm == 1.0,
    "_imperial": lambda s: s.modes.unit_mm != 1.0,
    "_absolute": lambda s: s.modes.absolute,
    "_incremental": lambda s: not s.modes.absolute,
    "_inverse_time": lambda s: s.machine.feed_mode == "inverse-time",
    "_units_per_minute": lambda s: s.machine.feed_mode == "per-minute",
    "_units_per_rev": lambda s: s.machine.feed_mode == "per-revolution",
    "_coord_system": lambda s: 10.0 * _code(s.machine.wcs),
    "_tool_offset": lambda s: s.modes.length_code != "G49",
    "_retract_r_plane": lambda s: s.modes.return_to_r,
    "_retract_old_z": lambda s: not s.modes.return_to_r,
    "_spindle_rpm_mode": lambda s: s.modes.surface_speed is None,
    "_spindle_css_mode": lambda s: s.modes.surface_speed is not None,
    "_ijk_absolute_mode": lambda s: s.modes.absolute_centres,
    "_lathe_diameter_mode": lambda s: s.modes.diameter,
    "_lathe_radius_mode": lambda s: not s.modes.diameter,
    "_spindle_on": lambda s: s.machine.spindle_direction != 0,
    "_spindle_cw": lambda s: s.machine.spindle_direction == 1,
    "_mist": lambda s: s.modes.mist,
    "_flood": lambda s: s.modes.flood,
    "_feed": lambda s: s.modes.feed / s.modes.unit_mm,
    "_rpm": lambda s: s.machine.spindle_rpm,
    "_current_tool": lambda s: s.machine.tool,
    "_current_pocket": lambda s: s.setup.tools.get(s.machine.tool, ToolOffset()).pocket or 0,
    "_selected_tool": lambda s: 0 if s.modes.next_tool is None else s.modes.next_tool,
    "_selected_pocket": lambda s: 0 if s.modes.next_tool is None else s.modes.next_tool,
}
#: LinuxCNC's names that have one value here.
_CONSTANTS: Mapping[str, float] = {
    "_vmajor": 2.9,
    "_vminor": 0.0,
    "_speed_override": 1.0,
    "_feed_override": 1.0,
    "_adaptive_feed": 0.0,
    "_feed_hold": 1.0,
    "_value": 0.0,
    "_value_returned": 0.0,
    "_task": 0.0,
    "_remap_level": 0.0,
}
