from __future__ import annotations

import numpy as np
import shapely

from twin.geometry.polygons.guards import guarded
from twin.geometry.polygons.shapes import Shapes

RADIUS = 4.0


def bowl() -> Shapes:
    """A long flat bottom, a short edge beside it, and the sides."""
    half = [(9.5141, 0.0), (9.5353, 0.00052), (9.66176, 0.00364), (12.0, 1.5), (12.0, -3.0)]
    left = [(-x, y) for x, y in half if x != 9.5353]
    found = np.empty(2, dtype=object)
    found[:] = [shapely.Polygon(half[::-1] + left)] * 2
    return found


def highest_on_the_bottom(shape: shapely.Polygon) -> float:
    inflated = shapely.buffer(shape, RADIUS, quad_segs=200)
    middle = shapely.intersection(inflated, shapely.LineString([(8.0, 0.0), (8.0, 5.0)]))
    return float(shapely.get_coordinates(middle)[:, 1].max())


def test_a_short_edge_does_not_tilt_the_long_one_beside_it() -> None:
    shapes = bowl()
    safe = guarded(shapes, RADIUS)
    assert safe[0] is safe[1]
    assert shapely.symmetric_difference(safe[0], shapes[0]).area < 1e-9
    assert abs(highest_on_the_bottom(safe[0]) - RADIUS) < 1e-9
    # what it is there for: without, the bottom lies too high
    assert highest_on_the_bottom(shapes[0]) > RADIUS + 1e-4


def test_polygons_without_short_edges_stay_the_same_objects() -> None:
    shapes = np.array([shapely.box(0, 0, 5, 5), shapely.MultiPolygon()], dtype=object)
    assert all(a is b for a, b in zip(guarded(shapes, RADIUS), shapes, strict=True))


def test_holes_and_parts_are_kept() -> None:
    ring = shapely.Polygon(
        [(0, 0), (20, 0), (20, 20), (0, 20), (-0.01, 19.99)], [[(5, 5), (5, 15), (15, 15), (15, 5), (14.99, 4.99)]]
    )
    both = np.array([shapely.MultiPolygon([ring, shapely.box(30, 0, 35, 5)])], dtype=object)
    safe = guarded(both, RADIUS)[0]
    assert shapely.get_num_coordinates(safe) > shapely.get_num_coordinates(both[0])
    assert shapely.symmetric_difference(safe, both[0]).area < 1e-9
