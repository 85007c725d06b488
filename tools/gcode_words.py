"""Letters and steps of a block, in words."""

from __future__ import annotations

from collections.abc import Callable, Mapping

from gcode.control.command import _COMPANIONS as COMPANIONS
from gcode.control.command import _CORNERED as CORNERED
from gcode.dialects import Dialect

#: Letters and the meaning of their words, in the order of the page.
LETTERS: tuple[tuple[str, str], ...] = (
    ("N", "block number, also the target of jumps"),
    ("O", "program number; in LinuxCNC also the start of a line of a subroutine, loop or branch"),
    ("G", "preparatory code"),
    ("M", "miscellaneous code"),
    ("X", "axis; on FANUC and Haas also the dwell of G4, seconds"),
    ("Y", "axis"),
    ("Z", "axis"),
    ("A", "rotary axis, degrees"),
    ("B", "rotary axis, degrees"),
    ("C", "rotary axis, degrees"),
    ("U", "parallel axis"),
    ("V", "parallel axis"),
    ("W", "parallel axis"),
    ("I", "arc centre along x; shift or peck of a cycle; control point of a spline"),
    ("J", "arc centre along y; shift or peck of a cycle; control point of a spline"),
    ("K", "arc centre along z; repeat count (FANUC) or peck (Haas) of a cycle; pitch of G33"),
    ("R", "arc radius; R level of a cycle; angle of G68; offset value of G10"),
    ("P", "dwell time; number of a program, work offset or tool offset; turns of an arc; scale factor of G51"),
    ("Q", "peck or shift of a cycle; block number of M98; tool of M61"),
    ("L", "repeat count; type of data of G10"),
    ("F", "feed rate"),
    ("S", "spindle speed"),
    ("T", "tool for the next M6"),
    ("H", "tool length offset number"),
    ("D", "cutter radius offset number; maximum spindle speed with G96; tool diameter with G41.1"),
    ("E", "accuracy of G187; number of an analog output"),
    (",C", "chamfer at the end of a motion"),
    (",R", "corner rounding at the end of a motion"),
    ("@", "polar radius"),
    ("^", "polar angle"),
    ("$", "spindle number"),
)

#: Contents of each step of a block (`Dialect.order`).
PHASES: Mapping[str, str] = {
    "feed_mode": "feed mode: G93 G94 G95",
    "modes": "modes: plane, units, G90 G91, motion code, return level",
    "feed": "feed rate: F",
    "tool": "tool number: T",
    "tool_change": "tool change: M6 M61 M16",
    "speed_mode": "spindle speed mode: G96 G97",
    "speed": "spindle speed: S",
    "spindle_on": "spindle on: M3 M4",
    "rigid_tapping": "rigid tapping: M29",
    "coolant_on": "coolant on: M7 M8",
    "transform_off": "transforms off: G15 G50 G50.1 G69",
    "work_offset": "work offset: G54 and the like",
    "shift": "shifts: G52 G92 and the like",
    "length": "tool length: G43 G44 G49 H",
    "radius": "cutter compensation: G40 G41 G42 D",
    "data": "offset data: G10",
    "transform": "transforms on: G16 G51 G51.1 G68",
    "notice": "codes that cause no motion (notices)",
    "dwell": "dwell: G4",
    "reference": "reference points: G27 to G30, G60",
    "motion": "motion, also with G53",
    "spindle_off": "spindle stop and orientation: M5 M19",
    "coolant_off": "coolant off: M9",
    "call": "calls: M97 M98 M99 G65 G66",
    "stop": "stops and program ends: M0 M1 M2 M30 M60",
    "state": "saved state: M70 to M73",
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
