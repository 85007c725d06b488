"""Random cycles against LinuxCNC's own interpreter, where its stand-alone program ``rs274`` is installed.

A small control of this file's own keeps what a cycle needs to know between blocks and writes each block as text too.
The canonical listing has four decimals of the program's unit.
"""

from __future__ import annotations

import math
import random
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path

import pytest
from support.rs274 import AXES as AXIS_INDICES
from support.rs274 import NUMBER, RS274, TURNING, run_text

from gcode.cycles import (
    LINUXCNC_CYCLES,
    CycleError,
    CycleInput,
    Move,
    OperatorStop,
    Orient,
    Pause,
    Position,
    Spindle,
    run_cycle,
)

pytestmark = pytest.mark.skipif(RS274 is None, reason="rs274 is not installed")

TOLERANCE_MM = 0.003
AXES = {17: ("X", "Y", "Z"), 18: ("Z", "X", "Y"), 19: ("Y", "Z", "X")}


@dataclass
class Control:
    """What holds between blocks; lengths in mm."""

    plane: int
    unit_mm: float
    position: Position = (0.0, 0.0, 0.0)
    absolute: bool = True
    return_to_r: bool = False
    spindle: int = 1
    code: str = ""
    initial_level: float = 0.0
    sticky: dict[str, float] = field(default_factory=dict)
    lines: list[str] = field(default_factory=list)
    steps: list[tuple] = field(default_factory=list)

    def __post_init__(self) -> None:
        self.lines += [f"G{self.plane} G90 G98", "G21" if self.unit_mm == 1.0 else "G20", "F100", "S500 M3"]

    def line(self, head: str, words: dict[str, float]) -> None:
        numbers = " ".join(f"{letter}{number:.10g}" for letter, number in words.items())
        self.lines.append(f"{head} {numbers}".strip())

    def rapid(self, first: float, second: float, normal: float) -> None:
        """A G0 to a point in the program's unit, with G90; it ends the cycle mode."""
        self.absolute, self.code = True, ""
        self.line("G90 G0", dict(zip(AXES[self.plane], (first, second, normal), strict=True)))
        self.position = (first * self.unit_mm, second * self.unit_mm, normal * self.unit_mm)
        self.steps.append(("rapid", *self.position))

    def cancel(self) -> None:
        self.lines.append("G80")
        self.code = ""

    def cycle(self, code: str, words: dict[str, float], *, implicit: bool = False) -> None:
        """A block of a cycle, its numbers in the program's unit."""
        first = not self.code
        if first:
            self.initial_level = self.position[2]
        modes = f"{'G90' if self.absolute else 'G91'} {'G99' if self.return_to_r else 'G98'}"
        self.line(f"{modes} {'' if implicit else code}", words)
        lengths = {key: n if key in "PL" else n * self.unit_mm for key, n in words.items()}
        call = CycleInput(
            code=code,
            words=lengths,
            sticky=self.sticky,
            position=self.position,
            axes=AXES[self.plane],
            absolute=self.absolute,
            return_to_r=self.return_to_r,
            initial_level=self.initial_level,
            spindle_direction=self.spindle,
            first_of_mode=first,
            unit_mm=self.unit_mm,
        )
        done = run_cycle(LINUXCNC_CYCLES, call)
        self.code, self.position, self.sticky = code, done.position, dict(done.sticky)
        self.steps += [self.seen(step) for step in done.steps]

    def seen(self, step: object) -> tuple:
        if isinstance(step, Move):
            return ("rapid" if step.rapid else "feed", *step.end)
        if isinstance(step, Pause):
            return ("dwell", step.seconds)
        if isinstance(step, Spindle):
            return ("spindle", float(step.direction))
        assert isinstance(step, Orient | OperatorStop)
        return ("orient",) if isinstance(step, Orient) else ("stop",)


