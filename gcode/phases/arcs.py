"""G2 and G3: centre, sense and turns of an arc from its words, in any of the three planes.

Each plane's two axes are taken in the order of `PLANE_AXES` (XY, ZX, YZ), which makes a right-handed frame with the
plane's normal; G3 is counter-clockwise seen against that normal in all three. Everything is computed in the axes of the
program and then transformed to machine coordinates, so that a rotation, scaling or mirror image acts on the whole arc.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace

from gcode.control.command import Command
from gcode.control.coordinates import SAME_POSITION_MM
from gcode.control.state import AXES, State
from gcode.dialects import ArcTolerance
from gcode.errors import GcodeError
from gcode.events import PLANE_AXES, ArcMotion, Point
from gcode.language.blocks import Word
from gcode.phases.end_points import extra_end, feed_mm_min, moved_to, program_end, programmed_end, settled
from gcode.phases.modes import Result, whole_number

_CENTRE_LETTERS = "IJK"
#: Turns that one arc may make; a control would be busy with them for days.
MOST_TURNS = 100_000
_TURNS: Mapping[str, int] = {"G2": -1, "G3": 1}
#: Most that rounding in the coordinates of an arc's ends takes from half its chord.
_ROUNDING_MM = 1e-9
_PLANE_NAMES: Mapping[int, str] = {17: "XY", 18: "ZX", 19: "YZ"}


@dataclass(frozen=True, slots=True)
class _Ends:
    """Ends of an arc and the program zero, mm: in machine coordinates, or in program coordinates that are transformed.

    Attributes:
        closed: the end is above or below the start.
    """

    start: Point
    end: Point
    zero: Point
    closed: bool = False


def arc(state: State, command: Command) -> Result:
    """The arc or helix that a block makes while G2 or G3 is active.

    Raises:
        GcodeError: without a feed, without a centre or with two, with a centre word of another plane, with an R too
            small for the chord, where the radii at the two ends differ, and where scaling distorts the circle.
    """
    if state.modes.feed <= 0.0:
        feed_mm_min(state, command, 0.0)
    if state.control.dialect.needs_axis_words:
        _require_plane_axis(state, command)
    ends = _ends(state, command)
    centre_words = {letter: command.words[letter] for letter in _CENTRE_LETTERS if letter in command.words}
    radius = command.words.get("R")
    if radius is not None and centre_words:
        problem = f"{radius.text} together with {', '.join(w.text for w in centre_words.values())}"
        raise command.block.error(radius, "arc-two-centres", problem, "a radius R, or a centre by I, J, K")
    if radius is not None:
        centre = _centre_from_radius(state, command, ends, radius)
    elif centre_words:
        centre = _centre_from_words(state, command, ends, centre_words)
    else:
        problem = f"{state.modes.motion} without a centre"
        raise command.block.error(None, "arc-without-centre", problem, "I, J, K or R")
    return _arc_motion(state, command, _closed(state, ends), centre)


def _require_plane_axis(state: State, command: Command) -> None:
    first, second = (AXES[axis] for axis in PLANE_AXES[state.machine.plane][:2])
    if command.words.keys().isdisjoint({first, second}):
        problem = f"{state.modes.motion} without an axis word of the {_plane(state)}"
        raise command.block.error(None, "missing-axis", problem, f"{first} or {second}")


def _ends(state: State, command: Command) -> _Ends:
    frame = state.frame
    if frame.matrix is None and not state.modes.polar:
        return _Ends(state.position_mm, programmed_end(state, command), frame.zero_mm)
    if frame.plane_scale(state.machine.plane) is None:
        problem = f"{state.modes.motion} while the {_plane(state)} has two scale factors or is rotated out of its plane"
        raise command.block.error(None, "arc-uneven-scale", problem, "straight motions, or an even scale")
    return _Ends(state.program_mm, program_end(state, command), (0.0, 0.0, 0.0))


def _arc_motion(state: State, command: Command, ends: _Ends, centre: Point) -> Result:
    frame, end = state.frame, ends.end
    turned = frame.matrix is not None or state.modes.polar
    if turned:
        end, centre = frame.to_machine(end), frame.to_machine(centre)
        if ends.closed:
            end = _over(state, state.position_mm, end)
    turns = _TURNS[state.modes.motion] * _whole_turns(command)
    if (frame.plane_scale(state.machine.plane) or 1.0) < 0.0:
        turns = -turns
    extra = extra_end(state, command)
    event = ArcMotion(
        place=command.block.place,
        state=state.machine,
        start_mm=state.position_mm,
        end_mm=end,
        centre_mm=centre,
        plane=state.machine.plane,
        turns=turns,
        feed_mm_min=0.0,
        extra=extra,
    )
    event = replace(event, feed_mm_min=_path_feed(state, command, event))
    return moved_to(settled(state, command), end, extra), (event,)


def _path_feed(state: State, command: Command, event: ArcMotion) -> float:
    """Feed along the path, which is longer than the arc in the plane that F may be for."""
    arc, path = arc_lengths(event)
    feed = feed_mm_min(state, command, path)
    along_arc = state.control.dialect.helix_feed_along_arc and state.machine.feed_mode != "inverse-time"
    return feed * path / arc if along_arc else feed


def _whole_turns(command: Command) -> int:
    """P: the number of turns, the last one begun."""
    word = command.words.get("P")
    if word is None:
        return 1
    turns = whole_number(command.block, word)
    if turns == 0:
        raise command.block.error(word, "bad-value", f"{word.text} is not a number of turns", "P1 or more")
    if turns > MOST_TURNS:
        raise command.block.error(word, "bad-value", f"{word.text} is far too many turns", f"at most P{MOST_TURNS}")
    return turns


def arc_lengths(event: ArcMotion) -> tuple[float, float]:
    """Lengths of an arc in its plane and of the helix over it, mm, by its mean radius."""
    i, j, k = PLANE_AXES[event.plane]
    start, end, centre = event.start_mm, event.end_mm, event.centre_mm
    radius = math.hypot(start[i] - centre[i], start[j] - centre[j]) + math.hypot(end[i] - centre[i], end[j] - centre[j])
    arc = abs(event.sweep_rad) * radius / 2.0
    return arc, math.hypot(arc, end[k] - start[k])


def _closed(state: State, ends: _Ends) -> _Ends:
    """The end exactly at the start where only rounding separates them: the arc is then a full turn, not none."""
    first, second, _ = PLANE_AXES[state.machine.plane]
    if math.hypot(ends.end[first] - ends.start[first], ends.end[second] - ends.start[second]) > SAME_POSITION_MM:
        return ends
    return replace(ends, end=_over(state, ends.start, ends.end), closed=True)


def _over(state: State, start: Point, end: Point) -> Point:
    """`start` at the height of `end`."""
    normal = PLANE_AXES[state.machine.plane][2]
    closed = list(start)
    closed[normal] = end[normal]
    return (closed[0], closed[1], closed[2])


def _centre_from_words(state: State, command: Command, ends: _Ends, words: Mapping[str, Word]) -> Point:
    """Centre from I, J, K, checked against both ends."""
    first, second, normal = PLANE_AXES[state.machine.plane]
    other = words.get(_CENTRE_LETTERS[normal])
    if other is not None and (state.control.dialect.centre_words_of_plane or len(words) == 1):
        word = other
        expected = f"{_CENTRE_LETTERS[first]} and {_CENTRE_LETTERS[second]}"
        raise command.block.error(word, "arc-plane", f"{word.text} in an arc of the {_plane(state)}", expected)
    if state.modes.absolute_centres and len(words) < 2:
        problem = f"{next(iter(words.values())).text} alone as an absolute arc centre"
        expected = f"both {_CENTRE_LETTERS[first]} and {_CENTRE_LETTERS[second]}"
        raise command.block.error(next(iter(words.values())), "arc-centre-incomplete", problem, expected)
    centre = _centre(state, ends, words, absolute=state.modes.absolute_centres)
    radii = _radii(state, ends, centre)
    if max(radii) <= SAME_POSITION_MM:
        raise command.block.error(None, "arc-zero-radius", "an arc of radius 0", "a centre away from the start")
    if not arc_tolerance(state).accepts(*radii):
        raise _radius_error(state, command, ends, words, radii)
    return centre


def _centre(state: State, ends: _Ends, words: Mapping[str, Word], *, absolute: bool) -> Point:
    """The centre that I, J, K name; along the plane's normal it is level with the start."""
    origin = ends.zero if absolute else ends.start
    centre = list(ends.start)
    for axis in PLANE_AXES[state.machine.plane][:2]:
        word = words.get(_CENTRE_LETTERS[axis])
        centre[axis] = origin[axis] + (word.value * state.modes.unit_mm if word else 0.0)
    return (centre[0], centre[1], centre[2])


