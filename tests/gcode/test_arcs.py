"""Arcs and helices in three planes against closed forms, and their refusals."""

from __future__ import annotations

import math

import pytest

from gcode.events import ArcMotion
from gcode.settings import ToolOffset

#: For each plane: axes (first, second, normal) and the letters of the centre.
PLANES = {17: ("X", "Y", "Z", "I", "J"), 18: ("Z", "X", "Y", "K", "I"), 19: ("Y", "Z", "X", "J", "K")}
EACH_PLANE = pytest.mark.parametrize("plane", PLANES)


def point(plane: int, first: float, second: float, normal: float = 0.0) -> tuple[float, float, float]:
    axes = dict(zip(PLANES[plane][:3], (first, second, normal), strict=True))
    return (axes["X"], axes["Y"], axes["Z"])


@EACH_PLANE
@pytest.mark.parametrize(("code", "sign"), [("G2", -1), ("G3", 1)])
def test_the_sense_in_each_plane(plane: int, code: str, sign: int, motions, point_at) -> None:
    """From the first axis, a quarter of G3 leads to the second axis: the frame is right-handed in all planes."""
    a, b, _, i, _ = PLANES[plane]
    arc = motions(f"G{plane} G0 {a}10\n{code} F1 {a}0 {b}{10 * sign} {i}-10")[-1]
    assert isinstance(arc, ArcMotion)
    assert (arc.plane, arc.turns, arc.centre_mm) == (plane, sign, (0, 0, 0))
    assert arc.sweep_rad == pytest.approx(sign * math.pi / 2)
    half = math.sqrt(50)
    assert point_at(arc, 0.5) == pytest.approx(point(plane, half, sign * half))
    assert point_at(arc, 1.0) == pytest.approx(arc.end_mm)


@EACH_PLANE
@pytest.mark.parametrize("end", ["", "{a}10", "{a}10 {b}0"])
def test_a_full_circle(plane: int, end: str, motions, point_at) -> None:
    a, b, _, i, _ = PLANES[plane]
    arc = motions(f"G{plane} G0 {a}10\nG2 F1 {end.format(a=a, b=b)} {i}-10")[-1]
    assert arc.sweep_rad == -2 * math.pi
    assert arc.start_mm == arc.end_mm == point(plane, 10, 0)
    assert point_at(arc, 0.25) == pytest.approx(point(plane, 0, -10))


@EACH_PLANE
def test_a_helix_keeps_its_centre_level_with_its_start(plane: int, motions, point_at) -> None:
    a, b, n, _, j = PLANES[plane]
    arc = motions(f"G{plane} G0 {b}-5 {n}7\nG3 F1 {a}5 {b}0 {n}3 {j}5\n")[-1]
    assert arc.centre_mm == point(plane, 0, 0, 7)
    assert arc.end_mm == point(plane, 5, 0, 3)
    assert arc.sweep_rad == pytest.approx(math.pi / 2)
    assert point_at(arc, 0.5) == pytest.approx(point(plane, math.sqrt(12.5), -math.sqrt(12.5), 5))


@EACH_PLANE
@pytest.mark.parametrize("code", ["G2", "G3"])
def test_r_chooses_between_the_short_and_the_long_arc(plane: int, code: str, motions) -> None:
    a, b, *_ = PLANES[plane]
    sign = 1 if code == "G3" else -1
    short, long = (motions(f"G{plane} {code} F1 {a}6 {b}0 R{r}")[0] for r in (5, -5))
    assert short.centre_mm == pytest.approx(point(plane, 3, 4 * sign))
    assert long.centre_mm == pytest.approx(point(plane, 3, -4 * sign))
    assert short.sweep_rad == pytest.approx(sign * 2 * math.asin(0.6))
    assert long.sweep_rad == pytest.approx(sign * (2 * math.pi - 2 * math.asin(0.6)))


def test_r_of_half_the_chord_is_half_a_turn(motions) -> None:
    for r in ("3", "-3", "2.96"):
        arc = motions(f"G2 F1 X6 R{r}")[0]
        assert arc.centre_mm == pytest.approx((3, 0, 0))
        assert abs(arc.sweep_rad) == pytest.approx(math.pi)


def test_offsets_units_and_lengths_reach_the_centre(motions) -> None:
    settings = {"offsets": {"G54": (100.0, 200.0, 300.0)}, "tools": {1: ToolOffset(length_mm=50.0)}}
    arc = motions("G20 G43 H1 G0 X1. Y0 Z0\nG3 X0 Y1. I-1. F10.", **settings)[-1]
    assert arc.centre_mm == (100, 200, 300)
    assert arc.start_mm == pytest.approx((125.4, 200, 300))
    assert arc.end_mm == pytest.approx((100, 225.4, 300))
    assert arc.feed_mm_min == 254


