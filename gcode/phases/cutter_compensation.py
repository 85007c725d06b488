"""From the programmed path to the path of the tool: cutter compensation, and corners cut or rounded.

Both need the next motion before the present one is known, so motions wait in `State.waiting`.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import replace

import gcode.compensation as compensation
from gcode.control.command import Command
from gcode.control.coordinates import difference, plus
from gcode.control.state import State, same_position
from gcode.control.waiting import CornerKind, WaitingCorner, WaitingPath
from gcode.errors import GcodeError, Place
from gcode.events import PLANE_AXES, ArcMotion, Event, LinearMotion, Motion, Notice, Point, ProgramStop
from gcode.language.blocks import Word
from gcode.phases.corners import insert_corner
from gcode.phases.modes import Action, Result, whole_number
from gcode.settings import ToolOffset

_SIDES: Mapping[str, compensation.Hand] = {"G41": "left", "G42": "right", "G41.1": "left", "G42.1": "right"}
_OTHER: Mapping[compensation.Hand, compensation.Hand] = {"left": "right", "right": "left"}
#: Orientations of tools whose cutting edge is all around their axis: those of mills (0), and 9 of round lathe tools.
ROUND_ORIENTATIONS = frozenset({0, 9})
_CORNERS: Mapping[str, CornerKind] = {",C": "chamfer", ",R": "round"}


def set_radius(state: State, command: Command) -> Result:
    """G40, G41, G42 and D: whether and how the tool's path is offset from the programmed one."""
    uses = command.of_phase("radius")
    code = uses[0].rule.code if uses else None
    state, notices = _with_number(state, command, code)
    if code == "G40":
        return _off(state, command)
    if code is None and not state.compensates:
        return state, notices
    side = _SIDES[code] if code else _present_side(state)
    word = uses[0].word if uses else command.words["D"]
    if code in _SIDES and state.modes.radius_number is None and not state.control.dialect.compensation_defaults_to_tool:
        text = f"{word.text} without D, and none before: D0 is active, so the radius is 0"
        notices = (*notices, Notice(place=command.block.place_of(word), code="radius-zero", text=text))
    return _on(state, command, side, _radius(state, command, code), word), notices


def _present_side(state: State) -> compensation.Hand:
    return "left" if state.machine.compensation == "left" else "right"


def _with_number(state: State, command: Command, code: str | None) -> tuple[State, tuple[Event, ...]]:
    """The state with the D number that the block gives; a notice where no table gives its radius."""
    word = command.words.get("D")
    if word is None or code in ("G41.1", "G42.1"):
        return state, ()
    number = whole_number(command.block, word)
    state = state.with_modes(radius_number=number)
    if number == 0 or state.control.settings.tools is not None or number in state.setup.tools:
        return state, ()
    text = f"{word.text}: no tool table is given, so the radius counts as 0"
    return state, (Notice(place=command.block.place_of(word), code="no-tool-table", text=text),)


def _radius(state: State, command: Command, code: str | None) -> float:
    """Cutter radius of the block, mm."""
    dialect, word = state.control.dialect, command.words.get("D")
    use = command.of_phase("radius")[0].word if code else word
    if code in ("G41.1", "G42.1"):
        if word is None:
            raise command.block.error(use, "missing-radius", f"{code} without D", "D and the tool's diameter")
        return word.value * state.modes.unit_mm / 2.0
    number = state.modes.radius_number if dialect.length_word_is_modal or word is not None else None
    if not number:
        number = state.machine.tool if dialect.compensation_defaults_to_tool else 0
    row = _row(state, command, number, word or use)
    if row.orientation not in ROUND_ORIENTATIONS:
        problem = f"tool {number} is a lathe tool of orientation {row.orientation}"
        raise command.block.error(word or use, "lathe-tool", problem, "cutter compensation with a tool that turns")
    return row.whole_radius_mm


