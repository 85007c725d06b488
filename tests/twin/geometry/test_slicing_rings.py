"""Rings of sections: joined points, numbered edges, and the check that leaves unions out."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from twin.geometry.mesh import slicing_kernels as kernels
from twin.geometry.mesh.slicing import mesh_edges, weld


def simple(*rings: list[tuple[int, int]]) -> bool:
    points = np.array([p for ring in rings for p in ring], dtype=np.int64)
    ends = np.cumsum([0] + [len(r) for r in rings])
    rows = np.array([(0, a, b) for a, b in pairwise(ends)], dtype=np.int64)
    answer = np.empty(1, dtype=np.bool_)
    kernels.simple_planes(points, rows, answer)
    return bool(answer[0])


SQUARE = [(0, 0), (10, 0), (10, 10), (0, 10)]
HOLE = [(2, 2), (2, 8), (8, 8), (8, 2)]


@pytest.mark.parametrize(
    ("rings", "wanted"),
    [
        ([SQUARE], True),
        ([SQUARE, HOLE], True),
        ([SQUARE, HOLE, [(4, 4), (6, 4), (6, 6), (4, 6)]], True),
        ([SQUARE, [(20, 0), (30, 0), (30, 10), (20, 10)]], True),
        ([SQUARE[::-1]], False),  # a hole in nothing
        ([SQUARE, HOLE[::-1]], False),  # a body inside of a body
        ([SQUARE, [(5, 5), (15, 5), (15, 15), (5, 15)]], False),  # crossing
        ([SQUARE, [(10, 2), (20, 2), (20, 8), (10, 8)]], False),  # touching along a side
        ([SQUARE, [(10, 10), (20, 10), (20, 20), (10, 20)]], False),  # touching at a corner
        ([[(0, 0), (10, 10), (10, 0), (0, 10)]], False),  # crossing itself
        ([[(0, 0), (10, 0), (5, 0), (5, 10)]], False),  # turning straight back
    ],
)
def test_rings_that_need_a_union_are_found(rings: list[list[tuple[int, int]]], wanted: bool) -> None:
    assert simple(*rings) == wanted


def test_points_on_straight_lines_and_slivers_go() -> None:
    ring = [(0.0, 0.0), (0.5, 0.0), (1.0, 0.0), (1.0, 0.0), (1.0, 1.0), (2.0, 1.0), (1.0, 1.0), (0.0, 1.0), (0.0, 0.3)]
    sliver = [(5.0, 5.0), (6.0, 5.0), (5.5, 5.0)]
    points = np.array(ring + sliver)
    rows = np.array([(0, 0, len(ring)), (1, len(ring), len(points))], dtype=np.int64)
    whole, kept = np.empty(points.shape, dtype=np.int64), np.empty_like(rows)
    assert kernels.clean_rings(points, rows, 100.0, 1e-3, whole, kept) == 1
    plane, first, last = kept[0]
    assert plane == 0
    assert {tuple(p) for p in whole[first:last].tolist()} == {(0, 0), (100, 0), (100, 100), (0, 100)}


@given(st.lists(st.tuples(*[st.integers(-3, 3)] * 3), min_size=1, max_size=40))
def test_welding_joins_equal_points_only(points: list[tuple[int, int, int]]) -> None:
    given_points = np.array(points, dtype=np.float64) * 1e-5
    vertices, ids = weld(given_points)
    np.testing.assert_allclose(vertices[ids], given_points, atol=1e-12)
    assert len(vertices) == len(set(points))
    assert (np.diff(np.unique(ids, return_index=True)[1]) > 0).all()


@given(st.lists(st.permutations(range(7)).map(lambda p: p[:3]), min_size=1, max_size=30))
def test_edges_are_numbered_once(triangles: list[list[int]]) -> None:
    faces = np.array(triangles, dtype=np.int64)
    edges = mesh_edges(faces)
    assert len({tuple(e) for e in edges.ends.tolist()}) == len(edges.ends)
    runs: dict[tuple[int, int], int] = {}
    for face, sides in zip(faces.tolist(), edges.sides.tolist(), strict=True):
        for j in range(3):
            a, b = face[j], face[(j + 1) % 3]
            assert sorted((a, b)) == edges.ends[sides[j]].tolist()
            runs[a, b] = runs.get((a, b), 0) + 1
    for (low, high), one, back in zip(edges.ends.tolist(), edges.forward, edges.backward, strict=True):
        assert (runs.get((low, high), 0), runs.get((high, low), 0)) == (one, back)
