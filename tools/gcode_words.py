"""Letters and steps of a block, in words."""

from __future__ import annotations

from collections.abc import Callable, Mapping

from gcode.control.command import _COMPANIONS as COMPANIONS
from gcode.control.command import _CORNERED as CORNERED
from gcode.dialects import Dialect

#: Letters and the meaning of their words, in the order of the page.
LETTERS: tuple[tuple[str, str], ...] = (
    ("N", "number of a block, a label for jumps"),
    ("O", "number of a program; in LinuxCNC also a line of a subroutine, loop or branch"),
    ("G", "preparatory code"),
    ("M", "miscellaneous code"),
    ("X", "axis; in FANUC and Haas seconds of G4"),
    ("Y", "axis"),
    ("Z", "axis"),
    ("A", "rotary axis, degrees"),
    ("B", "rotary axis, degrees"),
    ("C", "rotary axis, degrees"),
    ("U", "parallel axis"),
    ("V", "parallel axis"),
    ("W", "parallel axis"),
    ("I", "centre of an arc along x; shift or peck of a cycle; control point of a spline"),
    ("J", "centre of an arc along y; shift or peck of a cycle; control point of a spline"),
    ("K", "centre of an arc along z; repeat (FANUC) or peck (Haas) of a cycle; pitch of G33"),
    ("R", "radius of an arc; level R of a cycle; angle of G68; radius in G10"),
    ("P", "dwell; number of a program, of a work offset or of data; turns of an arc; scale of G51"),
    ("Q", "peck or shift of a cycle; label of M98; tool of M61"),
    ("L", "repeat; kind of data of G10"),
    ("F", "feed"),
    ("S", "spindle speed"),
    ("T", "tool for the next M6"),
    ("H", "number of the tool length offset"),
    ("D", "number of the cutter radius; largest speed with G96; diameter with G41.1"),
    ("E", "accuracy of G187, number of an analog output"),
    (",C", "chamfer at the end of the motion"),
    (",R", "rounding at the end of the motion"),
    ("@", "polar distance"),
    ("^", "polar angle"),
    ("$", "number of the spindle"),
)

#: Contents of each step of a block (`Dialect.order`).
PHASES: Mapping[str, str] = {
    "feed_mode": "feed mode: G93 G94 G95",
    "modes": "modes: plane, units, G90 G91, motion code, return level",
    "feed": "F",
    "tool": "T",
    "tool_change": "tool change: M6 M61 M16",
    "speed_mode": "G96 G97",
    "speed": "S",
    "spindle_on": "M3 M4",
    "rigid_tapping": "M29",
    "coolant_on": "M7 M8",
    "transform_off": "G15 G50 G50.1 G69",
    "work_offset": "work offset: G54...",
    "shift": "G52 G92...",
    "length": "tool length: G43 G44 G49 H",
    "radius": "cutter compensation: G40 G41 G42 D",
    "data": "G10",
    "transform": "G16 G51 G51.1 G68",
    "notice": "codes without motion: notices",
    "dwell": "G4",
    "reference": "reference points: G27 to G30, G60",
    "motion": "the motion, with G53",
    "spindle_off": "M5 M19",
    "coolant_off": "M9",
    "call": "calls: M97 M98 M99 G65 G66",
    "stop": "stops and ends: M0 M1 M2 M30 M60",
    "state": "M70 to M73",
}
#: Steps of words without a code.
WORD_PHASES = frozenset({"feed", "speed", "tool", "motion"})


def letter_status(letter: str) -> Callable[[Dialect], str]:
    """Status of a letter's words, by dialect: ``any block``, ``run`` (with a code), ``refused`` or none."""

    def status(dialect: Dialect) -> str:
        if letter in dialect.free_letters or letter in "GM":
            return "any block"
        if letter in _taken(dialect):
            return "run"
        return "refused" if letter in dialect.refused_letters else "–"

    return status


def _taken(dialect: Dialect) -> frozenset[str]:
    """Letters that some code of the dialect takes."""
    letters = {letter for rule in dialect.codes.values() for letter in rule.letters if rule.letters != "*"}
    letters.update(dialect.corner_letters if not CORNERED.isdisjoint(dialect.codes) else ())
    letters.update(companion for free, companion in COMPANIONS.items() if free in letters)
    return frozenset(letters - set(dialect.refused_letters))
