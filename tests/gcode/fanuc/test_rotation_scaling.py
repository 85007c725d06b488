"""Rotation, scaling, mirror image and polar coordinates of FANUC mills in closed form."""

from __future__ import annotations

import math

import pytest

from gcode.settings import ToolOffset


def turned(x: float, y: float, degrees: float, about: tuple[float, float] = (0.0, 0.0)) -> tuple[float, float, float]:
    c, s = math.cos(math.radians(degrees)), math.sin(math.radians(degrees))
    u, v = x - about[0], y - about[1]
    return (about[0] + c * u - s * v, about[1] + s * u + c * v, 0.0)


def test_rotation_sample_of_the_manual(ends) -> None:
    """FANUC 30i user's manual, "Coordinate system rotation", sample in increments of 0.001: absolute and incremental
    positions, arcs included, turn by 60 degrees about (7, 3); the start (-5, -5) does not."""
    text = (
        "N1 G92 X-5000 Y-5000 G69 G17\nN2 G68 X7000 Y3000 R60000\nN3 G90 G01 X0 Y0 F200\nN4 G91 X10000\n"
        "N5 G02 Y10000 R10000\nN6 G03 X-10000 I-5000 J-5000\nN7 G01 Y-10000\nN8 G69 G90 X-5000 Y-5000\nM02"
    )
    corners = [(0, 0), (10, 0), (10, 10), (0, 10), (0, 0)]
    wanted = [pytest.approx(turned(x, y, 60, (7, 3))) for x, y in corners]
    made = ends(text, decimal_point="increment", start_mm=(-5, -5, 0))
    assert made == [*wanted, pytest.approx((-5, -5, 0))]


def test_a_positive_angle_is_counter_clockwise(ends) -> None:
    assert ends("G68 X0 Y0 R90.\nG0 X10. Y0\nX10. Y5.") == [pytest.approx((0, 10, 0)), pytest.approx((-5, 10, 0))]


def test_without_a_centre_rotation_is_about_the_tool(ends) -> None:
    """The same: where alpha and beta are omitted, the position of the tool when G68 is given is the centre."""
    assert ends("G0 X10. Y10.\nG68 R90.\nX20. Y10.")[-1] == pytest.approx((10, 20, 0))


def test_the_centre_is_absolute_with_g91_too(ends) -> None:
    """The same: alpha and beta are absolute; an increment behind it turns about where the tool is."""
    assert ends("G0 X10. Y0\nG91 G68 X0 Y0 R90.\nX5.\nG90 X20. Y0") == [
        *((10, 0, 0), pytest.approx((10, 5, 0)), pytest.approx((0, 20, 0)))
    ]


def test_a_new_rotation_replaces_the_old_one(ends) -> None:
    """The same, with parameter 5400 RIN at 0: R is absolute, so a second G68 does not add to the first."""
    assert ends("G68 X0 Y0 R30.\nG68 X0 Y0 R90.\nG0 X10. Y0") == [pytest.approx((0, 10, 0))]


def test_g69_ends_it(ends) -> None:
    assert ends("G68 X0 Y0 R90.\nG69 G0 X10. Y0") == [(10, 0, 0)]


@pytest.mark.parametrize(
    ("plane", "centre", "words", "end"),
    [("G18", "Z0 X0", "Z10. X0", (10, 0, 0)), ("G19", "Y0 Z0", "Y10. Z0", (0, 0, 10))],
)
def test_rotation_in_the_other_planes(plane: str, centre: str, words: str, end: tuple, ends) -> None:
    """Counter-clockwise seen from +Y leads from Z to X, seen from +X from Y to Z."""
    assert ends(f"{plane} G68 {centre} R90.\nG0 {words}") == [pytest.approx(end)]


def test_a_rotated_arc(motions) -> None:
    arc = motions("G68 X0 Y0 R90.\nG0 X10. Y0\nG3 X0 Y10. I-10. F100")[-1]
    assert (arc.start_mm, arc.end_mm) == (pytest.approx((0, 10, 0)), pytest.approx((-10, 0, 0)))
    assert (arc.turns, arc.centre_mm) == (1, pytest.approx((0, 0, 0)))