def theirs(calls: Sequence[tuple[str, str]], control: Control) -> list[tuple]:
    """The steps of a canonical listing in the plane's coordinates, mm."""
    places = AXIS_INDICES[control.plane]
    steps: list[tuple] = []
    started = False
    for name, inside in calls:
        numbers = [float(n) for n in NUMBER.findall(inside)]
        if name == "SET_FEED_RATE":
            started = numbers[0] > 0.0
        if name in ("STRAIGHT_TRAVERSE", "STRAIGHT_FEED"):
            kind = "rapid" if name.endswith("TRAVERSE") else "feed"
            steps.append((kind, *(numbers[place] * control.unit_mm for place in places)))
        elif name == "DWELL" and numbers[0] > 0.0:
            steps.append(("dwell", numbers[0]))
        elif name == "STOP_SPINDLE_TURNING" and started:
            steps.append(("spindle", 0.0))
        elif name.startswith("START_SPINDLE"):
            steps.append(("spindle", float(TURNING[name])))
        elif name in ("ORIENT_SPINDLE", "PROGRAM_STOP"):
            steps.append(("orient" if name.startswith("ORIENT") else "stop",))
    return settled(steps)


def settled(steps: list[tuple]) -> list[tuple]:
    """Without a stop of the spindle that is a part of turning it round or orienting it."""
    kept: list[tuple] = []
    for step in steps:
        if kept and kept[-1] == ("spindle", 0.0) and step[0] in ("spindle", "orient"):
            kept.pop()
        kept.append(step)
    return kept


def same(ours: list[tuple], expected: list[tuple], text: str) -> None:
    assert [step[0] for step in ours] == [step[0] for step in expected], text
    for number, (step, wanted) in enumerate(zip(ours, expected, strict=True)):
        assert math.dist(step[1:], wanted[1:]) < TOLERANCE_MM, (number, step, wanted, text)


#: Between programs: dwell and modes of a cycle are kept after it, and the next program takes none of them over.
RESET = "G17 G21 G90 G98 F100 S500 M3\nG0 Z10\nG82 X0 Y0 Z-1 R1 P0\nG80 M5\n"


def compare(controls: Sequence[Control], folder: Path) -> None:
    """Run programs one after the other in one process, each between two comments."""
    texts = ["\n".join([*control.lines, ""]) for control in controls]
    output = run_text("".join(f"{RESET}(BEGIN)\n{text}(END)\n" for text in texts) + "M2\n", folder)
    assert not output.error, output.error
    begins, ends = (
        [n for n, call in enumerate(output.calls) if call == ("COMMENT", f'"{word}"')] for word in ("BEGIN", "END")
    )
    for control, text, begin, end in zip(controls, texts, begins, ends, strict=True):
        turning_on, *expected = theirs(output.calls[begin:end], control)
        assert turning_on == ("spindle", 1.0)
        same(control.steps, expected, text)


def random_words(source: random.Random, control: Control, code: str, *, all_of_them: bool) -> dict[str, float]:
    """Words of a hole that is right: the bottom below R, and what the cycle needs."""
    first, second, normal = control_axes = AXES[control.plane]
    size = 1.0 if control.unit_mm == 1.0 else 0.1
    words: dict[str, float] = {}

    def length(low: float, high: float) -> float:
        return round(source.uniform(low, high) * size, 3)

    for axis in (first, second):
        if source.random() < 0.7:
            words[axis] = length(-40.0, 40.0)
    if all_of_them or source.random() < 0.4:
        if control.absolute:
            words["R"], words[normal] = length(-5.0, 12.0), length(-20.0, -5.0)
        else:
            words["R"], words[normal] = length(-12.0, 6.0), length(-15.0, 0.0)
    cycle = LINUXCNC_CYCLES.cycles[code]
    values = {"P": source.choice([0.0, 0.5, 2.0]), "Q": source.choice([length(0.4, 6.0), 2.0 * size, 0.1 * size])}
    values |= {letter: length(-3.0, 3.0) for letter in "IJK"}
    for letter in cycle.takes:
        if (all_of_them and letter in cycle.needs) or source.random() < 0.3:
            words[letter] = values[letter]
    if cycle.repeats and source.random() < 0.3:
        words["L"] = float(source.randint(1, 3))
    if not any(axis in words for axis in control_axes):
        words[first] = length(-40.0, 40.0)
    return words


