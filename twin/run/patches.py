"""The patches of the workpiece's surface joined to one mesh."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np

from twin.record import WorkpiecePatch
from twin.workpiece.to_mesh import SurfaceMesh


def joined(patches: Iterable[WorkpiecePatch]) -> SurfaceMesh:
    """Join patches; vertices at the same position are merged, and triangles without area removed."""
    full = [patch for patch in patches if len(patch.triangles)]
    if not full:
        return SurfaceMesh(np.zeros((0, 3)), np.zeros((0, 3)), np.zeros((0, 3), np.int64))
    firsts = np.cumsum([0, *(len(patch.vertices_mm) for patch in full[:-1])])
    corners = np.concatenate([p.triangles.astype(np.int64) + first for p, first in zip(full, firsts, strict=True)])
    normals = np.concatenate([p.normals for p in full]).astype(np.float64)
    places, where, numbers = np.unique(
        np.concatenate([p.vertices_mm for p in full]), axis=0, return_index=True, return_inverse=True
    )
    triangles = numbers.reshape(-1)[corners]
    a, b, c = triangles.T
    return SurfaceMesh(places.astype(np.float64), normals[where], triangles[(a != b) & (b != c) & (c != a)])