@pytest.mark.parametrize("words", ["P500", "P0.5", "I500 J500 K500", "I.5 J.5 K.5"])
def test_scaling_about_a_point(words: str, ends) -> None:
    """FANUC 30i user's manual, "Scaling": P1 to P4 go to P1' to P4', towards the centre by the magnification."""
    made = ends(f"G51 X40. Y40. Z0 {words}\nG0 X60. Y40. Z10.\nX60. Y60.\nX0 Y0\nG50 X0 Y0")
    assert made == [(50, 40, 5), (50, 50, 5), (20, 20, 5), (0, 0, 5)]


def test_scaling_along_each_axis(ends) -> None:
    """The same: I, J, K are the magnifications of X, Y, Z; a negative one makes a mirror image."""
    assert ends("G51 X0 Y0 Z0 I2000 J500 K-1000\nG0 X3. Y4. Z5.") == [(6, 2, -5)]


def test_scaling_about_the_tool(ends) -> None:
    """The same: where the centre is omitted it is the position of the tool when G51 is given."""
    assert ends("G0 X10. Y10.\nG51 P2000\nX11. Y10.\nG91 Y1.") == [(10, 10, 0), (12, 10, 0), (12, 12, 0)]


def test_scaling_arcs(motions, refusal) -> None:
    arc = motions("G51 X0 Y0 P2000\nG2 X0 Y10. R5. F100")[-1]
    assert (arc.end_mm, arc.centre_mm) == (pytest.approx((0, 20, 0)), pytest.approx((0, 10, 0)))
    mirrored = motions("G51 X0 Y0 I-1000 J1000 K1000\nG2 X10. Y10. I10. F100")[-1]
    assert (mirrored.turns, mirrored.end_mm, mirrored.centre_mm) == (1, (-10, 10, 0), (-10, 0, 0))
    assert refusal("G51 X0 Y0 I2000 J1000 K1000\nG2 X10. Y10. I10. F100").code == "arc-uneven-scale"


def test_scaling_leaves_tool_offsets_alone(ends) -> None:
    """The same: scaling is not applied to cutter compensation, tool length compensation and tool offset values."""
    tools = {1: ToolOffset(length_mm=50.0, radius_mm=4.0)}
    made = ends("G51 X0 Y0 Z0 P2000\nG43 H1 G0 Z10.\nG1 G41 D1 X10. F100\nX20.\nX30.\nG40 X40.\nG53 Z0", tools=tools)
    assert made[2] == pytest.approx((40, 4, 20))
    assert made[-1][2] == -50


def test_scaling_then_rotation(ends) -> None:
    """The same, "Scaling and coordinate system rotation": in G51 the centre of G68 is scaled, its angle is not; a
    move is scaled first and then turned. (15, 0) becomes (30, 0), turned about (20, 0): (20, 10)."""
    assert ends("G51 X0 Y0 P2000\nG68 X10. Y0 R90.\nG0 X15. Y0") == [pytest.approx((20, 10, 0))]


def test_scaling_then_rotation_about_the_tool(ends) -> None:
    assert ends("G51 X0 Y0 P2000\nG0 X5. Y0\nG68 R90.\nX10. Y0") == [(10, 0, 0), pytest.approx((10, 10, 0))]


def test_mirror_image_sample_of_the_manual(ends) -> None:
    """FANUC 30i user's manual, "Programmable mirror image": a figure and its images about X = 50, about both, and
    about Y = 50."""
    figure = "O9000\nG00 G90 X60. Y60.\nG01 X100. F100\nX60. Y100.\nM99"
    text = (
        "O1\nG00 G90\nM98 P9000\nG51.1 X50.\nM98 P9000\nG51.1 Y50.\nM98 P9000\nG50.1 X0\nM98 P9000\nG50.1 Y0\n"
        f"X0 Y0\nM30\n{figure}"
    )
    corners = [(60, 60), (100, 60), (60, 100)]
    images = [(1, 1), (-1, 1), (-1, -1), (1, -1)]
    wanted = [(50 + a * (x - 50), 50 + b * (y - 50), 0) for a, b in images for x, y in corners]
    assert ends(text) == [*wanted, (0, 0, 0)]


def test_a_mirror_image_turns_arcs_the_other_way(motions) -> None:
    """The same: with a mirror image of one axis of the plane G02 and G03 are interchanged, with both they are not."""
    blocks = "\nG0 X10. Y0\nG3 X0 Y10. I-10. F100"
    one, both = motions(f"G51.1 X0{blocks}")[-1], motions(f"G51.1 X0 Y0{blocks}")[-1]
    assert (one.start_mm, one.end_mm, one.turns) == ((-10, 0, 0), (0, 10, 0), -1)
    assert (both.start_mm, both.end_mm, both.turns) == ((-10, 0, 0), (0, -10, 0), 1)
    assert one.centre_mm == both.centre_mm == (0, 0, 0)