def random_control(source: random.Random) -> Control:
    control = Control(source.choice([17, 18, 19]), source.choice([1.0, 1.0, 25.4]))
    scale = 1.0 if control.unit_mm == 1.0 else 0.1
    control.rapid(0.0, 0.0, 10.0 * scale)
    for _ in range(12):
        kind = source.choice(["hole", "hole", "same", "same", "same", "move", "cancel", "spindle"])
        control.return_to_r = source.random() < 0.5
        if kind == "move":
            control.rapid(*(round(source.uniform(-10.0, 10.0) * scale, 3) for _ in range(3)))
        elif kind == "cancel":
            control.cancel()
        elif kind == "spindle":
            control.spindle = source.choice([-1, 1])
            control.lines.append("M3" if control.spindle > 0 else "M4")
            control.steps.append(("spindle", float(control.spindle)))
        elif kind == "same" and control.code:
            if control.spindle in LINUXCNC_CYCLES.cycles[control.code].spindle:
                words = random_words(source, control, control.code, all_of_them=False)
                control.cycle(control.code, words, implicit=source.random() < 0.5)
        else:
            codes = [c for c, cycle in LINUXCNC_CYCLES.cycles.items() if control.spindle in cycle.spindle]
            code = source.choice(codes)
            control.absolute = source.random() < 0.6
            control.cycle(code, random_words(source, control, code, all_of_them=True))
    return control


def test_random_cycles(tmp_path: Path) -> None:
    compare([random_control(random.Random(seed)) for seed in range(60)], tmp_path)


@pytest.mark.parametrize("code", LINUXCNC_CYCLES.cycles)
def test_every_cycle_with_a_row_of_holes(code: str, tmp_path: Path) -> None:
    compare([row_of_holes(code, plane, to_r) for plane in AXES for to_r in (True, False)], tmp_path)


def row_of_holes(code: str, plane: int, return_to_r: bool) -> Control:
    source = random.Random(f"{code}{plane}{return_to_r}")
    control = Control(plane, 1.0)
    if code == "G74":
        control.spindle = -1
        control.lines.append("M4")
        control.steps.append(("spindle", -1.0))
    control.rapid(1.0, 2.0, 10.0)
    control.return_to_r = return_to_r
    control.cycle(code, random_words(source, control, code, all_of_them=True))
    control.cycle(code, {AXES[plane][0]: 7.0}, implicit=True)
    control.rapid(3.0, 4.0, 6.0)
    control.absolute = False
    words = random_words(source, control, code, all_of_them=True) | {AXES[plane][0]: 5.0, "L": 3.0}
    if not LINUXCNC_CYCLES.cycles[code].repeats:
        del words["L"]
    control.cycle(code, words)
    return control


PECKS = [(0.1, 2.0, -1.0), (0.1, 0.1, -0.6), (0.3, 1.0, -2.0), (1.5, 2.0, -4.0), (0.7, 0.7, -1.4), (0.2, 1.0, -1.0)]


def test_as_many_pecks_where_they_end_at_the_bottom(tmp_path: Path) -> None:
    compare([pecks(*sizes, unit_mm) for sizes in PECKS for unit_mm in (1.0, 25.4)], tmp_path)


def pecks(peck: float, r: float, bottom: float, unit_mm: float) -> Control:
    control = Control(17, unit_mm)
    control.rapid(0.0, 0.0, 3.0)
    control.cycle("G83", {"X": 1.0, "Z": bottom, "R": r, "Q": peck})
    control.cycle("G73", {"X": 2.0, "Z": bottom, "R": r, "Q": peck})
    return control


