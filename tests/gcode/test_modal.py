"""Modal groups, word ownership and the tables themselves; a refused block leaves the state whole."""

from __future__ import annotations

from collections.abc import Callable

import pytest

from gcode.control.command import resolve
from gcode.control.state import State, initial_state
from gcode.dialects import DIALECTS, Dialect, dialect_named
from gcode.dialects.codes import Status
from gcode.errors import GcodeError, Place
from gcode.events import Block, LinearMotion, Notice
from gcode.flow.step import PHASES, step
from gcode.language.block_parser import parse_line
from gcode.language.blocks import ParsedBlock
from gcode.settings import MachineSettings, ToolOffset

ALL = pytest.mark.parametrize("dialect", DIALECTS.values(), ids=DIALECTS.keys())


def run_block(state: State, text: str) -> State:
    return step(state, parse_line(Place(file="t.nc", line=1, text=text)))[0]


def refusal_of(run: Callable[[State, ParsedBlock], object], state: State, text: str) -> GcodeError:
    with pytest.raises(GcodeError) as caught:
        run(state, parse_line(Place(file="t.nc", line=1, text=text), state.control.dialect))
    return caught.value


@ALL
def test_every_executed_code_has_a_phase_that_exists(dialect: Dialect) -> None:
    for rule in dialect.codes.values():
        if rule.status is Status.EXECUTED and rule.code != "G53":
            assert rule.phase in dialect.order, rule.code
        if rule.status in (Status.NEUTRAL, Status.REFUSED):
            assert rule.phase == "", rule.code


@ALL
def test_the_order_of_execution_names_each_phase_that_is_asked_for_once(dialect: Dialect) -> None:
    assert len(set(dialect.order)) == len(dialect.order)
    assert set(dialect.order) <= set(PHASES)


def test_every_phase_is_of_some_dialect() -> None:
    assert {phase for dialect in DIALECTS.values() for phase in dialect.order} == set(PHASES)


@ALL
def test_tables_cannot_be_changed(dialect: Dialect) -> None:
    with pytest.raises(TypeError):
        dialect.codes["G1"] = dialect.codes["G0"]  # type: ignore[index]


@ALL
def test_every_refused_code_says_its_name(dialect: Dialect, refusal) -> None:
    for rule in dialect.codes.values():
        if rule.status is Status.REFUSED:
            error = refusal(f"N1 {rule.code}", dialect.name)
            assert (error.place.column, error.code) == (4, "unsupported-code")
            assert error.problem == f"{rule.code} ({rule.meaning}) is not supported"


@ALL
def test_every_code_without_motion_gives_a_notice(dialect: Dialect, run) -> None:
    for rule in dialect.codes.values():
        if rule.status is Status.NOTICE:
            block = rule.code + "".join(f" {letter}1" for letter in rule.needs)
            notices = [e for e in run(f"{block}\nM2", dialect.name) if isinstance(e, Notice)]
            text = f"{rule.code} ({rule.meaning}) has no effect on the simulated motion"
            assert [(n.code, n.text) for n in notices if not n.is_warning] == [("no-motion", text)]
            assert [n.code for n in notices if n.is_warning] == ["build-option"] * bool(rule.option)


