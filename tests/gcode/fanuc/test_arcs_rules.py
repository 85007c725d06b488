"""Circular and helical interpolation of FANUC: centres, radii, senses and feeds in closed form."""

from __future__ import annotations

import math

import pytest

from gcode.events import ArcMotion

HALF = math.sqrt(0.5)


def test_the_program_of_the_manual_in_four_ways(motions) -> None:
    """FANUC 30i user's manual, "Circular interpolation", example: a path of two arcs, absolute and incremental, by I J
    and by R, from (200, 40) to (140, 100) and (120, 60)."""
    start = "G92 X200. Y40. Z0\n"
    ways = [
        "G90 G03 X140. Y100. R60. F300\nG02 X120. Y60. R50.",
        "G90 G03 X140. Y100. I-60. F300\nG02 X120. Y60. I-50.",
        "G91 G03 X-60. Y60. R60. F3000\nG02 X-20. Y-40. R50.",
        "G91 G03 X-60. Y60. I-60. F3000\nG02 X-20. Y-40. I-50.",
    ]
    for way in ways:
        first, second = motions(start + way, start_mm=(200, 40, 0))
        assert first.centre_mm == pytest.approx((140, 40, 0))
        assert second.centre_mm == pytest.approx((90, 100, 0))
        assert first.sweep_rad == pytest.approx(math.pi / 2)
        assert second.sweep_rad == pytest.approx(-math.atan2(40, 30))
        assert second.end_mm == pytest.approx((120, 60, 0))


def test_i_and_j_are_incremental_with_g90_and_g91(motions) -> None:
    """The same: I, J, K are the vector from the arc's start to its centre, irrespective of G90 and G91."""
    absolute = motions("G0 X50. Y50.\nG90 G3 X40. Y60. I-10. J0 F100")[-1]
    incremental = motions("G0 X50. Y50.\nG91 G3 X-10. Y10. I-10. J0 F100")[-1]
    assert absolute.centre_mm == incremental.centre_mm == (40, 50, 0)
    assert absolute.end_mm == incremental.end_mm == (40, 60, 0)


def test_a_centre_word_of_0_can_be_omitted(motions) -> None:
    assert motions("G2 X10. Y10. J10. F1")[0].centre_mm == (0, 10, 0)
    assert motions("G2 X10. Y-10. I10. F1")[0].centre_mm == (10, 0, 0)


@pytest.mark.parametrize("code", ["G2", "G3"])
def test_a_full_circle_by_omitting_the_end(code: str, motions) -> None:
    """The same: where the end is omitted, or is the start, I J K give an arc of 360 degrees."""
    for words in ("", "X5. Y6.", "X5."):
        arc = motions(f"G0 X5. Y6.\n{code} {words} I10. F1")[-1]
        assert abs(arc.sweep_rad) == pytest.approx(2 * math.pi)
        assert arc.centre_mm == (15, 6, 0)


@pytest.mark.parametrize(
    ("code", "radius", "centre", "sweep_deg"),
    [
        ("G2", "50.", (30, -40), -2 * math.degrees(math.asin(0.6))),
        ("G2", "-50.", (30, 40), -360 + 2 * math.degrees(math.asin(0.6))),
        ("G3", "50.", (30, 40), 2 * math.degrees(math.asin(0.6))),
        ("G3", "-50.", (30, -40), 360 - 2 * math.degrees(math.asin(0.6))),
    ],
)
def test_sign_of_r(code: str, radius: str, centre: tuple[float, float], sweep_deg: float, motions) -> None:
    """The same, arc radius: an arc of more than 180 degrees has a negative R. Chord 60, radius 50: the centre is 40
    off the chord's middle."""
    (arc,) = motions(f"{code} X60. Y0 R{radius} F100")
    assert arc.centre_mm == pytest.approx((*centre, 0))
    assert math.degrees(arc.sweep_rad) == pytest.approx(sweep_deg)


