"""Modal and one-shot codes of FANUC mills, and what is refused by name."""

from __future__ import annotations

import pytest

from gcode.events import Dwell, LinearMotion, Notice, SpindleChange
from gcode.settings import ToolOffset

ONE_SHOTS = {
    "G4": "G4 P100",
    "G9": "G9 X5.",
    "G10": "G10 L2 P1 X0",
    "G28": "G28 X5.",
    "G30": "G30 X5.",
    "G52": "G52 X0",
    "G53": "G53 X5.",
    "G92": "G92 X5.",
}
HOME = {"reference_points_mm": {2: (5.0, 0.0, 0.0)}, "home_mm": (5.0, 0.0, 0.0)}


@pytest.mark.parametrize("block", ONE_SHOTS.values(), ids=ONE_SHOTS.keys())
@pytest.mark.parametrize("motion", ["G1", "G0"])
def test_one_shot_codes_hold_for_their_block_alone(block: str, motion: str, motions) -> None:
    """FANUC 30i user's manual, "Preparatory function": codes of group 00 are effective only in their block; the code
    of group 01 holds on."""
    last = motions(f"{motion} X5. F100\n{block}\nX7.", **HOME)[-1]
    assert (last.end_mm, last.rapid) == ((7, 0, 0), motion == "G0")


def test_codes_of_different_groups_stand_in_one_block(motions) -> None:
    """The same chapter: G codes of different groups can be given in one block."""
    (moved,) = motions("G91 G20 G1 G41 D1 X1. F2.", tools={1: ToolOffset()})
    assert moved.feed_mm_min == pytest.approx(50.8)
    assert (moved.state.compensation, moved.end_mm[0]) == ("left", pytest.approx(25.4))


@pytest.mark.parametrize("code", ["G0", "G1", "G2", "G3"])
def test_a_code_of_group_01_cancels_a_canned_cycle(code: str, motions) -> None:
    """FANUC 30i user's manual, "Canned cycle for drilling", cancel: G80 or a group 01 G code."""
    words = "R20." if code in ("G2", "G3") else ""
    moved = motions(f"G0 Z10.\nG81 X5. Z-3. R2. F100\n{code} X20. {words}")
    assert [m.end_mm for m in moved][-1] == (20, 0, 10)
    assert len(moved) == 1 + 4 + 1


def test_the_cycle_leaves_the_code_of_group_01_as_it_was(strokes) -> None:
    """The same chapter: canned cycle codes do not change group 01, so after G80 the code before them holds."""
    cycle = "G81 X5. Z-3. R2.\nG80\nX9."
    assert strokes(f"G1 X1. F100\n{cycle}")[-1] == "F 9 0 0"
    assert strokes(f"G0 X1. F100\n{cycle}")[-1] == "R 9 0 0"


def test_a_cycle_beside_g0_is_the_cycle(strokes) -> None:
    """The same chapter: with a group 01 code before a canned cycle's in one block the cycle is run."""
    assert strokes("Z5.\nG0 G81 X5. Z-3. R2. F9")[1:] == ["R 5 0 5", "R 5 0 2", "F 5 0 -3", "R 5 0 5"]


def test_g80_beside_g0_moves_at_rapid(strokes) -> None:
    assert strokes("G1 F9 X1.\nG81 Z-3. R2. X2.\nG80 G0 X9.")[-1] == "R 9 0 0"


@pytest.mark.parametrize("motion", ["G0", "G1"])
def test_axis_words_beside_g80_move_as_before_the_cycle(motion: str, strokes) -> None:
    """FANUC 30i user's manual, "Canned cycle for drilling", cancel: G80 leaves the code of group 01 to the block."""
    told = strokes(f"{motion} X1. F9\nG81 Z-3. R2. X2.\nG80 Z9. M9")
    assert told[-1] == ("R 2 0 9" if motion == "G0" else "F 2 0 9")


def test_modes_at_power_on(motions) -> None:
    """FANUC 30i user's manual, G code list: the codes that hold when the power is turned on."""
    (moved,) = motions("X5.")
    state = moved.state
    assert (moved.rapid, moved.end_mm) == (True, (5, 0, 0))
    assert (state.plane, state.feed_mode, state.wcs, state.compensation) == (17, "per-minute", "G54", "off")
    assert (state.length_offset_mm, state.tool, state.spindle_direction) == (0, 0, 0)


