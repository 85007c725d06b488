"""The column cells against GEOS and pyclipper: same areas, same points, over thousands of cuts."""

from __future__ import annotations

import os
from collections.abc import Iterator

import numpy as np
import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st

from twin.arrays import FloatArray
from twin.geometry.column_cells.cells import CellFamily
from twin.geometry.column_cells.query_kernels import Planes
from twin.geometry.column_cells.store_kernels import SIZE
from twin.geometry.column_cells.strips import Strips
from twin.geometry.polygons import clip
from twin.geometry.polygons.region import Region

CUTS = 60 if os.environ.get("NUMBA_DISABLE_JIT") == "1" else 2000
OUTER = [(0.0, 0.0), (20.0, 0.0), (20.0, 12.7), (0.0, 12.7)]
HOLE = [(5.0, 5.0), (5.0, 8.0), (9.0, 8.0), (9.0, 5.0)]


def family_of(region: Region, cell_mm: float = 1.0) -> CellFamily:
    points = np.concatenate(region.rings)
    low, high = points.min(axis=0), points.max(axis=0)
    return CellFamily([region], (low[0], low[1]), (high[0], high[1]), cell_mm)


def strip(outline: FloatArray) -> Strips:
    """A convex polygon as a strip on plane 0."""
    outline = np.array(shapely.geometry.polygon.orient(shapely.Polygon(outline)).exterior.coords)[:-1]
    after = np.roll(outline, -1, axis=0)
    u = np.unique(outline[:, 0])
    lo, hi = np.full(len(u), np.inf), np.full(len(u), -np.inf)
    for (ua, va), (ub, vb) in zip(outline, after, strict=True):
        (u0, v0), (u1, v1) = sorted(((ua, va), (ub, vb)))
        on = (u >= u0) & (u <= u1)
        values = np.interp(u[on], [u0, u1], [v0, v1]) if u1 > u0 else None
        for v in (v0, v1) if values is None else (values,):
            lo[on], hi[on] = np.minimum(lo[on], v), np.maximum(hi[on], v)
    return Strips(
        np.zeros(1, dtype=np.int64),
        np.array([0, len(u)]),
        np.column_stack((u, lo, hi)),
        np.ones(len(u), dtype=np.bool_),
    )


def strips(outlines: FloatArray) -> Iterator[Strips]:
    """Convex polygons without vertical edges as strips on plane 0; as `strip`, many together.

    Args:
        outlines: shape (n, vertices, 2).
    """
    ua, va = np.moveaxis(outlines, 2, 0)[:, :, np.newaxis]
    ub, vb = np.moveaxis(np.roll(outlines, -1, axis=1), 2, 0)[:, :, np.newaxis]
    u = np.sort(outlines[:, :, 0], axis=1)[:, :, np.newaxis]
    on_edge = (u >= np.minimum(ua, ub)) & (u <= np.maximum(ua, ub))
    v = np.where(u == ub, vb, va + (vb - va) * ((u - ua) / (ub - ua)))
    lo, hi = np.where(on_edge, v, np.inf).min(axis=2), np.where(on_edge, v, -np.inf).max(axis=2)
    nodes = np.stack((u[:, :, 0], lo, hi), axis=2)
    ends, fresh = np.array([0, nodes.shape[1]]), np.ones(nodes.shape[1], dtype=np.bool_)
    return (Strips(np.zeros(1, dtype=np.int64), ends, polygon, fresh) for polygon in nodes)


def capsule(rng: np.random.Generator) -> FloatArray:
    """Outline of a disc of random size moved by a random distance."""
    radius = rng.choice([0.02, 0.5, 1.0, 4.0], p=[0.3, 0.4, 0.25, 0.05])
    angle = np.linspace(0.0, 2.0 * np.pi, 40, endpoint=False)
    disc = radius * np.column_stack((np.cos(angle), np.sin(angle)))
    start = rng.uniform((-3.0, -3.0), (23.0, 16.0))
    move = rng.uniform(-2.0, 2.0, 2) * rng.integers(0, 2)
    hull = shapely.convex_hull(shapely.multipoints(np.concatenate((disc + start, disc + start + move))))
    return np.array(hull.exterior.coords)[:-1]


