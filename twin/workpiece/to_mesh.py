"""The surface of the machined part as triangles, from its slices.

Nodes of a lattice lie where slices of all three families meet. The slices determine which nodes are in material, where
the surface crosses the lattice's edges, and its slope there. Every cell with a surface gets a vertex nearest to the
tangent planes at its crossings (dual contouring: Ju, Losasso, Schaefer and Warren, 2002), one for each sheet of the
surface (Nielson's dual marching cubes, 2004), so flat faces come out flat, edges sharp, and the whole closed: every
edge is used as often in one direction as in the other, though sheets that touch may share one. Details thinner than
a cell may be lost.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from twin.arrays import FloatArray
from twin.record import WorkpiecePatch
from twin.workpiece.dual_contouring import MARGIN, SurfacePart, draw_part, in_use
from twin.workpiece.lattice import Lattice, Patch, PatchGrid
from twin.workpiece.store import SliceStore

#: Cells of a block along x and y when its surface is drawn in patches, and when it is one mesh.
PATCH_CELLS = 16
WHOLE_CELLS = 64


class SurfaceMesh(NamedTuple):
    """Triangles of a closed surface.

    Attributes:
        vertices_mm: shape (n, 3).
        normals: shape (n, 3), outward unit normals; the mean one on edges and corners.
        triangles: shape (m, 3), counter-clockwise seen from outside.
    """

    vertices_mm: FloatArray
    normals: FloatArray
    triangles: NDArray[np.int64]


def surface_mesh(store: SliceStore, pitch_mm: float | None = None) -> SurfaceMesh:
    """The whole surface as one closed mesh, no two vertices at one point.

    Args:
        pitch_mm: largest distance of the lattice's nodes; None for 200 cells along the longest side.

    Raises:
        StockError: a pitch that is not above 0.
    """
    grid = patch_grid(store, pitch_mm=pitch_mm, size=WHOLE_CELLS)
    parts = [draw_part(store, grid, patch) for patch in grid.patches]
    names = np.concatenate([p.names for p in parts])
    _, where, corners = np.unique(names, return_index=True, return_inverse=True)
    firsts = np.concatenate(([0], np.cumsum([len(p.names) for p in parts])))
    triangles = [corners[p.triangles + f] for p, f in zip(parts, firsts, strict=False)]
    vertices = np.concatenate([p.vertices for p in parts])[where]
    normals = np.concatenate([p.normals for p in parts])[where]
    return SurfaceMesh(vertices, normals, np.concatenate(triangles).reshape(-1, 3).astype(np.int64))


def patch_grid(store: SliceStore, pitch_mm: float | None = None, size: int = PATCH_CELLS) -> PatchGrid:
    """The blocks that a workpiece's surface is drawn in.

    Args:
        pitch_mm: largest distance of the lattice's nodes; None for 200 cells along the longest side.
        size: cells of a block along x and y.

    Raises:
        StockError: a pitch that is not above 0.
    """
    return PatchGrid(Lattice.of(store, pitch_mm), size)


def patch_mesh(store: SliceStore, grid: PatchGrid, patch: Patch, t_s: float = 0.0) -> WorkpiecePatch:
    """The surface of one block, ready to be drawn: on edges and corners every triangle has vertices of its own.

    Neighbouring blocks meet without a gap: both compute the vertices between them from the same slices.
    """
    part = draw_part(store, grid, patch)
    split = part.creased[part.triangles]
    extra = np.flatnonzero(split.ravel())
    triangles = part.triangles.ravel().copy()
    own = _face_normals(part)[extra // 3]
    vertices = np.concatenate((part.vertices, part.vertices[triangles[extra]]))
    normals = np.concatenate((part.normals, own))
    triangles[extra] = len(part.vertices) + np.arange(len(extra))
    used, corners = in_use(triangles, len(vertices))
    return WorkpiecePatch(
        t_s=t_s,
        patch=patch.name,
        vertices_mm=vertices[used].astype(np.float32),
        normals=normals[used].astype(np.float32),
        triangles=corners.reshape(-1, 3).astype(np.uint32),
    )


def _face_normals(part: SurfacePart) -> FloatArray:
    """Unit normals of triangles; that of the crossing where a triangle is too thin for one of its own."""
    a, b, c = (part.vertices[part.triangles[:, i]] for i in range(3))
    cross = np.cross(b - a, c - a)
    length = np.linalg.norm(cross, axis=1, keepdims=True)
    longest = np.maximum(np.linalg.norm(b - a, axis=1), np.linalg.norm(c - a, axis=1))[:, None]
    thin = length <= MARGIN * longest**2
    return np.where(thin, part.leading, cross / np.where(thin, 1.0, length))
