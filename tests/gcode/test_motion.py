"""Straight motions: units, distance mode, work offsets, G28, G53, tool length offsets, feeds."""

from __future__ import annotations

from itertools import pairwise

import pytest

from gcode.events import LinearMotion, Notice
from gcode.settings import ToolOffset

LENGTHS = {1: ToolOffset(length_mm=100.0), 2: ToolOffset(length_mm=60.0)}


def ends(motions: list) -> list[tuple[float, float, float]]:
    return [m.end_mm for m in motions]


def test_a_motion_says_all_that_holds_while_it_is_made(motions) -> None:
    text = "T7 M6 S1200 M4\nG55 G43 H2\nG19 G1 X1. Y2. Z3. F250."
    (motion,) = motions(text, offsets={"G55": (10, 20, 30)}, tools=LENGTHS, start_mm=(0, 0, 500))
    assert isinstance(motion, LinearMotion)
    assert (motion.start_mm, motion.end_mm) == ((0, 0, 440), (11, 22, 33))
    assert (motion.rapid, motion.feed_mm_min, motion.place.line) == (False, 250, 3)
    assert motion.place.text == "G19 G1 X1. Y2. Z3. F250."
    state = motion.state
    assert (state.tool, state.spindle_rpm, state.spindle_direction) == (7, 1200, -1)
    assert (state.length_offset_mm, state.wcs, state.plane) == (60, "G55", 19)


def test_motion_codes_are_modal(motions) -> None:
    moved = motions("G0 X1\nY1\nG1 X2 F9\nY2\nG0 Z5")
    assert [m.rapid for m in moved] == [True, True, False, False, True]
    assert [m.feed_mm_min for m in moved] == [0, 0, 9, 9, 0]


def test_incremental_words_add_to_the_place_reached(motions) -> None:
    assert ends(motions("G90 X1 Y1\nG91 X2\nZ-1\nG90 X0")) == [(1, 1, 0), (3, 1, 0), (3, 1, -1), (0, 1, -1)]


def test_an_inch_is_25_4_mm_in_lengths_and_feeds(motions) -> None:
    moved = motions("G20 G1 X1. F10.\nG91 Y.5\nG90 G21 X1. F10.")
    assert ends(moved) == [(25.4, 0, 0), (25.4, 12.7, 0), (1, 12.7, 0)]
    assert [m.feed_mm_min for m in moved] == [254, 254, 10]


def test_start_up_units(motions) -> None:
    assert motions("G1 X1. F10.", units="inch")[0].feed_mm_min == 254
    assert ends(motions("X2.", units="inch")) == [(50.8, 0, 0)]
    assert ends(motions("G21 X2.", units="inch")) == [(2, 0, 0)]


def test_linuxcnc_reads_f_before_the_units_of_its_block(motions) -> None:
    assert motions("F60 G20\nG1 X1", "linuxcnc")[0].feed_mm_min == 60
    assert motions("G20\nF60\nG1 X1", "linuxcnc")[0].feed_mm_min == 1524


def test_a_motion_to_where_the_tool_is_is_told_with_no_length(motions) -> None:
    told = motions("X0 Y0\nG1 Z0 F1\nG91 X0")
    assert [m.place.line for m in told] == [1, 2, 3]
    assert all(m.start_mm == m.end_mm == (0, 0, 0) for m in told)


def test_work_offsets(motions, refusal) -> None:
    offsets = {"G54": (1.0, 2.0, 3.0), "G59": (100.0, 0.0, 0.0)}
    assert ends(motions("X0 Y0 Z0\nG59 X1\nG54 Y5", offsets=offsets)) == [(1, 2, 3), (101, 2, 3), (101, 7, 3)]
    assert str(refusal("G0 X1\nG57 X1", offsets=offsets)) == (
        "t.nc:2:1: work offset G57 is not defined; expected one of the defined offsets: G54, G59 [unknown-work-offset]"
    )
    assert str(refusal("G0 X1", offsets={"G55": (0, 0, 0)})) == (
        "t.nc:1:1: work offset G54 is not defined; expected one of the defined offsets: G55 [unknown-work-offset]"
    )


def test_linuxcnc_has_nine_work_offsets(motions, refusal) -> None:
    assert ends(motions("G59.3 G0 X1", "linuxcnc", offsets={"G59.3": (5, 0, 0)})) == [(6, 0, 0)]
    assert refusal("G59.3").code == "unknown-code"