def test_thousands_of_cuts_agree_with_geos_and_pyclipper() -> None:
    region = Region.of(OUTER, HOLE)
    family = family_of(region)
    rng = np.random.default_rng(7)
    truth = shapely.Polygon(OUTER).difference(shapely.Polygon(HOLE))
    paths = clip.to_paths(region.rings)
    outline = capsule(rng)
    for number in range(CUTS):
        if number % 5 != 1:  # every fifth cut repeats the one before exactly
            outline = capsule(rng) if number % 50 else capsule(rng) * 0.01 + 3.0
        before = family.area_mm2[0]
        removed = family.cut(strip(outline))
        assert removed[0] == pytest.approx(before - family.area_mm2[0], abs=1e-12)
        if number % 5 == 1:
            assert removed[0] == pytest.approx(0.0, abs=1e-11)
        truth = truth.difference(shapely.Polygon(outline))
        paths = clip.difference(paths, clip.to_paths([outline]))
        if number % 20 == 0:
            assert family.area_mm2[0] == pytest.approx(truth.area, abs=1e-9)
            assert family.area_mm2[0] == pytest.approx(clip.area_mm2(paths), abs=1e-4)
        if truth.area < 40.0 and number % 5 == 4:
            family, paths = family_of(region), clip.to_paths(region.rings)
            truth = shapely.Polygon(OUTER).difference(shapely.Polygon(HOLE))
    assert family.region(0).area_mm2 == pytest.approx(truth.area, abs=1e-5)
    points = rng.uniform((-1.0, -1.0), (21.0, 14.0), (5000, 2))
    votes = np.zeros(len(points), dtype=np.int8)
    family.vote(np.column_stack((points, np.zeros(5000))), Planes(2, 0, 1, -0.5, 1.0), votes, 0, 0)
    assert np.array_equal(votes > 0, shapely.contains_xy(truth, points[:, 0], points[:, 1]))
    lines = np.sort(rng.uniform(-1.0, 21.0, 300))
    offsets, ends, _ = family.line_ends(np.array([0]), 0, lines, (-1.0, 20.0))
    for u, first, last in zip(lines, offsets[:-1], offsets[1:], strict=True):
        along = ends[first:last]
        assert len(along) % 2 == 0
        assert np.all(np.diff(along) >= 0.0)
        length = truth.intersection(shapely.LineString([(u, -1.0), (u, 20.0)])).length
        assert np.sum(along[1::2] - along[::2]) == pytest.approx(length, abs=1e-9)


def test_a_hundred_thousand_cuts_agree_with_geos() -> None:
    """Small convex cuts all over a plane, most of them into what others have left: areas differ by rounding only.

    GEOS takes long for the union of them all: it checks every second tile of every second row, and the tiles together
    are what the cuts have left.
    """
    cuts, side, rng = 50 * CUTS, 100.0, np.random.default_rng(5)
    family = family_of(Region.of([(0.0, 0.0), (side, 0.0), (side, side), (0.0, side)]), cell_mm=0.5)
    angle = np.sort(rng.uniform(0.0, 2.0 * np.pi, (cuts, 7)), axis=1)
    radius = rng.uniform(0.05, 0.4, (cuts, 1)) * np.sqrt(100_000 / cuts)
    around = np.stack((np.cos(angle), np.sin(angle)), axis=2) * radius[:, :, np.newaxis]
    outlines = rng.uniform(0.0, side, (cuts, 1, 2)) + around
    for polygon in strips(outlines):
        family.cut(polygon)
    assert 0.2 * side**2 < family.area_mm2[0] < 0.5 * side**2
    tiles = [shapely.box(u, v, u + 4.9, v + 4.9) for u in np.arange(0.0, side, 4.9) for v in np.arange(0.0, side, 4.9)]
    areas = [family.cut(strip(np.array(tile.exterior.coords)), apply=False)[0] for tile in tiles]
    assert sum(areas) == pytest.approx(family.area_mm2[0], abs=1e-8)
    polygons = shapely.polygons(outlines)
    tree = shapely.STRtree(polygons)
    for tile, area in list(zip(tiles, areas, strict=True))[::2]:
        if round(tile.bounds[0] / 4.9) % 2 == 0:
            material = shapely.intersection(tile, shapely.box(0.0, 0.0, side, side))
            left = material.difference(shapely.union_all(polygons[tree.query(tile)]))
            assert area == pytest.approx(left.area, abs=1e-9)