def _radii(state: State, ends: _Ends, centre: Point) -> tuple[float, float]:
    """Distances in the plane of the arc's start and end from its centre, mm."""
    first, second, _ = PLANE_AXES[state.machine.plane]
    start, end = ends.start, ends.end
    return (
        math.hypot(start[first] - centre[first], start[second] - centre[second]),
        math.hypot(end[first] - centre[first], end[second] - centre[second]),
    )


def _radius_error(
    state: State, command: Command, ends: _Ends, words: Mapping[str, Word], radii: tuple[float, float]
) -> GcodeError:
    """The error for radii that do not agree; it mentions the other meaning of I, J, K where that would fit."""
    now = "absolute" if state.modes.absolute_centres else "incremental"
    other = "incremental" if state.modes.absolute_centres else "absolute"
    problem = (
        f"the arc's radius is {radii[0]:.4f} mm at its start and {radii[1]:.4f} mm at its end, "
        f"with {now} centre {' '.join(word.text for word in words.values())}"
    )
    alternative = _radii(state, ends, _centre(state, ends, words, absolute=not state.modes.absolute_centres))
    tolerance = arc_tolerance(state)
    expected = f"radii within {tolerance}{',' if tolerance.relative else ''} of each other"
    if arc_tolerance(state).accepts(*alternative) and min(alternative) > SAME_POSITION_MM:
        switch = "G91.1" if state.modes.absolute_centres else "G90.1"
        expected += f"; {other} arc centres ({switch}, or the setting arc_centres) would fit"
    return command.block.error(next(iter(words.values())), "arc-radius", problem, expected)