@pytest.mark.parametrize("code", ["G1 X1", "G2 X1 I.5", "G3 X1 R1"])
@pytest.mark.parametrize("feed", ["", "F0 "])
def test_a_feed_motion_needs_a_feed(code: str, feed: str, refusal) -> None:
    assert str(refusal(feed + code)) == (
        f"t.nc:1:1: {code[:2]} without a feed rate; expected an F word above 0 in this block or before [missing-feed]"
    )


def test_g28_goes_by_way_of_the_programmed_point(motions) -> None:
    settings = {"home_mm": (300.0, 200.0, 400.0), "offsets": {"G54": (10.0, 10.0, 10.0)}, "start_mm": (1.0, 1.0, 1.0)}
    assert ends(motions("G90 G28 X5 Z20", **settings)) == [(15, 1, 30), (300, 1, 400)]
    assert ends(motions("G91 G28 X5 Z20", **settings)) == [(6, 1, 21), (300, 1, 400)]
    assert ends(motions("G91 G28 Z0", **settings)) == [(1, 1, 1), (1, 1, 400)]
    assert ends(motions("G28 G91 X0 Y0\nG90 X0", **settings)) == [(1, 1, 1), (300, 200, 1), (10, 200, 1)]
    assert all(m.rapid and m.feed_mm_min == 0 for m in motions("G1 F5. G28 X5", **settings))


def test_g28_takes_the_gauge_point_to_the_reference_point(motions) -> None:
    moved = motions("G43 H1 Z0\nG91 G28 Z0", home_mm=(0, 0, 500), start_mm=(0, 0, 500), tools=LENGTHS)
    assert ends(moved) == [(0, 0, 0), (0, 0, 0), (0, 0, 400)]


def test_g28_without_axes(motions, refusal) -> None:
    assert str(refusal("G28")) == "t.nc:1:1: G28 names no axis; expected at least one of X, Y, Z [missing-axis]"
    assert ends(motions("G28", "linuxcnc", home_mm=(1, 2, 3))) == [(0, 0, 0), (1, 2, 3)]


def test_g53_takes_the_gauge_point_to_machine_coordinates_once(motions) -> None:
    settings = {"offsets": {"G54": (10.0, 20.0, 30.0)}, "tools": LENGTHS}
    moved = motions("G43 H1 X0 Y0 Z0\nG53 Z250.\nZ0\nG20 G53 Z1.", **settings)
    assert ends(moved) == [(10, 20, 30), (10, 20, 150), (10, 20, 30), (10, 20, 25.4 - 100)]


def test_g53_is_rapid_in_fanuc_and_obeys_the_mode_in_linuxcnc(motions, refusal) -> None:
    fanuc = motions("G1 F5. X1.\nG53 X2.\nX3.")
    assert [m.rapid for m in fanuc] == [False, True, False]
    assert [m.rapid for m in motions("F5 G1 X1\nG53 X2\nG0 G53 X3", "linuxcnc")] == [False, False, True]
    assert str(refusal("F5 G2 X2 I1\nG53 X1", "linuxcnc")) == (
        "t.nc:2:1: G53 while G2 is active; expected G0 or G1 [g53-motion]"
    )
    assert refusal("G53 G1 X1", "linuxcnc").code == "missing-feed"


def test_g53_needs_absolute_words_in_linuxcnc(refusal) -> None:
    error = refusal("G0 G91 G53 X1", "linuxcnc")
    assert str(error) == "t.nc:1:8: G53 while G91 is active; expected G90 [g53-incremental]"


def test_length_offsets_shift_the_controlled_point_and_move_nothing(motions) -> None:
    settings = {"tools": LENGTHS, "start_mm": (0.0, 0.0, 300.0)}
    moved = motions("G43 H1\nX1\nZ0\nG49\nX2\nG44 H2\nX3\nZ0", **settings)
    assert [(m.start_mm, m.end_mm) for m in moved] == [
        ((0, 0, 200), (1, 0, 200)),
        ((1, 0, 200), (1, 0, 0)),
        ((1, 0, 100), (2, 0, 100)),
        ((2, 0, 160), (3, 0, 160)),
        ((3, 0, 160), (3, 0, 0)),
    ]
    assert [m.state.length_offset_mm for m in moved] == [100, 100, 0, -60, -60]


