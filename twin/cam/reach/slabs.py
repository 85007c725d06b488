"""Slabs: the layer of the part that each slice represents.

A slice represents half a pitch on either side, or less where a face of the part lies between two slices.
"""

from __future__ import annotations

import numpy as np

from twin.arrays import FloatArray
from twin.cam.slices.sections import flat_triangles
from twin.workpiece.solids.from_mesh import Solid


def slabs_mm(mesh: Solid, axis: int, planes_mm: FloatArray, pitch_mm: float) -> FloatArray:
    """Ends of the slab that each plane represents.

    A region that ends at a face would otherwise appear up to half a pitch too high or too low there. Of several faces
    between two planes the largest counts.

    Args:
        planes_mm: shape (n,), one ``pitch_mm`` apart.

    Returns:
        shape (n, 2), increasing, without gaps.
    """
    ends = np.concatenate((planes_mm - 0.5 * pitch_mm, planes_mm[-1:] + 0.5 * pitch_mm))
    which, vectors = flat_triangles(mesh, axis)
    areas = np.linalg.norm(vectors, axis=0)
    heights = mesh.vertices_mm[mesh.triangles[which, 0], axis]
    levels, of = np.unique(heights, return_inverse=True)
    # the largest last, so that it overwrites the others
    levels = levels[np.argsort(np.bincount(of, weights=areas, minlength=len(levels)), kind="stable")]
    between = np.searchsorted(planes_mm, levels)
    inner = (between > 0) & (between < len(planes_mm))
    for end, level in zip(between[inner], levels[inner], strict=True):
        ends[end] = level
    return np.column_stack((ends[:-1], ends[1:]))