def test_cells_grow_without_bound() -> None:
    """More slits in one cell than any first guess of its room, and none is lost."""
    family = family_of(Region.of([(0, 0), (10, 0), (10, 10), (0, 10)]), cell_mm=10.0)
    count = 40 if CUTS == 60 else 900
    for i in range(count):
        v = (i + 0.25) * 10.0 / count
        family.cut(strip(np.array([(1.0, v), (9.0, v), (9.0, v + 5.0 / count), (1.0, v + 5.0 / count)])))
    assert family.area_mm2[0] == pytest.approx(100.0 - 8.0 * 5.0, abs=1e-9)
    assert family.store.cells[:, SIZE].max() >= 2 * count


def test_measuring_changes_nothing() -> None:
    family = family_of(Region.of(OUTER, HOLE))
    outline = np.array([(1.0, 1.0), (7.0, 2.0), (3.0, 6.0)])
    measured = family.cut(strip(outline), apply=False)
    assert measured[0] == pytest.approx(shapely.Polygon(outline).difference(shapely.Polygon(HOLE)).area)
    assert family.area_mm2[0] == pytest.approx(254.0 - 12.0)
    assert family.cut(strip(outline)) == pytest.approx(measured, abs=1e-12)


def test_a_plane_nothing_touched_takes_no_memory() -> None:
    region = Region.of(OUTER)
    family = CellFamily([region] * 50, (0.0, 0.0), (20.0, 12.7), 1.0)
    family.cut(strip(np.array([(1.0, 1.0), (7.0, 2.0), (3.0, 6.0)])))
    assert sum(family.built(k) for k in range(50)) == 1
    assert family.region(7) is region


def test_an_empty_plane_stays_empty() -> None:
    family = CellFamily([Region()], (0.0, 0.0), (5.0, 5.0), 1.0)
    assert family.cut(strip(np.array([(1.0, 1.0), (7.0, 2.0), (3.0, 6.0)])))[0] == 0.0
    assert family.region(0).empty


@settings(max_examples=40, deadline=None)
@given(
    st.lists(
        st.tuples(st.integers(-2, 12), st.integers(-2, 12), st.integers(1, 5), st.integers(1, 5)),
        min_size=1,
        max_size=12,
    )
)
def test_cuts_along_cell_borders(boxes: list[tuple[int, int, int, int]]) -> None:
    """Rectangles whose sides lie exactly on the borders of cells, where a wrong half-open rule would leak."""
    family = family_of(Region.of([(0, 0), (10, 0), (10, 10), (0, 10)]))
    truth = shapely.box(0, 0, 10, 10)
    for u, v, width, height in boxes:
        family.cut(strip(np.array([(u, v), (u + width, v), (u + width, v + height), (u, v + height)], dtype=float)))
        truth = truth.difference(shapely.box(u, v, u + width, v + height))
    assert family.area_mm2[0] == pytest.approx(truth.area, abs=1e-9)
    assert family.region(0).area_mm2 == pytest.approx(truth.area, abs=1e-6)


def test_parts_a_thousand_times_smaller_and_larger_cut_alike() -> None:
    removed = []
    for scale in (1e-3, 1.0, 1e3):
        family = family_of(Region.of(np.array(OUTER) * scale, np.array(HOLE) * scale), cell_mm=scale)
        rng = np.random.default_rng(3)
        removed.append(sum(family.cut(strip(capsule(rng) * scale))[0] for _ in range(20)) / scale**2)
    assert removed == pytest.approx([removed[1]] * 3, rel=1e-9)