def _row(state: State, command: Command, number: int, word: Word | None) -> ToolOffset:
    table = state.setup.tools
    if number in table:
        return table[number]
    if number == 0 or state.control.settings.tools is None:
        return ToolOffset()
    known = ", ".join(f"D{n}" for n in sorted(table)) or "none is given"
    problem = f"cutter radius offset {number} is not in the tool table"
    raise command.block.error(word, "unknown-radius", problem, f"one from the table: {known}")


def _on(state: State, command: Command, side: compensation.Hand, radius_mm: float, word: Word) -> State:
    path, place = state.waiting or WaitingPath(), command.block.place_of(word)
    settings, dialect = state.control.settings, state.control.dialect
    plane = state.machine.plane
    seen = _OTHER[side] if (state.frame.plane_scale(plane) or 1.0) < 0.0 else side
    if path.compensation is not None and not path.cancelling:
        alone = not _moves_in_plane(state, command)
        changed = compensation.change(path.compensation, seen, radius_mm, place=place, alone=alone)
    else:
        style: compensation.Style = "linuxcnc"
        if dialect.compensation == "fanuc":
            style = "fanuc-A" if settings.compensation_startup == "A" else "fanuc-B"
        at = path.at_mm or state.position_mm
        changed = compensation.begin(style, seen, radius_mm, plane, at, place=place, unit_mm=state.modes.unit_mm)
    state = state.with_machine(compensation=side, radius_number=state.modes.radius_number)
    return replace(state, waiting=replace(path, compensation=changed, cancelling=False, at_mm=None))


def _moves_in_plane(state: State, command: Command) -> bool:
    i, j, _ = PLANE_AXES[state.machine.plane]
    return "motion" in command.phases and bool({"XYZ"[i], "XYZ"[j]} & command.words.keys())


def _off(state: State, command: Command) -> Result:
    """G40: with a motion in the block this motion leaves the offset, else the next one does."""
    state = state.with_machine(compensation="off", radius_number=None)
    path = state.waiting
    if path is None or path.compensation is None:
        return state, ()
    if "motion" in command.phases:
        return replace(state, waiting=replace(path, cancelling=True)), ()
    events, at = compensation.end(path.compensation)
    off_path = None if same_position(at, state.position_mm) else at
    return _with_waiting(state, replace(path, compensation=None, cancelling=False, at_mm=off_path)), events


def _with_waiting(state: State, path: WaitingPath) -> State:
    """The state with waiting motions; None again where nothing waits."""
    return replace(state, waiting=None if path == WaitingPath() else path)


def through(state: State, command: Command | None, events: Iterable[Event]) -> Result:
    """Passes the events of a block through the waiting corner and the compensation.

    Args:
        state: with waiting motions, or with a corner requested by `command`.
        command: the block, None for events that belong to none.
        events: as programmed.

    Returns:
        The state, and the events that are finished.
    """
    out: list[Event] = []
    corner = _requested_corner(state, command)
    for event in events:
        path = state.waiting or WaitingPath()
        if path.corner is not None:
            state, ready = _past_corner(state, path, path.corner, event)
        else:
            ready = (event,)
        for one in ready:
            if corner is not None and one is ready[-1] and isinstance(one, LinearMotion | ArcMotion):
                state = _hold(state, one, *corner)
            else:
                state, more = _compensated(state, one)
                out.extend(more)
    return state, tuple(out)


def flushed(state: State) -> Result:
    """The waiting motions at the end of a program that has no M2, M30 or percent sign."""
    if state.waiting is None:
        return state, ()
    end = ProgramStop(place=Place(file="", line=1), optional=False, end=True)
    state, events = through(state, None, (end,))
    return state, events[:-1]


def _requested_corner(state: State, command: Command | None) -> tuple[CornerKind, float] | None:
    """The corner that a block requests at its end."""
    if command is None or not state.control.dialect.corner_letters:
        return None
    given = [letter for letter in _CORNERS if letter in command.words]
    if not given:
        return None
    word = command.words[given[-1]]
    if len(given) > 1:
        problem = f"{command.words[given[0]].text} together with {word.text}"
        raise command.block.error(word, "corner-two", problem, "one corner in a block")
    if word.value <= 0.0:
        raise command.block.error(word, "bad-value", f"{word.text} is not a corner size", "a length above 0")
    return _CORNERS[given[0]], word.value * state.modes.unit_mm


