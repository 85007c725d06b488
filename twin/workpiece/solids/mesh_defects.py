"""Defects of a triangle mesh that is not closed: the kind of each, its size and its position."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from twin.arrays import FloatArray
from twin.workpiece.solids.weld import WELD_MM, Mesh

#: Number of positions, or of triangles, that a message names.
_NAMED = 3
#: An opening narrower than this part of its length is a crack.
_SLENDER = 0.05
#: Points along an edge where the width of an opening is measured, and the most edges of one opening that are measured.
_POINTS, _MOST_EDGES = 9, 300
#: Edges run in opposite directions where the product of their directions is less than this.
_OPPOSITE = -0.95
#: A body is a sheet where its areas add up, as vectors, to more than this part of their sum.
_SHEET = 0.8
#: Most openings that are measured.
_MOST_OPENINGS = 200


def repeated(mesh: Mesh) -> NDArray[np.int64]:
    """Triangles with the corners of an earlier one in the same direction, shape (k, 2), the earlier one first."""
    first = np.argmin(mesh.triangles, axis=1)
    turned = np.take_along_axis(mesh.triangles, (first[:, None] + np.arange(3)) % 3, axis=1)
    _, index, inverse = np.unique(turned, axis=0, return_index=True, return_inverse=True)
    earlier = index[inverse.ravel()]
    later = np.flatnonzero(earlier != np.arange(len(earlier)))
    return np.column_stack((earlier[later], later))


def defects(vertices_mm: FloatArray, mesh: Mesh) -> Iterator[str]:
    """Every kind of defect of a mesh that is not closed, as a phrase each."""
    pairs = repeated(mesh)
    if len(pairs):
        yield _repeated(vertices_mm, mesh, pairs)
        kept = np.ones(len(mesh.triangles), dtype=np.bool_)
        kept[pairs[:, 1]] = False
        mesh = Mesh.of(mesh.triangles[kept], mesh.numbers[kept])
        if mesh.closed:
            return
    uses = mesh.edges.forward + mesh.edges.backward
    if mesh.open.any():
        yield from _openings(vertices_mm, mesh)
    crowded = (uses > 2) & (mesh.edges.forward != mesh.edges.backward)
    if crowded.any():
        ends = mesh.edges.ends[crowded]
        yield (
            f"{count(len(ends), 'edge')} where the surface touches itself, each of {uses[crowded].min()} triangles or "
            f"more: {positions(vertices_mm, ends)}"
        )
    if ((uses == 2) & (mesh.edges.forward != mesh.edges.backward)).any():
        yield _turned(vertices_mm, mesh)


def _repeated(vertices_mm: FloatArray, mesh: Mesh, pairs: NDArray[np.int64]) -> str:
    named = [
        f"{mesh.numbers[b] + 1} repeats {mesh.numbers[a] + 1} at {point(vertices_mm[mesh.triangles[b, 0]])}"
        for a, b in pairs[:_NAMED].tolist()
    ]
    more = ", ..." if len(pairs) > _NAMED else ""
    is_are = "is" if len(pairs) == 1 else "are"
    return f"{count(len(pairs), 'triangle')} {is_are} there twice: number {', number '.join(named)}{more}"


def _turned(vertices_mm: FloatArray, mesh: Mesh) -> str:
    """Triangles whose corners run unlike those of their neighbours."""
    flipped = _flipped(mesh)
    edges = mesh.edges
    ends = edges.ends[(edges.forward + edges.backward == 2) & (edges.forward != edges.backward)]
    numbers = ", ".join(str(mesh.numbers[k] + 1) for k in flipped[:_NAMED].tolist())
    who = "is turned unlike its neighbours" if len(flipped) == 1 else "are turned unlike their neighbours"
    more = ", ..." if len(flipped) > _NAMED else ""
    return (
        f"{count(len(flipped), 'triangle')} {who} (number {numbers}{more}), along {count(len(ends), 'edge')}: "
        f"{positions(vertices_mm, ends)}"
    )


def _flipped(mesh: Mesh) -> NDArray[np.int64]:
    """The smallest patches of triangles that have to be turned for all to agree, as far as that is possible."""
    edges, m = mesh.edges, len(mesh.triangles)
    order = np.argsort(edges.sides.ravel(), kind="stable")
    edge_of = edges.sides.ravel()[order]
    two = np.flatnonzero((edges.forward + edges.backward)[edge_of] == 2)[::2]
    a, b = order[two] // 3, order[two + 1] // 3
    agree = (edges.forward == edges.backward)[edge_of[two]]
    # two copies of each triangle, as is and turned; those that go together are connected
    rows = np.concatenate((a, a + m))
    columns = np.concatenate((np.where(agree, b, b + m), np.where(agree, b + m, b)))
    graph = coo_array((np.ones(len(rows), dtype=np.int8), (rows, columns)), shape=(2 * m, 2 * m))
    _, labels = connected_components(graph, directed=False)
    as_is, turned = labels[:m], labels[m:]
    body = np.minimum(as_is, turned)
    kind = as_is != body
    sizes = np.bincount(body, minlength=2 * m)
    second = np.bincount(body, weights=kind, minlength=2 * m)
    flip_second = 2.0 * second <= sizes
    return np.flatnonzero(kind == flip_second[body])


def _openings(vertices_mm: FloatArray, mesh: Mesh) -> Iterator[str]:
    """Holes, cracks and T-vertices, each kind with its largest."""
    numbers = np.flatnonzero(mesh.open)
    ends = mesh.edges.ends[numbers]
    directed = np.where((mesh.edges.forward[numbers] == 1)[:, None], ends, ends[:, ::-1])
    used, indices = np.unique(directed, return_inverse=True)
    pairs = indices.reshape(-1, 2)
    graph = coo_array((np.ones(len(pairs), dtype=np.int8), (pairs[:, 0], pairs[:, 1])), shape=(len(used),) * 2)
    total, labels = connected_components(graph, directed=False)
    which = labels[pairs[:, 0]]
    flat = _flat_bodies(vertices_mm, mesh)
    middles = vertices_mm[directed].mean(axis=1)
    kinds: dict[str, list[tuple[float, float, NDArray[np.int64]]]] = {}
    for opening in range(min(total, _MOST_OPENINGS)):
        own = directed[which == opening]
        near = _near(middles, vertices_mm[own])
        gap, length = _size(vertices_mm[own], vertices_mm[directed[near[which[near] != opening]]])
        if np.any(np.sort(own[:, 0]) != np.sort(own[:, 1])):
            kind = "loose sheet"
        elif gap <= max(WELD_MM, _SLENDER * length):
            kind = "T-vertex seam" if gap <= WELD_MM else "crack"
        else:
            kind = "loose sheet" if flat[own[0, 0]] else "hole"
        kinds.setdefault(kind, []).append((gap, length, own))
    part = f" among the first {_MOST_OPENINGS} of {total} openings" if total > _MOST_OPENINGS else ""
    for kind, found in kinds.items():
        gap, length, own = max(found, key=lambda one: one[0])
        size = f"{gap:.4g} mm wide"
        if kind not in ("hole", "loose sheet"):
            size = f"{gap:.2g} mm wide and {length:.4g} mm long"
        which_one = "" if len(found) == 1 else "the widest "
        edges = count(sum(len(one) for _, _, one in found), "open edge")
        yield f"{count(len(found), kind)} of {edges}{part}, {which_one}{size}: {positions(vertices_mm, own)}"


def _flat_bodies(vertices_mm: FloatArray, mesh: Mesh) -> NDArray[np.bool_]:
    """Vertices of bodies that are a sheet: their areas point in one direction, shape (n,)."""
    a, b, c = (vertices_mm[mesh.triangles[:, i]] for i in range(3))
    areas = np.cross(b - a, c - a)
    body_of = bodies(len(vertices_mm), mesh.triangles)
    sums = np.column_stack([np.bincount(body_of, weights=areas[:, i]) for i in range(3)])
    sheet = np.linalg.norm(sums, axis=1) > _SHEET * np.bincount(body_of, weights=np.linalg.norm(areas, axis=1))
    flat = np.zeros(len(vertices_mm), dtype=np.bool_)
    flat[mesh.triangles] = sheet[body_of][:, None]
    return flat


def _size(ends_mm: FloatArray, others_mm: FloatArray) -> tuple[float, float]:
    """Width and length of an opening.

    The width is measured between edges that run in opposite directions, as the two sides of an opening do. That of a
    hole is no more than four areas over the circumference, the diameter of a round one.

    Args:
        ends_mm: shape (k, 2, 3), its edges, each in the direction of its triangle.
        others_mm: shape (m, 2, 3), the edges of other openings near it: two parts that miss each other have one each.
    """
    starts, along = ends_mm[:, 0], ends_mm[:, 1] - ends_mm[:, 0]
    lengths = np.maximum(np.linalg.norm(along, axis=1), 1e-300)
    circumference = float(lengths.sum())
    middle = starts.mean(axis=0)
    area = 0.5 * float(np.linalg.norm(np.cross(starts - middle, ends_mm[:, 1] - middle).sum(axis=0)))
    most = 4.0 * area / circumference
    long = np.flatnonzero(lengths >= most)
    chosen = long if len(long) else np.arange(len(lengths))
    chosen = chosen[:: max(1, len(chosen) // _MOST_EDGES)]
    widest = _widest(ends_mm, chosen, np.concatenate((ends_mm, others_mm[:_MOST_EDGES])))
    length = 0.5 * circumference
    if widest == 0.0 or (most > _SLENDER * length and most < widest):
        return most, length
    return widest, length


def _near(points_mm: FloatArray, ends_mm: FloatArray) -> NDArray[np.int64]:
    """Numbers of the points in the box of edges, with a margin as wide as a crack along them may be."""
    margin = _SLENDER * 0.5 * float(np.linalg.norm(ends_mm[:, 1] - ends_mm[:, 0], axis=1).sum())
    low, high = ends_mm.min(axis=(0, 1)) - margin, ends_mm.max(axis=(0, 1)) + margin
    return np.flatnonzero(np.all((points_mm >= low) & (points_mm <= high), axis=1))


def _widest(ends_mm: FloatArray, chosen: NDArray[np.int64], sides_mm: FloatArray) -> float:
    """Largest distance of some edges from those that run in the opposite direction, 0 for none."""
    starts, along = sides_mm[:, 0], sides_mm[:, 1] - sides_mm[:, 0]
    lengths = np.maximum(np.linalg.norm(along, axis=1), 1e-300)
    share = np.linspace(0.0, 1.0, _POINTS)[:, None]
    unit = along / lengths[:, None]
    widest = 0.0
    for k in chosen.tolist():
        opposite = np.flatnonzero(unit @ unit[k] < _OPPOSITE)
        if len(opposite) == 0:
            continue
        points = ends_mm[k, 0] + share * along[k]
        offset = points[:, None, :] - starts[opposite]
        at = np.clip(np.einsum("pek,ek->pe", offset, unit[opposite]), 0.0, lengths[opposite])
        distance = np.linalg.norm(offset - at[..., None] * unit[opposite], axis=2)
        widest = max(widest, float(distance.min(axis=1).max()))
    return widest


def bodies(count: int, triangles: NDArray[np.int64]) -> NDArray[np.int64]:
    """The number of the connected body that each triangle belongs to."""
    rows = np.concatenate((triangles[:, 0], triangles[:, 1]))
    columns = np.concatenate((triangles[:, 1], triangles[:, 2]))
    graph = coo_array((np.ones(len(rows), dtype=np.int8), (rows, columns)), shape=(count, count))
    _, labels = connected_components(graph, directed=False)
    _, body_of = np.unique(labels[triangles[:, 0]], return_inverse=True)
    return body_of.astype(np.int64)


def positions(vertices_mm: FloatArray, ends: NDArray[np.int64]) -> str:
    """The first edges of some, by their ends."""
    named = [f"{point(vertices_mm[a])} to {point(vertices_mm[b])}" for a, b in ends[:_NAMED]]
    return ", ".join(named) + (", ..." if len(ends) > _NAMED else "")


def point(p: FloatArray) -> str:
    """A point as text."""
    return "(" + ", ".join(f"{x:.6g}" for x in p) + ")"


def count(n: int, noun: str) -> str:
    """A number of things."""
    return f"{n} {noun}" + ("" if n == 1 else "s")