def test_numbers_given_before_take_the_unit_in_force(tmp_path: Path) -> None:
    control = Control(17, 1.0)
    control.rapid(0.0, 0.0, 40.0)
    control.return_to_r = True
    control.cycle("G81", {"X": 1.0, "Z": -1.0, "R": 1.0})
    control.lines.append("G20")
    before = replace(control, unit_mm=25.4, lines=[], steps=[])
    before.cycle("G81", {"X": 1.0}, implicit=True)
    text = "\n".join([*control.lines, *before.lines[4:], "M2", ""])
    feeds = [inside for name, inside in run_text(text, tmp_path).calls if name == "STRAIGHT_FEED"]
    assert feeds[-1].startswith("1.0000, 0.0000, -1.0000")
    assert ("feed", 25.4, 0.0, -25.4) in before.steps


REFUSED = [
    ("G81", {"X": 1.0, "R": 1.0}, "cycle-missing-word"),
    ("G81", {"X": 1.0, "Z": 1.0}, "cycle-missing-word"),
    ("G81", {"R": 1.0}, "cycle-missing-word"),
    ("G82", {"X": 1.0, "Z": -1.0, "R": 1.0}, "cycle-missing-word"),
    ("G83", {"X": 1.0, "Z": -1.0, "R": 1.0}, "cycle-missing-word"),
    ("G87", {"X": 1.0, "Z": -1.0, "R": 1.0, "I": 1.0, "J": 1.0}, "cycle-missing-word"),
    ("G81", {"X": 1.0, "Z": 3.0, "R": 1.0}, "cycle-level"),
    ("G83", {"X": 1.0, "Z": -1.0, "R": 1.0, "Q": 0.0}, "cycle-peck"),
    ("G73", {"X": 1.0, "Z": -1.0, "R": 1.0, "Q": -2.0}, "cycle-peck"),
    ("G81", {"X": 1.0, "Z": -1.0, "R": 1.0, "L": 0.0}, "cycle-repeat"),
    ("G81", {"X": 1.0, "Z": -1.0, "R": 1.0, "L": 1.5}, "cycle-repeat"),
    ("G81", {"X": 1.0, "Z": -1.0, "R": 1.0, "L": -2.0}, "cycle-repeat"),
    ("G81", {"X": 1.0, "Z": -1.0, "R": 1.0, "P": 1.0}, "cycle-word"),
    ("G81", {"X": 1.0, "Z": -1.0, "R": 1.0, "Q": 1.0}, "cycle-word"),
    ("G81", {"X": 1.0, "Z": -1.0, "R": 1.0, "I": 1.0}, "cycle-word"),
    ("G81", {"X": 1.0, "Z": -1.0, "R": 1.0, "K": 1.0}, "cycle-word"),
    ("G74", {"X": 1.0, "Z": -1.0, "R": 1.0}, "cycle-spindle"),
    ("G76", {"X": 1.0, "Z": -1.0, "R": 1.0}, "cycle-unsupported"),
]


@pytest.mark.parametrize(("code", "words", "refusal"), REFUSED)
def test_what_they_refuse_is_refused(code: str, words: dict[str, float], refusal: str, tmp_path: Path) -> None:
    control = Control(17, 1.0)
    control.rapid(0.0, 0.0, 10.0)
    with pytest.raises(CycleError) as error:
        control.cycle(code, words)
    assert error.value.code == refusal
    assert run_text("\n".join([*control.lines, "M2", ""]), tmp_path).error


def test_another_cycle_asks_for_its_words_again(tmp_path: Path) -> None:
    control = Control(17, 1.0)
    control.rapid(0.0, 0.0, 10.0)
    control.cycle("G81", {"X": 1.0, "Z": -1.0, "R": 1.0})
    with pytest.raises(CycleError) as error:
        control.cycle("G85", {"X": 1.0, "R": 1.0})
    assert (error.value.code, error.value.letter) == ("cycle-missing-word", "Z")
    assert run_text("\n".join([*control.lines, "M2", ""]), tmp_path).error
