"""A triangle mesh drawn with matplotlib: shaded, seen along a direction, far triangles first."""

from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import PolyCollection
from numpy.typing import NDArray

from twin.arrays import FloatArray

#: More triangles are joined on a grid before they are drawn.
MOST_TRIANGLES = 60_000
_GRID = 220
_COLOUR = np.array((0.70, 0.735, 0.78))
_LIGHT = np.array((-0.35, -0.55, 0.76))

_ROOT2, _ROOT6 = 2.0**0.5, 6.0**0.5
#: Rows that take x, y, z to the picture's right, up, and towards the eye: from the front right above, and from above.
ISO = np.array(
    (
        (1 / _ROOT2, 1 / _ROOT2, 0.0),
        (-1 / _ROOT6, 1 / _ROOT6, 2 / _ROOT6),
        (1 / 3**0.5, -1 / 3**0.5, 1 / 3**0.5),
    )
)
PLAN = np.eye(3)


def draw_solid(axes: Axes, vertices_mm: NDArray[Any], triangles: NDArray[Any], view: FloatArray) -> None:
    """Draw the faces of a mesh that look towards the eye, light grey, lit from the left above.

    Args:
        vertices_mm: shape (n, 3).
        triangles: shape (m, 3), counter-clockwise seen from outside.
        view: shape (3, 3), rows to the picture's right, up, and towards the eye.
    """
    if len(triangles) > MOST_TRIANGLES:
        vertices_mm, triangles = _coarser(vertices_mm, triangles)
    corners = np.asarray(vertices_mm, dtype=np.float64)[triangles]
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    sizes = np.linalg.norm(normals, axis=1)
    kept = (normals @ view[2] > 0.0) & (sizes > 0.0)
    corners, normals = corners[kept], normals[kept] / sizes[kept, None]
    order = np.argsort(corners.mean(axis=1) @ view[2], kind="stable")
    light = 0.45 + 0.55 * np.clip(normals[order] @ (_LIGHT / np.linalg.norm(_LIGHT)), 0.0, 1.0)
    colours = np.clip(_COLOUR * light[:, None] * 1.12, 0.0, 1.0)
    faces = PolyCollection(
        list(corners[order] @ view[:2].T),
        facecolors=colours,
        edgecolors=colours,
        linewidths=0.4,
        antialiaseds=False,
        zorder=1,
    )
    faces.set_rasterized(True)
    axes.add_collection(faces)


def _coarser(vertices_mm: NDArray[Any], triangles: NDArray[Any]) -> tuple[FloatArray, NDArray[Any]]:
    """The mesh with the vertices of each cell of a grid at their mean; triangles that vanish are omitted."""
    points = np.asarray(vertices_mm, dtype=np.float64)
    low = points.min(axis=0)
    cell = max(float(np.ptp(points, axis=0).max()) / _GRID, 1e-9)
    _, index, counts = np.unique(
        ((points - low) / cell).astype(np.int32), axis=0, return_inverse=True, return_counts=True
    )
    index = index.ravel()
    means = np.stack([np.bincount(index, points[:, i]) for i in range(3)], axis=1) / counts[:, None]
    joined = index[triangles]
    a, b, c = joined.T
    kept = joined[(a != b) & (b != c) & (c != a)]
    return means, kept
