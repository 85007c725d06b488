"""Boxes and cylinders as slices: planes, pitches, areas, volumes."""

from __future__ import annotations

import math
import re

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from twin.errors import StockError
from twin.workpiece.stock import SliceSet, box_slices, circle_polygon, cylinder_slices
from twin.workpiece.store import PLANE_AXES

extents = st.floats(0.01, 50.0).map(lambda x: round(x, 5))


def volumes(slices: SliceSet) -> list[float]:
    return [
        sum(r.area_mm2 for r in family) * float(pitch)
        for family, pitch in zip(slices.regions, slices.pitch_mm, strict=True)
    ]


@given(st.tuples(extents, extents, extents), st.floats(0.5, 100.0))
def test_a_boxs_volume_is_exact_in_all_three_directions_at_any_pitch(
    extent: tuple[float, float, float], pitch: float
) -> None:
    slices = box_slices((-1.0, 2.0, 3.0), np.array((-1.0, 2.0, 3.0)) + extent, pitch)
    assert volumes(slices) == pytest.approx([math.prod(extent)] * 3, rel=1e-9)


@given(st.tuples(extents, extents, extents), st.floats(0.5, 100.0))
def test_planes_are_never_further_apart_than_asked_and_never_on_a_face(
    extent: tuple[float, float, float], pitch: float
) -> None:
    slices = box_slices((0.0, 0.0, 0.0), extent, pitch)
    for axis in range(3):
        planes = slices.positions_mm(axis)
        assert slices.pitch_mm[axis] <= pitch * (1.0 + 1e-8)
        assert planes[0] - 0.0 == pytest.approx(0.5 * slices.pitch_mm[axis])
        assert extent[axis] - planes[-1] == pytest.approx(0.5 * slices.pitch_mm[axis], rel=1e-6)


@pytest.mark.parametrize("scale", [0.01, 1.0, 1000.0])
def test_a_whole_number_of_pitches_makes_as_many_planes_in_spite_of_rounding(scale: float) -> None:
    slices = box_slices((0.0, -0.3 * scale, 0.1 * scale), (6.0 * scale, 0.0, 0.4 * scale), 0.1 * scale)
    assert [len(f) for f in slices.regions] == [60, 3, 3]


def test_stock_thinner_than_the_pitch_has_one_plane_in_its_middle() -> None:
    slices = box_slices((0.0, 0.0, 0.0), (60.0, 60.0, 0.02), 0.1)
    assert len(slices.regions[2]) == 1
    assert slices.positions_mm(2) == pytest.approx([0.01])
    assert volumes(slices) == pytest.approx([72.0] * 3)


@pytest.mark.parametrize("axis", ["x", "y", "z"])
def test_sections_across_a_cylinder_have_the_circles_area_and_stay_in_its_box(axis: str) -> None:
    slices = cylinder_slices(centre_mm=(3.0, -2.0), diameter_mm=10.0, axis=axis, low_mm=-1.0, high_mm=4.0, pitch_mm=0.5)
    w = "xyz".index(axis)
    region = slices.regions[w][0]
    perimeter = math.pi * 10.0
    assert region.area_mm2 == pytest.approx(math.pi * 25.0, abs=perimeter * 1e-5)
    assert (slices.low_mm[w], slices.high_mm[w]) == (-1.0, 4.0)
    for column, across in enumerate(PLANE_AXES[w]):
        points = region.rings[0][:, column]
        assert slices.low_mm[across] <= points.min() < points.max() <= slices.high_mm[across]
        assert slices.high_mm[across] - slices.low_mm[across] == pytest.approx(10.0)


@pytest.mark.parametrize("chord", [0.1, 0.001])
def test_a_circles_polygon_keeps_within_its_stated_distance(chord: float) -> None:
    polygon = circle_polygon(20.0, chord)
    corners = np.linalg.norm(polygon, axis=1)
    middles = np.linalg.norm(0.5 * (polygon + np.roll(polygon, 1, axis=0)), axis=1)
    assert 0.0 < corners.max() - 20.0 <= 2.0 * chord / 3.0 * 1.01
    assert 0.0 < 20.0 - middles.min() <= chord / 3.0 * 1.01


def test_the_volume_from_sections_along_a_cylinder_converges_with_the_power_three_halves() -> None:
    exact = math.pi * 25.0 * 3.0
    errors = []
    for pitch in (0.5, 0.125):
        slices = cylinder_slices(
            centre_mm=(0.0, 0.0), diameter_mm=10.0, axis="z", low_mm=0.0, high_mm=3.0, pitch_mm=pitch
        )
        x, y, _ = volumes(slices)
        assert x == pytest.approx(y, rel=1e-12)
        errors.append(x - exact)
    assert math.log(errors[0] / errors[1]) / math.log(4.0) == pytest.approx(1.5, abs=0.1)


def test_vertices_are_rounded_to_a_hundred_thousandth() -> None:
    slices = cylinder_slices(
        centre_mm=(1 / 3, 1 / 7), diameter_mm=1.0, axis="x", low_mm=0.0, high_mm=1 / 9, pitch_mm=0.1
    )
    for family in slices.regions:
        for region in family:
            for points in region.rings:
                assert np.array_equal(points, np.round(points, 5))


def test_a_plane_that_only_grazes_a_cylinder_is_empty() -> None:
    slices = cylinder_slices(centre_mm=(0.0, 0.0), diameter_mm=1e-4, axis="z", low_mm=0.0, high_mm=1.0, pitch_mm=1e-6)
    assert slices.regions[0][0].empty


@pytest.mark.parametrize(
    ("low", "high", "pitch", "message"),
    [
        ((0, 0, 0), (1, 0, 1), 0.1, "the stock reaches from 0 to 0 mm along y; expected an extent above 0"),
        ((0, 0, 2), (1, 1, 1), 0.1, "the stock reaches from 2 to 1 mm along z; expected an extent above 0"),
        ((0, 0, 0), (1, 1, 1), 0.0, "slice pitch 0 mm; expected a number above 0"),
        ((0, 0, 0), (1, 1, 1), math.nan, "slice pitch nan mm; expected a number above 0"),
        (
            (0, 0, 0),
            (60, 1, 1),
            1e-6,
            "slice pitch 1e-06 mm; expected at least 0.0006 mm, finer slices of a stock of 60 x 1 x 1 mm do not fit in "
            "memory",
        ),
    ],
)
def test_what_cannot_be_sliced_is_refused(
    low: tuple[float, ...], high: tuple[float, ...], pitch: float, message: str
) -> None:
    with pytest.raises(StockError, match=f"^{re.escape(message)}$"):
        box_slices(low, high, pitch)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"axis": "w"}, 'cylinder axis "w"; expected "x", "y" or "z"'),
        ({"diameter_mm": -1.0}, "cylinder diameter -1 mm; expected a number above 0"),
        ({"high_mm": 0.0}, "the stock reaches from 0 to 0 mm along z; expected an extent above 0"),
    ],
)
def test_a_cylinder_that_cannot_be_is_refused(change: dict[str, object], message: str) -> None:
    right = {"centre_mm": (0, 0), "diameter_mm": 1.0, "axis": "z", "low_mm": 0.0, "high_mm": 1.0, "pitch_mm": 0.1}
    with pytest.raises(StockError, match=f"^{re.escape(message)}$"):
        cylinder_slices(**(right | change))  # type: ignore[arg-type]
