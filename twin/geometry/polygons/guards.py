"""Polygons prepared for inflation by GEOS.

Before it inflates a polygon, GEOS omits vertices of shallow concave corners whose edge before them is shorter than
one hundredth of the radius. Next to a long edge that tilts the whole edge: half a micrometre for a ball of 4 mm on the
plate of a small part, up to a hundredth of the radius at worst. A vertex on the long edge, close to its end, keeps the
tilt within that end. Arcs of short edges are not guarded: there the edges that GEOS makes are at most two hundredths of
the radius r long, and deviate outwards by (r / 50)^2 / (8 r), 5e-5 r.
"""

from __future__ import annotations

import numpy as np
import shapely

from twin.arrays import FloatArray
from twin.geometry.polygons.shapes import Shape, Shapes

#: Edges shorter than this part of the radius may be omitted; a little above GEOS's own limit.
_SHORT = 0.0125
#: Edges from this many such lengths get vertices close to their ends.
_LONG = 10.0


def guarded(shapes: Shapes, radius_mm: float) -> Shapes:
    """The same polygons with vertices added where long edges meet short ones; equal objects stay equal objects.

    Args:
        radius_mm: largest radius they will be inflated by.
    """
    made = {id(s): s for s in shapes}
    known = {key: _guarded(shape, _SHORT * radius_mm) for key, shape in made.items()}
    found = np.empty(len(shapes), dtype=object)
    found[:] = [known[id(s)] for s in shapes]
    return found


def _guarded(shape: Shape, short_mm: float) -> Shape:
    parts = shapely.get_parts(shape)
    rings, of = shapely.get_rings(parts, return_index=True)
    if len(rings) == 0:
        return shape
    made = [_with_vertices(shapely.get_coordinates(ring), short_mm) for ring in rings]
    if all(new is None for new in made):
        return shape
    lines = [ring if new is None else shapely.linearrings(new) for ring, new in zip(rings, made, strict=True)]
    # the first ring of a part is its outer one
    grouped = [[line for line, own in zip(lines, of, strict=True) if own == k] for k in range(len(parts))]
    polygons = [shapely.polygons(own[0], own[1:] or None) for own in grouped]
    return polygons[0] if len(polygons) == 1 else shapely.multipolygons(polygons)


def _with_vertices(ring: FloatArray, short_mm: float) -> FloatArray | None:
    """A closed ring with vertices on long edges next to short ones; None where there are none."""
    along = np.diff(ring, axis=0)
    size = np.hypot(along[:, 0], along[:, 1])
    long, short = size > _LONG * short_mm, size < short_mm
    begins, ends = np.flatnonzero(long & np.roll(short, 1)), np.flatnonzero(long & np.roll(short, -1))
    if len(begins) + len(ends) == 0:
        return None
    share = short_mm / size
    first = ring[begins] + share[begins, None] * along[begins]
    last = ring[ends + 1] - share[ends, None] * along[ends]
    # where both go on one edge, the one at its beginning comes first
    return np.insert(ring, np.concatenate((begins, ends)) + 1, np.concatenate((first, last)), axis=0)
