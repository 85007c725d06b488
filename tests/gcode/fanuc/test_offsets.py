"""Work offsets, shifts, tool length offsets and reference points of FANUC mills, worked out by hand."""

from __future__ import annotations

import pytest

from gcode.settings import ToolOffset

TOOLS = {
    1: ToolOffset(length_mm=100.0, length_wear_mm=-0.2, radius_mm=5.0, radius_wear_mm=0.1),
    2: ToolOffset(length_mm=60.0),
}


@pytest.mark.parametrize("number", range(1, 7))
def test_g10_l2_sets_a_work_offset(number: int, ends) -> None:
    """FANUC 30i user's manual, "Changing workpiece coordinate system", G10 L2 Pp IP: p = 1 to 6 are G54 to G59."""
    assert ends(f"G90 G10 L2 P{number} X10. Y20. Z30.\nG{53 + number} G0 X1. Y1. Z1.") == [(11, 21, 31)]


def test_g10_l2_p0_is_the_external_offset(ends) -> None:
    """The same: p = 0 is the external workpiece zero point offset, which all six coordinate systems share."""
    text = "G10 L2 P0 X5.\nG10 L2 P2 X10.\nG54 G0 X1.\nG55 X1."
    assert ends(text) == [(6, 0, 0), (16, 0, 0)]


def test_g10_l2_adds_with_g91(ends) -> None:
    """The same: with G91 the value given is added to the offset that is set."""
    text = "G90 G10 L2 P1 X10. Y3.\nG91 G10 L2 P1 X2.\nG90 G0 X1. Y0"
    assert ends(text) == [(13, 3, 0)]


def test_g10_l2_acts_on_the_next_absolute_motion_and_moves_nothing(ends) -> None:
    assert ends("G54 G0 X1.\nG10 L2 P1 X100.\nY1.\nX1.") == [(1, 0, 0), (1, 1, 0), (101, 1, 0)]


@pytest.mark.parametrize("code", ["G54.1 P3", "G54 P3"])
def test_additional_offsets(code: str, ends) -> None:
    """FANUC 30i user's manual, "Additional workpiece coordinate systems": G54.1 Pn or G54 Pn, set by G10 L20 Pn."""
    assert ends(f"G10 L20 P3 X7.\n{code} G0 X1.\nG54 X1.") == [(8, 0, 0), (1, 0, 0)]


def test_g54_1_without_p_is_the_first(ends, refusal) -> None:
    """The same: where P is missing behind G54.1, G54.1 P1 is assumed; a P beyond the range is an alarm."""
    assert ends("G10 L20 P1 X7.\nG54.1 G0 X1.") == [(8, 0, 0)]
    assert refusal("G54.1 P301").code == "bad-value"
    assert refusal("G54.1 P0").code == "bad-value"


def test_tool_offsets_by_g10(ends) -> None:
    """FANUC 30i user's manual, "Tool compensation values", memory C: L10 H geometry, L11 H wear; G91 adds."""
    text = "G10 L10 P3 R50.\nG10 L11 P3 R0.5\nG91 G10 L10 P3 R-1.\nG90 G43 H3 G0 Z0\nG53 Z0"
    assert ends(text)[-1] == (0, 0, -49.5)


def test_cutter_radius_by_g10(ends) -> None:
    """The same: L12 D geometry, L13 D wear; the tool runs to the left of the path by their sum."""
    text = "G10 L12 P4 R5.\nG10 L13 P4 R0.25\nG1 G41 D4 X10. F100\nX20.\nX30.\nG40 X40."
    assert ends(text)[1:3] == [pytest.approx((20, 5.25, 0)), pytest.approx((30, 5.25, 0))]


def test_g52_is_a_zero_within_every_work_offset(ends) -> None:
    """FANUC 30i user's manual, "Local coordinate system": it lies at IP in each of the six workpiece systems."""
    text = "G52 X10.\nG54 G0 X1.\nG55 X1.\nG52 X20.\nX1.\nG52 X0\nX1."
    made = ends(text, offsets={"G54": (0, 0, 0), "G55": (100, 0, 0)})
    assert made == [(11, 0, 0), (111, 0, 0), (121, 0, 0), (101, 0, 0)]


def test_g52_keeps_the_axes_that_it_does_not_name(ends) -> None:
    assert ends("G52 X10. Y5.\nG52 Y6.\nG0 X0 Y0") == [(10, 6, 0)]


def test_g92_shifts_all_work_offsets_by_the_same_amount(ends) -> None:
    """FANUC 30i user's manual, "Changing workpiece coordinate system", G92, example: with the tool at (200, 160) of
    G54, G92 X100 Y100 makes the system shifted by (100, 60), and so are all the others."""
    offsets = {"G54": (0, 0, 0), "G55": (1000, 1000, 0)}
    text = "G54 G0 X200. Y160.\nG92 X100. Y100.\nX0 Y0\nG55 X0 Y0"
    assert ends(text, offsets=offsets) == [(200, 160, 0), (100, 60, 0), (1100, 1060, 0)]


def test_g92_ends_the_local_system_of_its_axes(ends) -> None:
    """FANUC 30i user's manual, "Local coordinate system", note: G92 cancels it for the axes named, others keep it."""
    text = "G52 X10. Y20.\nG0 X0 Y0\nG92 X5.\nG52 X0 Y0\nX5. Y0"
    assert ends(text) == [(10, 20, 0), (10, 0, 0)]