def _hold(state: State, motion: Motion, kind: CornerKind, size_mm: float) -> State:
    corner = WaitingCorner(motion=motion, kind=kind, size_mm=size_mm)
    return replace(state, waiting=replace(state.waiting or WaitingPath(), corner=corner))


def _past_corner(
    state: State, path: WaitingPath, corner: WaitingCorner, event: Event
) -> tuple[State, tuple[Event, ...]]:
    """The events of a waiting corner once the next event is known."""
    if isinstance(event, ProgramStop) and event.end:
        problem = "a corner at the end of the program"
        raise _corner_error(corner, problem)
    if not isinstance(event, LinearMotion | ArcMotion):
        return replace(state, waiting=replace(path, corner=replace(corner, events=(*corner.events, event)))), ()
    first, between, second = insert_corner(corner.motion, event, corner.kind, corner.size_mm)
    return _with_waiting(state, replace(path, corner=None)), (first, between, *corner.events, second)


def _corner_error(corner: WaitingCorner, problem: str) -> Exception:
    return GcodeError(corner.motion.place, "corner-no-motion", problem, "a feed motion in the plane after it")


def _compensated(state: State, event: Event) -> tuple[State, tuple[Event, ...]]:
    path = state.waiting
    if path is None or (path.compensation is None and path.at_mm is None):
        return state, (event,)
    if path.compensation is None:
        return _from_off_path(state, path, event)
    if isinstance(event, ProgramStop) and event.end:
        events, _ = compensation.end(path.compensation)
        return _with_waiting(state, replace(path, compensation=None, cancelling=False)), (*events, event)
    if not isinstance(event, LinearMotion | ArcMotion):
        return replace(state, waiting=replace(path, compensation=compensation.queue(path.compensation, event))), ()
    if path.cancelling:
        events = compensation.cancel(path.compensation, event)
        at = _last_end(events, event.end_mm)
        off_path = None if same_position(at, event.end_mm) else at
        return _with_waiting(state, replace(path, compensation=None, cancelling=False, at_mm=off_path)), events
    changed, events = compensation.move(path.compensation, event)
    return replace(state, waiting=replace(path, compensation=changed)), events


def _last_end(events: tuple[Event, ...], otherwise: Point) -> Point:
    ends = [event.end_mm for event in events if isinstance(event, LinearMotion | ArcMotion)]
    return ends[-1] if ends else otherwise


def _from_off_path(state: State, path: WaitingPath, event: Event) -> tuple[State, tuple[Event, ...]]:
    """The motion after G40 alone starts off the programmed path and ends on it."""
    at = path.at_mm
    if at is None or not isinstance(event, LinearMotion | ArcMotion):
        return state, (event,)
    if isinstance(event, ArcMotion):
        raise _arc_exit(event)
    offset = difference(at, event.start_mm)
    if state.control.dialect.compensation == "fanuc" and _along_normal(event):
        end = plus(event.end_mm, offset)
        moved = replace(event, start_mm=at, end_mm=end)
        return replace(state, waiting=replace(path, at_mm=end)), (moved,)
    return _with_waiting(state, replace(path, at_mm=None)), (replace(event, start_mm=at),)


def _along_normal(event: LinearMotion) -> bool:
    i, j, _ = PLANE_AXES[event.state.plane]
    return event.start_mm[i] == event.end_mm[i] and event.start_mm[j] == event.end_mm[j]


def _arc_exit(event: ArcMotion) -> Exception:
    problem = "an arc right after cutter compensation was turned off"
    return GcodeError(event.place, "compensation-arc-exit", problem, "a straight motion after G40")


RADIUS_ACTIONS: Mapping[str, Action] = {"radius": set_radius}