def arc_tolerance(state: State) -> ArcTolerance:
    """How far the radii at the ends of an arc may differ on this machine, in the present unit."""
    given = state.control.settings.arc_tolerance_mm
    return (
        state.control.dialect.arc_tolerance.in_unit(state.modes.unit_mm)
        if given is None
        else ArcTolerance(absolute_mm=given)
    )


def _centre_from_radius(state: State, command: Command, ends: _Ends, word: Word) -> Point:
    """Centre from R: R > 0 is the arc of at most half a turn, R < 0 the longer one."""
    first, second, _ = PLANE_AXES[state.machine.plane]
    start, end, radius = ends.start, ends.end, word.value * state.modes.unit_mm
    along, across = end[first] - start[first], end[second] - start[second]
    chord = math.hypot(along, across)
    if chord <= SAME_POSITION_MM:
        problem = f"{word.text} with the end of the arc at its start"
        raise command.block.error(word, "arc-no-chord", problem, "a centre by I, J, K for a full circle")
    if chord / 2.0 - abs(radius) > state.control.dialect.radius_tolerance_mm + _ROUNDING_MM:
        problem = f"{word.text} is too small for a chord of {chord:.4f} mm"
        raise command.block.error(
            word, "arc-radius-too-small", problem, f"an absolute value of at least {chord / 2.0:.4f} mm"
        )
    height = math.sqrt(max(radius * radius - chord * chord / 4.0, 0.0))
    side = math.copysign(1.0, radius) * _TURNS[state.modes.motion]
    centre = list(start)
    centre[first] = start[first] + along / 2.0 - side * height * across / chord
    centre[second] = start[second] + across / 2.0 + side * height * along / chord
    return (centre[0], centre[1], centre[2])


def _plane(state: State) -> str:
    return f"{_PLANE_NAMES[state.machine.plane]} plane (G{state.machine.plane})"
