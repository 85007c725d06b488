"""G5 and G5.1 of LinuxCNC: Bézier curves in the XY plane, as straight motions within a chord tolerance."""

from __future__ import annotations

import math

from gcode.control.command import Command
from gcode.control.state import State
from gcode.events import Event, Point
from gcode.language.blocks import Word
from gcode.phases.end_points import program_end, require_axes
from gcode.phases.modes import Result
from gcode.phases.straight_motion import straight

#: A control runs a curve as short straight motions; as many as LinuxCNC takes.
CURVE_PIECES = 100


def cubic_spline(state: State, command: Command) -> Result:
    """G5: I, J from the start and P, Q from the end are the two control points.

    Raises:
        GcodeError: outside of G17, without P or Q, with one of I and J, and without both right after another motion.
    """
    _plane(state, command)
    require_axes(state, command)
    start, end = state.program_mm, program_end(state, command)
    p, q = (_needed(state, command, letter) for letter in "PQ")
    if ("I" in command.words) != ("J" in command.words):
        letter = "I" if "I" in command.words else "J"
        raise _missing(command, command.words[letter], "I and J together, or neither")
    if "I" in command.words:
        lead = (_needed(state, command, "I"), _needed(state, command, "J"))
    elif state.modes.spline_lead_mm is not None:
        lead = state.modes.spline_lead_mm
    else:
        raise _missing(command, None, "I and J in the first G5 of a chain")
    controls = [
        start[:2],
        (start[0] + lead[0], start[1] + lead[1]),
        (end[0] + p, end[1] + q),
        end[:2],
    ]
    state, events = _curve(state, command, controls, end)
    return state.with_modes(spline_lead_mm=(-p, -q)), events


def quadratic_spline(state: State, command: Command) -> Result:
    """G5.1: I, J from the start is the control point.

    Raises:
        GcodeError: outside of G17, and where I or J is missing.
    """
    _plane(state, command)
    require_axes(state, command)
    start, end = state.program_mm, program_end(state, command)
    i, j = (_needed(state, command, letter) for letter in "IJ")
    middle = (start[0] + i, start[1] + j)
    controls = [
        start[:2],
        _between(start[:2], middle, 2.0 / 3.0),
        _between(end[:2], middle, 2.0 / 3.0),
        end[:2],
    ]
    return _curve(state, command, controls, end)


def _curve(state: State, command: Command, controls: list[tuple[float, float]], end: Point) -> Result:
    """The curve as straight motions; z changes uniformly along them."""
    events: list[Event] = []
    height = state.program_mm[2]
    for piece in range(1, CURVE_PIECES + 1):
        t = piece / CURVE_PIECES
        x, y = end[:2] if piece == CURVE_PIECES else _bezier(controls, t)
        point = (x, y, height + t * (end[2] - height))
        state, more = straight(state, command, state.frame.to_machine(point), rapid=False)
        events.extend(more)
    return state, tuple(events)


def _bezier(controls: list[tuple[float, float]], t: float) -> tuple[float, float]:
    weights = [math.comb(3, k) * t**k * (1.0 - t) ** (3 - k) for k in range(4)]
    x, y = (sum(w * c[axis] for w, c in zip(weights, controls, strict=True)) for axis in (0, 1))
    return x, y


def _between(a: tuple[float, float], b: tuple[float, float], part: float) -> tuple[float, float]:
    return (a[0] + part * (b[0] - a[0]), a[1] + part * (b[1] - a[1]))


def _plane(state: State, command: Command) -> None:
    if state.machine.plane != 17:
        problem = f"{state.modes.motion} in G{state.machine.plane}"
        raise command.block.error(None, "spline-plane", problem, "G17")


def _needed(state: State, command: Command, letter: str) -> float:
    word = command.words.get(letter)
    if word is None:
        raise _missing(command, None, f"{letter} with {state.modes.motion}")
    return word.value * state.modes.unit_mm


def _missing(command: Command, word: Word | None, expected: str) -> Exception:
    return command.block.error(word, "missing-word", "a spline without its control points", expected)