@ALL
def test_two_codes_of_a_group_are_refused(dialect: Dialect) -> None:
    usable = [r for r in dialect.codes.values() if r.status is not Status.REFUSED]
    for first in usable:
        for second in usable:
            shared = [group for group in second.groups if group in first.groups]
            if shared and (dialect.same_group == "refused" or "M" in first.code + second.code):
                error = refusal_of(resolve, initial_state(dialect, MachineSettings()), f"{first.code} {second.code}")
                assert str(error) == (
                    f"t.nc:1:{len(first.code) + 2}: {first.code} and {second.code} are both in the modal group "
                    f"{shared[0]}; expected one code of a group per block [group-conflict]"
                )


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("G777", "t.nc:1:1: G777 is not a code of the fanuc dialect [unknown-code]"),
        ("G0 M123", "t.nc:1:4: M123 is not a code of the fanuc dialect; expected another code, or "
         'm_codes = { 123 = "none" } (--m-code 123) where it moves nothing [unknown-code]'),
        ("G1.5", "t.nc:1:1: G1.5 is not a code of the fanuc dialect [unknown-code]"),
        ("G-1", "t.nc:1:1: G-1 is not a code of the fanuc dialect [unknown-code]"),
        ("G31 Z-5 F5", "t.nc:1:1: G31 (skip function: its end depends on a measurement) is not supported "
         "[unsupported-code]"),
        ("G1 X1 X2", "t.nc:1:7: X is given twice: X1 and X2; expected one X per block [repeated-word]"),
        ("M98 P10 L3", "t.nc:1:1: program O10 is not found; expected O10 in this file, or a file O0010 in the same "
         "folder or on the search path [unknown-program]"),
        ("G0 A90", "t.nc:1:4: A90: A is a rotary axis, which is not supported; expected A0, where the axis "
         "stays at 0 [unsupported-word]"),
        ("G0 X1 U5", "t.nc:1:7: U5: U is a parallel axis, which is not supported; expected U0, where the axis "
         "stays at 0 [unsupported-word]"),
        ("G1 X1 ,C2 F1", "t.nc:1:1: a corner at the end of the program; expected a feed motion in the plane after it "
         "[corner-no-motion]"),
        ("G0 X1 ,C2", "t.nc:1:7: ,C2 is not used by any code in this block or by the active motion code [unused-word]"),
        ("G0 X1 P5", "t.nc:1:7: P5 is not used by any code in this block or by the active motion code [unused-word]"),
        ("G0 X1 I5", "t.nc:1:7: I5 is not used by any code in this block or by the active motion code [unused-word]"),
        ("G4 X1 Y1", "t.nc:1:7: Y1 is not used by any code in this block or by the active motion code [unused-word]"),
        ("N1.5", "t.nc:1:1: N1.5 is not a whole number of 0 or more; expected N0, 1, 2... [bad-value]"),
        ("T-2", "t.nc:1:1: T-2 is not a whole number of 0 or more; expected T0, 1, 2... [bad-value]"),
        ("F-1", "t.nc:1:1: F-1 is negative; expected F of 0 or more [bad-value]"),
        ("S-1", "t.nc:1:1: S-1 is negative; expected S of 0 or more [bad-value]"),
        ("O1\nO2", "t.nc:2:1: O2 begins another program before the end of O1; expected M2, M30 or % before it "
         "[program-number]"),
    ],
)  # fmt: skip
def test_refusals(text: str, message: str, refusal) -> None:
    assert str(refusal(text)) == message


def test_linuxcnc_needs_a_motion_code_before_axis_words(refusal, motions) -> None:
    message = "t.nc:1:1: X1 without a motion code that takes it; expected G0, G1, G2 or G3 [axis-without-motion]"
    assert str(refusal("X1", "linuxcnc")) == message
    assert refusal("G0X1\nG80\nX2", "linuxcnc").place.line == 3
    assert motions("X1")[0].rapid


def test_fanuc_keeps_the_motion_code_over_g80(motions) -> None:
    assert [m.rapid for m in motions("G1 F1 X1\nG80\nX2\nG0 G80 X3")] == [False, False, True]


def test_two_takers_of_the_axis_words(refusal, motions) -> None:
    expected = "t.nc:1:4: G0 and G28 both take the axis words; expected one of them in a block [axis-conflict]"
    assert str(refusal("G0 G28 X1", "linuxcnc")) == expected
    moved = motions("G1 G28 Z10. F5.\nX1", home_mm=(0, 0, 50))
    assert [(m.end_mm, m.rapid) for m in moved] == [((0, 0, 10), True), ((0, 0, 50), True), ((1, 0, 50), False)]


@pytest.mark.parametrize(
    "text", ["G20 G91 G18 F5. S9 T3 G777", "G54.1 P9 X1", "G1 G20 X1", "S5 M3 G43 H9", "T1 M6 G2 X1 F1"]
)
def test_a_refused_block_leaves_the_state_whole(text: str) -> None:
    settings = MachineSettings(tools={1: ToolOffset()}, offsets={"G54": (0.0, 0.0, 0.0)})
    before, twin = (initial_state(dialect_named("fanuc"), settings) for _ in range(2))
    with pytest.raises(GcodeError):
        run_block(before, text)
    assert before == twin


def test_each_block_with_words_is_told_before_its_events(run) -> None:
    events = run("%\nO1(A)\n\n(comment)\nG0 X1\nM30\n%")
    assert [(type(e), e.place.line) for e in events][:3] == [(Block, 2), (Block, 5), (LinearMotion, 5)]