def test_g92_1_presets_the_axes_that_it_names(ends) -> None:
    """FANUC 30i user's manual, "Workpiece coordinate system preset": G92.1 X0 takes back shifts of X alone."""
    text = "G92 X100. Y50.\nG52 Z3.\nG92.1 X0\nG0 X0 Y50. Z0\nG92.1 Y0 Z0\nY0 Z0"
    assert ends(text) == [(0, 0, 3), (0, 0, 0)]


def test_length_is_geometry_and_wear(ends) -> None:
    """FANUC 30i user's manual, "Tool length compensation": G43 adds the offset of H, G44 subtracts it, G49 or H0
    cancels; a new H replaces the old one."""
    text = "G43 H1 G0 Z10.\nG53 Z200.\nG44 H2 Z10.\nG49 Z10.\nG43 H2 Z10.\nH0 Z10."
    gauge = []
    for z, length in zip(ends(text, tools=TOOLS), (99.8, 99.8, -60, 0, 60, 0), strict=True):
        gauge.append(z[2] + length)
    assert gauge == pytest.approx([109.8, 200, -50, 10, 70, 10])


def test_work_offset_local_shift_and_length_add_up(motions) -> None:
    """Machine position of the gauge point = external + work offset + local + program + length offset."""
    settings = {"offsets": {"G56": (1, 2, 3)}, "external_offset_mm": (10, 20, 30), "tools": TOOLS}
    (moved,) = motions("G56 G52 X100. Y200. Z300.\nG43 H2 G0 X1000. Y2000. Z3000.", **settings)
    assert moved.end_mm == (1111, 2222, 3333)
    assert moved.state.length_offset_mm == 60


def test_g53_ignores_all_offsets_for_one_block(ends) -> None:
    """FANUC 30i user's manual, "Machine coordinate system": G53 is effective only in its block, at rapid."""
    settings = {"offsets": {"G54": (1, 2, 3)}, "external_offset_mm": (10, 20, 30)}
    assert ends("G52 X5.\nG53 X100. Y100.\nX0 Y0", **settings) == [(100, 100, 0), (16, 22, 0)]


HOME = {
    "home_mm": (500.0, 400.0, 300.0),
    "reference_points_mm": {2: (1.0, 2.0, 3.0), 3: (4.0, 5.0, 6.0), 4: (7.0, 8.0, 9.0)},
}


@pytest.mark.parametrize(
    ("code", "point"),
    [("G28", (500, 400, 300)), ("G30", (1, 2, 3)), ("G30 P2", (1, 2, 3)), ("G30 P3", (4, 5, 6)), ("G30 P4", (7, 8, 9))],
)
def test_return_by_way_of_an_intermediate_point(code: str, point: tuple[float, ...], ends) -> None:
    """FANUC 30i user's manual, "Reference position return": G28 IP, or G30 P2 (which may be omitted), P3, P4 IP, goes
    at rapid to IP and from there to the reference position, in the named axes."""
    assert ends(f"G90 {code} X10. Y20. Z30.", **HOME) == [(10, 20, 30), point]
    assert ends(f"G90 {code} Z30.", **HOME) == [(0, 0, 30), (0, 0, point[2])]
    assert ends(f"G0 Z5.\nG91 {code} Z0", **HOME)[1:] == [(0, 0, 5), (0, 0, point[2])]


def test_g29_returns_by_way_of_the_intermediate_points_of_each_axis(ends) -> None:
    """The same, G28, example: N1 G28 X40.0 and N2 G28 Y60.0 leave the intermediate position (40, 60), by which G29
    goes to its point."""
    text = "N1 G28 X40.\nN2 G28 Y60.\nG29 X10. Y20."
    assert ends(text, **HOME) == [
        *((40, 0, 0), (500, 0, 0)),
        *((500, 60, 0), (500, 400, 0)),
        *((40, 60, 0), (10, 20, 0)),
    ]


def test_g28_and_g29_of_the_manual(ends) -> None:
    """The same, example: G28 G90 X1000. Y500. (A to B to R); G29 X1300. Y200. (R to B to C)."""
    assert ends("G28 G90 X1000. Y500.\nT1 M6\nG29 X1300. Y200.", **HOME) == [
        *((1000, 500, 0), (500, 400, 0)),
        *((1000, 500, 0), (1300, 200, 0)),
    ]


def test_g29_needs_a_return_before_it(refusal) -> None:
    """FANUC alarm PS0305: an intermediate position is not specified."""
    assert refusal("G0 X1.\nG29 X5.", **HOME).code == "missing-reference"


def test_g27_checks_that_the_reference_position_is_reached(ends, refusal) -> None:
    """The same, G27 IP: positions at rapid; where that is not the reference position, an alarm (PS0405)."""
    assert ends("G27 X500. Y400.", **HOME) == [(500, 400, 0)]
    error = refusal("G0 X1.\nG27 X499.", **HOME)
    assert (error.code, error.place.line) == ("reference-missed", 2)


@pytest.mark.parametrize("text", ["G30 P5 X0", "G30 P1 X0", "G28", "G27", "G30 P3 Z0"])
def test_returns_that_are_refused(text: str, refusal) -> None:
    assert refusal(f"G0 X1.\n{text}", home_mm=(1, 1, 1)).code in ("bad-value", "missing-axis", "unknown-reference")