@pytest.mark.parametrize(
    ("block", "middle"),
    [
        ("G17 G2 X0 Y-10. I-10.", (HALF * 10, -HALF * 10, 0)),
        ("G17 G3 X0 Y10. I-10.", (HALF * 10, HALF * 10, 0)),
        ("G18 G2 X0 Z10. I-10.", (HALF * 10, 0, HALF * 10)),
        ("G18 G3 X0 Z-10. I-10.", (HALF * 10, 0, -HALF * 10)),
    ],
)
def test_the_sense_is_seen_from_the_positive_normal(block: str, middle: tuple, motions, point_at) -> None:
    """The same, direction: clockwise and counter-clockwise as seen from the positive Z (Y, X) axis in the XY (ZX, YZ)
    plane. Seen from +Y, Z to the right, X points up, so G2 leads from X+ to Z+."""
    arc = motions(f"G0 X10.\n{block} F100")[-1]
    assert abs(arc.sweep_rad) == pytest.approx(math.pi / 2)
    assert point_at(arc, 0.5) == pytest.approx(middle)


@pytest.mark.parametrize(
    ("block", "middle"),
    [
        ("G19 G2 Y0 Z-10. J-10.", (0, HALF * 10, -HALF * 10)),
        ("G19 G3 Y0 Z10. J-10.", (0, HALF * 10, HALF * 10)),
    ],
)
def test_the_sense_in_the_yz_plane(block: str, middle: tuple, motions, point_at) -> None:
    """Seen from +X, Y to the right, Z points up: G3 leads from Y+ to Z+."""
    assert point_at(motions(f"G0 Y10.\n{block} F100")[-1], 0.5) == pytest.approx(middle)


@pytest.mark.parametrize(
    ("block", "end"),
    [
        ("G17 G3 X-10. Y0 Z6. I-10.", (-10, 0, 6)),
        ("G18 G3 X-10. Z0 Y6. I-10.", (-10, 6, 0)),
        ("G19 G3 Y-10. Z0 X6. J-10.", (6, -10, 0)),
    ],
)
def test_a_helix_rises_in_proportion_to_the_angle(block: str, end: tuple, motions, point_at) -> None:
    """FANUC 30i user's manual, "Helical interpolation": one more axis moves linearly, in step with the arc."""
    first = "Y" if "G19" in block else "X"
    arc = motions(f"G0 {first}10.\n{block} F100")[-1]
    assert isinstance(arc, ArcMotion)
    assert arc.end_mm == end
    normal = end.index(6)
    for part in (0.25, 0.5, 0.75):
        assert point_at(arc, part)[normal] == pytest.approx(6 * part)


@pytest.mark.parametrize("rise", [0.0, 3.0, 40.0])
def test_f_of_a_helix_is_the_feed_along_its_arc(rise: float, motions) -> None:
    """The same: F is the feed along the circular arc, so the linear axis moves at F times its length over the arc's;
    half a turn of radius 10 is 10 pi long."""
    arc = motions(f"G0 X10.\nG3 X-10. I-10. Z{rise} F100")[-1]
    in_plane = 10 * math.pi
    assert arc.feed_mm_min == pytest.approx(100 * math.hypot(in_plane, rise) / in_plane)


def test_feed_of_an_arc_per_revolution(motions) -> None:
    assert motions("S1000 M3\nG95 G2 X10. R5. F0.2")[-1].feed_mm_min == pytest.approx(200)


@pytest.mark.parametrize(
    ("block", "code"),
    [
        ("G17 G2 X10. K5.", "arc-plane"),
        ("G18 G2 X10. J5.", "arc-plane"),
        ("G2 X10. Y0", "arc-without-centre"),
        ("G2 X10. I4.9", "arc-radius"),
        ("G2 X10. R4.9", "arc-radius-too-small"),
        ("G2 X0 Y0 R5.", "arc-no-chord"),
    ],
)
def test_arcs_that_are_alarms(block: str, code: str, refusal) -> None:
    """FANUC alarms PS0020 (over tolerance of radius), PS0021 (illegal plane), PS0022 (no R or I, J, K)."""
    assert refusal(f"G0 X0\n{block} F100").code == code