def test_absolute_centres_by_word_and_by_setting(motions) -> None:
    incremental = motions("G0 X10 Y5\nG3 F1 X0 Y15 I-10 J0")[-1]
    by_word = motions("G0 X10 Y5\nG90.1 G3 F1 X0 Y15 I0 J5")[-1]
    by_setting = motions("G0 X10 Y5\nG3 F1 X0 Y15 I0 J5", arc_centres="absolute")[-1]
    back = motions("G91.1 G0 X10 Y5\nG3 F1 X0 Y15 I-10 J0", arc_centres="absolute")[-1]
    assert incremental.centre_mm == by_word.centre_mm == by_setting.centre_mm == back.centre_mm == (0, 5, 0)


def test_absolute_centres_are_in_work_coordinates_even_with_g91(motions) -> None:
    offsets = {"G54": (100.0, 0.0, 0.0)}
    arc = motions("G0 X10 Y0\nG91 G3 F1 X-10 Y10 I0 J0", offsets=offsets, arc_centres="absolute")[-1]
    assert arc.centre_mm == (100, 0, 0)
    assert arc.end_mm == (100, 10, 0)


def test_rounding_makes_no_circle_of_nothing_and_nothing_of_a_circle(motions) -> None:
    """0.1 + 0.2 is not 0.3 in doubles: the circle must close on the place that the sums led to."""
    arc = motions("G91 X.1\nX.2\nG90 G3 F1 X.3 Y0 I1")[-1]
    assert arc.start_mm == arc.end_mm
    assert arc.sweep_rad == 2 * math.pi


def test_the_programmed_centre_is_kept_within_the_tolerance(motions) -> None:
    arc = motions("G2 F1 X20 I9.98")[0]
    assert arc.centre_mm == (9.98, 0, 0)
    assert arc.end_mm == (20, 0, 0)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("G2 X1", "t.nc:2:1: G2 without a centre; expected I, J, K or R [arc-without-centre]"),
        ("G2 X1 R5 I1", "t.nc:2:7: R5 together with I1; expected a radius R, or a centre by I, J, K [arc-two-centres]"),
        ("G2 X1 I.5 K0", "t.nc:2:11: K0 in an arc of the XY plane (G17); expected I and J [arc-plane]"),
        ("G18 G2 X1 I.5 J0", "t.nc:2:15: J0 in an arc of the ZX plane (G18); expected K and I [arc-plane]"),
        ("G19 G2 Y1 I.5 J0", "t.nc:2:11: I.5 in an arc of the YZ plane (G19); expected J and K [arc-plane]"),
        ("G90.1 G2 X1 I.5", "t.nc:2:13: I.5 alone as an absolute arc centre; expected both I and J "
         "[arc-centre-incomplete]"),
        ("G2 I0 J0", "t.nc:2:1: an arc of radius 0; expected a centre away from the start [arc-zero-radius]"),
        ("G2 X0 Y0 R5", "t.nc:2:10: R5 with the end of the arc at its start; expected a centre by I, J, K for a full "
         "circle [arc-no-chord]"),
        ("G2 X10 R4.9", "t.nc:2:8: R4.9 is too small for a chord of 10.0000 mm; expected an absolute value of at least "
         "5.0000 mm [arc-radius-too-small]"),
        ("G2 X10 R0", "t.nc:2:8: R0 is too small for a chord of 10.0000 mm; expected an absolute value of at least "
         "5.0000 mm [arc-radius-too-small]"),
        ("G2 X20 I9.9 J0", "t.nc:2:8: the arc's radius is 9.9000 mm at its start and 10.1000 mm at its end, with "
         "incremental centre I9.9 J0; expected radii within 0.05 mm of each other [arc-radius]"),
        ("G2 X1 I1 P2", "t.nc:2:10: P2 is not used by any code in this block or by the active motion code "
         "[unused-word]"),
    ],
)  # fmt: skip
def test_refusals(text: str, message: str, refusal) -> None:
    assert str(refusal("F1\n" + text)) == message


def test_the_radius_error_says_where_the_other_kind_of_centre_would_fit(refusal) -> None:
    assert str(refusal("X30 Y5\nG3 F1 X20 Y15 I20 J5")) == (
        "t.nc:2:15: the arc's radius is 20.6155 mm at its start and 30.4138 mm at its end, with incremental centre "
        "I20 J5; expected radii within 0.05 mm of each other; absolute arc centres (G90.1, or the setting "
        "arc_centres) would fit [arc-radius]"
    )
    error = refusal("X30 Y5\nG3 F1 X20 Y15 I-10 J0", arc_centres="absolute")
    assert "incremental arc centres (G91.1, or the setting arc_centres) would fit" in str(error)


def test_the_tolerance_is_a_setting_and_a_rule_of_the_dialect(motions, refusal) -> None:
    assert motions("G2 F1 X20 I9.9", arc_tolerance_mm=0.3)
    assert refusal("G2 F1 X20 I9.98", arc_tolerance_mm=0.01).code == "arc-radius"
    assert motions("F1 G2 X2000 Y0 I999.5", "linuxcnc")  # 1 mm in 1000.5, not over 0.1 %
    assert refusal("F1 G2 X2000 Y0 I999.5").code == "arc-radius"
    assert refusal("F1 G2 X50 Y0 I24.9857", "linuxcnc").code == "arc-radius"