def test_the_gauge_point_never_jumps(motions) -> None:
    moved = motions("G43 H1 Z50\nG43 H2 X1\nG49 X2\nZ3\nG44 H1 Y1", tools=LENGTHS, start_mm=(0, 0, 400))
    gauge = [[(m.start_mm, m.end_mm)[i][2] + m.state.length_offset_mm for i in (0, 1)] for m in moved]
    assert all(before[1] == after[0] for before, after in pairwise(gauge))
    assert gauge[0][0] == 400


def test_h_is_modal_in_fanuc(motions, refusal) -> None:
    assert [m.state.length_offset_mm for m in motions("H2\nG43 X1\nH1 X2\nH0 X3", tools=LENGTHS)] == [
        60,
        100,
        0,
    ]
    assert str(refusal("G43 Z1")) == (
        "t.nc:1:1: G43 without an H word, and none before; expected H and the number of a tool length offset "
        "[missing-length-offset]"
    )


def test_g43_alone_takes_the_offset_of_the_tool_in_linuxcnc(motions, refusal) -> None:
    program = "T2 M6\nG43{} G0 X1"
    for word, length in (("", 60), (" H0", 60), (" H1", 100)):
        (motion,) = motions(program.format(word), "linuxcnc", tools=LENGTHS)
        assert motion.state.length_offset_mm == length
    assert refusal("G0 X1 H1", "linuxcnc").code == "unused-word"
    assert refusal("G44 H1", "linuxcnc").code == "unknown-code"


def test_an_offset_that_is_not_in_the_table(refusal) -> None:
    message = "t.nc:1:5: tool length offset 9 is not in the tool table; expected one from the table: H1, H2 "
    assert str(refusal("G43 H9", tools=LENGTHS)) == message + "[unknown-length-offset]"
    assert str(refusal("G43 H9", tools={})).endswith(
        "expected one from the table: none is given [unknown-length-offset]"
    )


def test_without_a_table_lengths_count_as_0_and_a_notice_says_so(run, motions) -> None:
    (notice,) = [e for e in run("G43 H9\nM30") if isinstance(e, Notice)]
    assert (notice.place.column, notice.code) == (5, "no-tool-table")
    assert notice.text == "H9: no tool table is given, so the length of offset 9 counts as 0"
    assert motions("G43 H9 Z5")[0].state.length_offset_mm == 0


def test_fanuc_adds_a_new_length_to_the_end_of_an_incremental_z_motion(motions) -> None:
    settings = {"tools": LENGTHS, "start_mm": (0.0, 0.0, 500.0)}
    moved = motions("G91 G43 H1 Z-50\nZ-1\nX1", **settings)
    gauge = [m.end_mm[2] + m.state.length_offset_mm for m in moved]
    assert gauge == [500 - 50 + 100, 549, 549]
    (only,) = motions("G0 G91 G43 H1 Z-50", "linuxcnc", **settings)
    assert only.end_mm[2] + only.state.length_offset_mm == 450


def test_g28_does_not_add_a_cancelled_length(motions) -> None:
    settings = {"tools": LENGTHS, "start_mm": (0.0, 0.0, 300.0), "home_mm": (0.0, 0.0, 300.0)}
    assert ends(motions("G43 H1 Z10\nG49 G91 G28 Z0", **settings)) == [(0, 0, 10), (0, 0, 110), (0, 0, 300)]


@pytest.mark.parametrize(
    ("field", "value", "message"),
    [
        ("home_mm", (0, 0, float("nan")), "home_mm must be three finite lengths, got (0, 0, nan)"),
        ("start_mm", (0, 0), "start_mm must be three finite lengths, got (0, 0)"),
        ("offsets", {"G54": (0, float("inf"), 0)}, "offsets['G54'] must be three finite lengths, got (0, inf, 0)"),
        ("variables", {3: float("nan")}, "variables[3] must be finite, got nan"),
        ("tool", -1, "tool must be 0 or more, got -1"),
        ("arc_tolerance_mm", -0.1, "arc_tolerance_mm must be 0 or more, got -0.1"),
        ("units", "cm", "units must be one of mm, inch, got 'cm'"),
        ("arc_centres", "both", "arc_centres must be one of incremental, absolute, got 'both'"),
    ],
)
def test_settings_are_checked(field: str, value: object, message: str, run) -> None:
    with pytest.raises(ValueError) as caught:
        run("M2", **{field: value})
    assert str(caught.value) == message
