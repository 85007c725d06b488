"""LinuxCNC's polar words: ``@`` is a distance from the program's zero in x and y, ``^`` an angle in degrees from +x."""

from __future__ import annotations

import math
from dataclasses import replace

from gcode.control.command import Command
from gcode.control.coordinates import SAME_POSITION_MM
from gcode.control.state import State
from gcode.language.blocks import Word

#: Letters of the two words.
POLAR_LETTERS = "@^"


def as_axis_words(state: State, command: Command) -> Command:
    """The block with X and Y words in place of its polar ones.

    A missing one is that of the present position, and with G91 both are counted from there.

    Raises:
        GcodeError: together with X, Y or G53, in an arc of another plane than XY, in an incremental cycle that is
            repeated, and at X0 Y0, which has no angle, where an angle is needed.
    """
    polar = [command.words[letter] for letter in POLAR_LETTERS if letter in command.words]
    if not polar:
        return command
    first = polar[0]
    machine_move = command.code("G53")
    other = command.words.get("X") or command.words.get("Y") or (machine_move and machine_move.word)
    if other:
        problem = f"{first.text} together with {other.text}"
        raise command.block.error(first, "polar-words", problem, "polar words without X, Y and G53")
    if state.modes.motion in ("G2", "G3") and state.machine.plane != 17:
        problem = f"{first.text} in an arc in plane G{state.machine.plane}"
        raise command.block.error(first, "polar-words", problem, "G17")
    if "L" in command.words and not state.modes.absolute:
        problem = f"{first.text} with G91 together with {command.words['L'].text}"
        raise command.block.error(first, "polar-words", problem, "a block for each hole, or G90")
    x, y = _target(state, command, first)
    words = {letter: word for letter, word in command.words.items() if letter not in POLAR_LETTERS}
    return replace(command, words={**words, "X": _word("X", x, first), "Y": _word("Y", y, first)})


def _target(state: State, command: Command, first: Word) -> tuple[float, float]:
    """Numbers of the X and Y words of the target."""
    modes = state.modes
    here_x, here_y, _ = (coordinate / modes.unit_mm for coordinate in state.program_mm)
    distance, angle = math.hypot(here_x, here_y), math.degrees(math.atan2(here_y, here_x))
    given_distance, given_angle = (command.words.get(letter) for letter in POLAR_LETTERS)
    if distance * modes.unit_mm <= SAME_POSITION_MM and (given_angle is None or not modes.absolute):
        problem = f"{first.text} where the tool is at X0 Y0, which has no angle"
        raise command.block.error(first, "polar-words", problem, "@ and ^ with G90, or a start elsewhere")
    if given_distance:
        distance = given_distance.value + (0.0 if modes.absolute else distance)
    if given_angle:
        angle = given_angle.value + (0.0 if modes.absolute else angle)
    x, y = distance * math.cos(math.radians(angle)), distance * math.sin(math.radians(angle))
    if not modes.absolute:
        x, y = x - here_x, y - here_y
    return (2.0 * x if modes.diameter else x), y


def _word(letter: str, value: float, source: Word) -> Word:
    return Word(letter, value, source.text, source.column)