def test_feed_is_modal_and_counts_in_the_unit_of_its_block(motions) -> None:
    moved = motions("G21 G1 X1. F100\nX2.\nG20\nX3. F10.\nG21\nX4.")
    assert [m.feed_mm_min for m in moved] == [100, 100, 254, 254]


def test_feed_per_revolution(motions) -> None:
    """FANUC 30i user's manual, "Feed functions", G95: the tool moves F for each revolution of the spindle."""
    moved = motions("S1200 M3\nG95 G1 X1. F0.1\nS600\nX2.")
    assert [m.feed_mm_min for m in moved] == pytest.approx([120, 60])


def test_inverse_time(motions, refusal) -> None:
    """The same chapter, G93: F is the inverse of the minutes that the block takes; it is needed in every block."""
    moved = motions("G93 G1 X30. F2.\nX33. Y4. F10.")
    assert [m.feed_mm_min for m in moved] == pytest.approx([60, 50])
    assert refusal("G93 G1 X30. F2.\nX40.").code == "missing-feed"


def test_dwell_words(run) -> None:
    """FANUC 30i user's manual, "Dwell": P counts milliseconds without a decimal point, X seconds."""
    waits = [e.seconds for e in run("G4 P1500\nG4 X2.5\nG1 F5 X1.\nG04 P1") if isinstance(e, Dwell)]
    assert waits == pytest.approx([1.5, 2.5, 0.001])


def test_tool_change_prepares_the_tool_of_the_last_t(motions) -> None:
    """FANUC 30i user's manual, "Tool function": T selects, M6 changes; T after M6 prepares the next one."""
    assert [m.state.tool for m in motions("T3 M6\nT8\nX1.\nM6\nX2.")] == [3, 8]


def test_optional_block_skip_takes_a_number(ends) -> None:
    """FANUC 30i user's manual, "Program configuration": / or /n at the head of a block skips it with the switch."""
    assert ends("X1.\n/X2.\n/3 X3.\nN4 X4.", block_delete=True) == [(1, 0, 0), (4, 0, 0)]
    assert len(ends("X1.\n/X2.\n/3 X3.\nN4 X4.")) == 4


REFUSED = {
    "G68.2 X0 Y0 Z0 I0 J30. K0": "G68.2 (tilted working plane: five-axis machining) is not supported",
    "G43.4 H1": "G43.4 (tool centre point control: five-axis machining) is not supported",
    "G53.1": "G53.1 (tool axis direction control: five-axis machining) is not supported",
    "G31 Z-5. F50": "G31 (skip function: its end depends on a measurement) is not supported",
    "G37 Z0": "G37 (automatic tool length measurement: its end depends on a measurement) is not supported",
    "G12.1": "G12.1 (polar coordinate interpolation) is not supported",
    "G7.1 C20.": "G7.1 (cylindrical interpolation) is not supported",
    "G33 Z-5. F1.": "G33 (threading) is not supported",
    "G45 X5. D1": "G45 (tool offset increase) is not supported",
    "G0 A90.": "A90.: A is a rotary axis, which is not supported",
    "G1 X1. B45. F5": "B45.: B is a rotary axis, which is not supported",
    "G0 C10.": "C10.: C is a rotary axis, which is not supported",
    "G0 W10.": "W10.: W is a parallel axis, which is not supported",
}


@pytest.mark.parametrize(("block", "problem"), REFUSED.items())
def test_what_is_not_supported_is_refused_by_name(block: str, problem: str, refusal) -> None:
    error = refusal(f"G0 X1.\n{block}\nX2.")
    assert (error.problem, error.place.line) == (problem, 2)
    assert error.code in ("unsupported-code", "unsupported-word")


@pytest.mark.parametrize("kind", ["L3", "L50"])
def test_tool_life_and_parameter_data_are_told_and_skipped(kind: str, run) -> None:
    """FANUC 30i user's manual, "Tool life management" (G10 L3 ... G11) and "Programmable parameter input" (L50)."""
    events = run(f"G0 X1.\nG10 {kind}\nP1 L60\nT3 H3 D3\nT13 H13 D13\nG11\nX2.\nM30")
    assert [e.end_mm[0] for e in events if isinstance(e, LinearMotion)] == [1, 2]
    assert [(e.place.line, e.code) for e in events if isinstance(e, Notice)] == [(n, "data-entry") for n in range(2, 6)]


def test_m19_stops_the_spindle(run) -> None:
    turns = [(e.place.line, e.spindle_direction) for e in run("S500 M3\nM19\nM30") if isinstance(e, SpindleChange)]
    assert turns == [(1, 1), (2, 0)]
