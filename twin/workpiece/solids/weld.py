"""Seams of a triangle mesh that are open by less than a micrometre: their vertices are welded, their edges divided.

Exporters round each body's vertices on its own, so that neighbouring triangles miss each other by the last digit (a
crack), or put a vertex on the edge of a neighbour (a T-vertex). Only vertices on open edges are moved, by no more than
the tolerance; anything wider stays open.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from twin.arrays import FloatArray
from twin.geometry.mesh.slicing import MeshEdges, mesh_edges

if TYPE_CHECKING:
    from scipy.spatial import cKDTree

#: Vertices on open edges up to this far apart are one, mm.
WELD_MM = 1e-3
#: A triangle is divided at most this often.
_ROUNDS = 20


class Mesh(NamedTuple):
    """Triangles with their edges.

    Attributes:
        triangles: shape (m, 3).
        edges: their edges.
        numbers: shape (m,), number of each triangle in its file, from 0.
    """

    triangles: NDArray[np.int64]
    edges: MeshEdges
    numbers: NDArray[np.int64]

    @classmethod
    def of(cls, triangles: NDArray[np.int64], numbers: NDArray[np.int64]) -> Mesh:
        """Triangles without those that have a corner twice."""
        i, j, k = triangles.T
        whole = (i != j) & (j != k) & (k != i)
        kept = np.ascontiguousarray(triangles[whole])
        return cls(kept, mesh_edges(kept), numbers[whole])

    @property
    def closed(self) -> bool:
        """Whether every edge is used as often in one direction as in the other."""
        return bool(np.all(self.edges.forward == self.edges.backward))

    @property
    def open(self) -> NDArray[np.bool_]:
        """Edges of a single triangle, shape (e,)."""
        return np.asarray(self.edges.forward + self.edges.backward == 1)


def welded(vertices_mm: FloatArray, mesh: Mesh) -> tuple[Mesh, str]:
    """The mesh with seams closed that are open by no more than the tolerance, and a sentence about it.

    Args:
        vertices_mm: shape (n, 3).

    Returns:
        the mesh, as it was where nothing is that close; and what was done, empty for nothing.
    """
    joined, moved, widest = _joined(vertices_mm, mesh)
    divided, count, off = _divided(vertices_mm, joined)
    if count and not divided.closed:
        divided = _without_idle_cuts(joined, divided)
    done = []
    if moved:
        done.append(f"{_vertices(moved)} on open edges welded, at most {round(widest, 5):.2g} mm apart")
    if count:
        done.append(
            f"{'1 edge' if count == 1 else f'{count} edges'} divided at T-vertices, at most {round(off, 5):.2g} mm off"
        )
    return divided, " and ".join(done) + (f" (tolerance {WELD_MM:g} mm)" if done else "")


def _vertices(count: int) -> str:
    return "1 vertex" if count == 1 else f"{count} vertices"


def _joined(vertices_mm: FloatArray, mesh: Mesh) -> tuple[Mesh, int, float]:
    """Vertices on open edges joined where they are close; how many were, and the largest distance."""
    border = np.unique(mesh.edges.ends[mesh.open])
    if len(border) == 0:
        return mesh, 0, 0.0
    points = vertices_mm[border]
    pairs = _tree(points).query_pairs(WELD_MM, output_type="ndarray")
    if len(pairs) == 0:
        return mesh, 0, 0.0
    graph = coo_array((np.ones(len(pairs), dtype=np.int8), (pairs[:, 0], pairs[:, 1])), shape=(len(border),) * 2)
    _, labels = connected_components(graph, directed=False)
    first = np.full(int(labels.max()) + 1, len(vertices_mm), dtype=np.int64)
    np.minimum.at(first, labels, border)
    number = np.arange(len(vertices_mm))
    number[border] = first[labels]
    gaps = np.linalg.norm(points[pairs[:, 0]] - points[pairs[:, 1]], axis=1)
    made = Mesh.of(number[mesh.triangles], mesh.numbers)
    return made, int(np.count_nonzero(number[border] != border)), float(gaps.max())


def _divided(vertices_mm: FloatArray, mesh: Mesh) -> tuple[Mesh, int, float]:
    """Triangles divided where vertices of others lie on their open edges; how many edges were, and how far off.

    An edge is tested once: later rounds add no vertices to open edges.
    """
    count, widest = 0, 0.0
    tested = np.zeros(0, dtype=np.int64)
    for _ in range(_ROUNDS):
        keys = mesh.edges.ends @ (len(vertices_mm), 1)
        wanted = mesh.open & ~np.isin(keys, tested)
        sides = np.flatnonzero(wanted[mesh.edges.sides].ravel())
        if len(sides) == 0:
            break
        done: list[int] = []
        border = np.unique(mesh.edges.ends[mesh.open])
        tree = _tree(vertices_mm[border])
        gone: dict[int, list[list[int]]] = {}
        for triangle, side in zip(*(part.tolist() for part in np.divmod(sides, 3)), strict=True):
            if triangle in gone:
                continue  # its other sides come in the next round
            done.append(keys[mesh.edges.sides[triangle, side]])
            corners = mesh.triangles[triangle].tolist()
            a, b, c = corners[side:] + corners[:side]
            inner, off = _on_edge(vertices_mm, a, b, border, tree)
            if inner:
                chain = [a, *inner, b]
                gone[triangle] = [[p, q, c] for p, q in pairwise(chain)]
                count, widest = count + 1, max(widest, off)
        if not gone:
            break
        mesh = _replaced(mesh, gone)
        tested = np.concatenate((tested, np.array(done, dtype=np.int64)))
    return mesh, count, widest


def _without_idle_cuts(joined: Mesh, divided: Mesh) -> Mesh:
    """The divided mesh with those triangles whole again whose divided edges stay open, to show openings as they are."""
    count = int(joined.triangles.max()) + 1
    before = joined.edges.ends @ (count, 1)
    while True:
        new = divided.open & ~np.isin(divided.edges.ends @ (count, 1), before)
        idle = np.unique(divided.numbers[new[divided.edges.sides].any(axis=1)])
        if len(idle) == 0:
            return divided
        kept, whole = ~np.isin(divided.numbers, idle), np.isin(joined.numbers, idle)
        divided = Mesh.of(
            np.concatenate((divided.triangles[kept], joined.triangles[whole])),
            np.concatenate((divided.numbers[kept], joined.numbers[whole])),
        )


def _on_edge(
    vertices_mm: FloatArray, a: int, b: int, border: NDArray[np.int64], tree: cKDTree
) -> tuple[Sequence[int], float]:
    """Vertices of open edges between the ends of an edge, from one end to the other, and their largest distance."""
    start, along = vertices_mm[a], vertices_mm[b] - vertices_mm[a]
    length = float(np.linalg.norm(along))
    near = border[np.sort(tree.query_ball_point(start + 0.5 * along, 0.5 * length + WELD_MM))]
    if len(near) < 3:
        return [], 0.0
    offset = vertices_mm[near] - start
    at = offset @ along / length
    off = np.linalg.norm(offset - np.outer(at / length, along), axis=1)
    inner = (off <= WELD_MM) & (at > WELD_MM) & (at < length - WELD_MM)
    order = np.argsort(at[inner], kind="stable")
    return near[inner][order].tolist(), float(off[inner].max(initial=0.0))


def _tree(points_mm: FloatArray) -> cKDTree:
    from scipy.spatial import cKDTree  # only for meshes that are open: it takes longer to import than to use

    return cKDTree(points_mm)


def _replaced(mesh: Mesh, gone: dict[int, list[list[int]]]) -> Mesh:
    """The mesh with some triangles replaced by others."""
    kept = np.ones(len(mesh.triangles), dtype=np.bool_)
    kept[list(gone)] = False
    new = np.array([piece for pieces in gone.values() for piece in pieces], dtype=np.int64)
    sources = [mesh.numbers[triangle] for triangle, pieces in gone.items() for _ in pieces]
    return Mesh.of(
        np.concatenate((mesh.triangles[kept], new)),
        np.concatenate((mesh.numbers[kept], np.array(sources, dtype=np.int64))),
    )