def test_a_mirror_image_changes_the_side_of_the_tool(ends) -> None:
    """The same: G41 and G42 are interchanged, so the tool's path is the mirror image of the other."""
    text = "G1 G41 D1 X10. Y0 F100\nX20.\nY-20.\nX40.\nG40 X60."
    tools = {1: ToolOffset(radius_mm=3.0)}
    plain, mirrored = ends(text, tools=tools), ends(f"G51.1 X0\n{text}", tools=tools)
    assert mirrored == [pytest.approx((-x, y, z)) for x, y, z in plain]


def test_a_mirror_image_turns_rotation_the_other_way(ends) -> None:
    """The same: the senses of coordinate rotation are interchanged, too; the image of a turned figure results:
    (10, 0) turned by 30 degrees, then mirrored."""
    x, y, z = turned(10, 0, 30)
    assert ends("G51.1 X0\nG68 X0 Y0 R30.\nG0 X10. Y0") == [pytest.approx((-x, y, z))]


BOLT_CIRCLE = [(100 * math.cos(math.radians(a)), 100 * math.sin(math.radians(a))) for a in (30, 150, 270)]


@pytest.mark.parametrize(
    "blocks",
    [
        "N2 G81 X100. Y30. Z-20. R-5. F200\nN3 Y150.\nN4 Y270.",
        "N2 G81 X100. Y30. Z-20. R-5. F200\nN3 G91 Y120.\nN4 Y120.",
    ],
    ids=["absolute angles", "incremental angles"],
)
def test_a_bolt_hole_circle(blocks: str, motions) -> None:
    """FANUC 30i user's manual, "Polar coordinate command", sample: three holes on a radius of 100, by absolute and by
    incremental angles."""
    made = motions(f"N1 G17 G90 G16\n{blocks}\nN5 G15 G80")
    bottoms = [m.end_mm for m in made if not m.rapid]
    assert bottoms == [pytest.approx((x, y, -20)) for x, y in BOLT_CIRCLE]


def test_polar_origin_is_the_local_zero(ends) -> None:
    """The same: with G90 the zero of the (local) coordinate system is the polar origin."""
    offsets = {"G54": (10.0, 20.0, 0.0)}
    assert ends("G52 X1. Y2.\nG16\nG0 X5. Y90.", offsets=offsets) == [pytest.approx((11, 27, 0))]


def test_polar_origin_with_g91_is_where_the_tool_is(ends) -> None:
    """The same: a radius given incrementally is measured from the present position."""
    assert ends("G0 X7. Y3.\nG91 G16 X10. Y30.")[-1] == pytest.approx((7 + 10 * math.cos(math.pi / 6), 8, 0))


def test_a_second_incremental_radius_is_refused(refusal) -> None:
    """The manual measures it from the present position, other controls add it to the radius so far."""
    error = refusal("G0 X7. Y3.\nG91 G16 X10. Y30.\nX5.")
    assert (error.code, error.place.line) == ("polar-incremental", 3)


def test_a_cycle_is_refused_while_lengths_are_scaled(motions, refusal) -> None:
    """FANUC 30i user's manual, "Scaling": pecks, clearances and shifts of cycles are not scaled. A mirror image is."""
    assert refusal("G51 P2000\nG83 X1. Z-5. R2. Q1. F100").code == "cycle-scaled"
    mirrored = [m.end_mm for m in motions("G51.1 X0\nG99 G81 X1. Z-5. R2. F100\nG80") if not m.rapid]
    assert mirrored == [pytest.approx((-1, 0, -5))]


@pytest.mark.parametrize(
    ("plane", "words", "end"), [("G18", "Z10. X90.", (10, 0, 0)), ("G19", "Y10. Z90.", (0, 0, 10))]
)
def test_polar_coordinates_in_the_other_planes(plane: str, words: str, end: tuple, ends) -> None:
    """The same: the plane's first axis has the radius, its second the angle."""
    assert ends(f"{plane} G16\nG0 {words}") == [pytest.approx(end, abs=1e-9)]
