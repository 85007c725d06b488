from __future__ import annotations

import numpy as np
import pytest
from support.small_parts import box, prism, small_torus

from twin.geometry.mesh.closest import ClosestPoints
from twin.workpiece.solids.from_mesh import Solid
from twin.workpiece.solids.solid_check import winding_number


def tree(part: Solid) -> ClosestPoints:
    return ClosestPoints(part.vertices_mm, part.triangles, part.edges)


def test_distances_from_a_box_are_those_of_the_formula() -> None:
    points = np.random.default_rng(1).uniform(-3.0, 3.0, (500, 3))
    found = tree(box((-1.0, -2.0, -1.5), (1.0, 2.0, 1.5))).ask(points)
    over = np.abs(points) - np.array([1.0, 2.0, 1.5])
    wanted = np.linalg.norm(np.maximum(over, 0.0), axis=1) + np.minimum(over.max(axis=1), 0.0)
    assert found.distance_mm == pytest.approx(wanted, abs=1e-12)
    assert np.linalg.norm(found.places_mm - points, axis=1) == pytest.approx(np.abs(wanted), abs=1e-12)
    assert np.linalg.norm(found.normals, axis=1) == pytest.approx(1.0)


def test_signs_agree_with_the_winding_number() -> None:
    part = small_torus()
    points = np.random.default_rng(2).uniform((-12, -12, -3), (12, 12, 3), (100, 3))
    found = tree(part).ask(points)
    inside = [winding_number(p, part.vertices_mm, part.triangles) > 0.5 for p in points]
    assert ((found.distance_mm < 0.0) == inside).all()


def test_corners_and_edges_of_a_notch_have_the_right_side() -> None:
    # nearest to the reflex edge of an L, where one of the two faces alone would tell the wrong side
    part = prism([(0, 0), (4, 0), (4, 1), (1, 1), (1, 4), (0, 4)], -1.0, 1.0)
    found = tree(part).ask(np.array([(0.9, 0.0, 0.9), (1.1, 0.0, 1.1), (4.2, 1.3, 1.1), (-0.1, 0.0, -0.1)]))
    assert found.distance_mm == pytest.approx([-np.hypot(0.1, 0.1), 0.1, np.sqrt(0.14), np.hypot(0.1, 0.1)])


def test_answers_do_not_depend_on_threads() -> None:
    part = small_torus()
    points = np.random.default_rng(3).uniform((-12, -12, -3), (12, 12, 3), (100, 3))
    one, two = (tree(part).ask(points, threads) for threads in (1, 2))
    assert all(np.array_equal(a, b) for a, b in zip(one, two, strict=True))
