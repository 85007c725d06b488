"""The surface inside one block of the lattice, from lines through the slices."""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass
from functools import cache
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from twin.arrays import FloatArray
from twin.geometry.polygons.lines import LineEnds
from twin.workpiece import dual_contouring_kernels as contour_kernels
from twin.workpiece import lattice_kernels
from twin.workpiece.cell_cases import OTHER_AXES, sheet_table
from twin.workpiece.lattice import Patch, PatchGrid
from twin.workpiece.store import PLANE_AXES, SliceStore

#: Normals within this angle of their mean make a smooth surface.
SMOOTH_RAD = math.radians(8.0)
#: Relative eigenvalue of the tangent planes' least squares from which a direction counts: normals 35 degrees apart.
SHARP = 0.1
#: Part of a cell that vertices keep from its faces, and by which a crossing may miss its edge.
MARGIN = 1e-3
#: A node is in material when it is on at least this many of the six lines through it.
ENOUGH_VOTES = 3


@dataclass(frozen=True, slots=True, eq=False)
class SurfacePart:
    """The surface in one block: vertices of its cells and of the cells before it, triangles of its own edges.

    Attributes:
        creased: whether the surface has an edge or a corner at a vertex.
        names: cell and sheet of each vertex in the whole lattice, one number.
        leading: normal of the crossing that each triangle belongs to.
    """

    vertices: FloatArray
    normals: FloatArray
    creased: NDArray[np.bool_]
    names: NDArray[np.int64]
    triangles: NDArray[np.int32]
    leading: FloatArray


class _Lines(NamedTuple):
    """Lines along an axis, and the nodes on them."""

    direction: int
    column: int
    rows: lattice_kernels.NodeRows
    ends: LineEnds


@cache
def _sheets() -> NDArray[np.int8]:
    return sheet_table()


@dataclass(frozen=True, slots=True, eq=False)
class _Block:
    """Nodes of the lattice that one block needs: from one cell before it to its end."""

    store: SliceStore
    nodes: tuple[FloatArray, FloatArray, FloatArray]
    planes: tuple[NDArray[np.int64], NDArray[np.int64], NDArray[np.int64]]

    @property
    def shape(self) -> tuple[int, int, int]:
        return len(self.nodes[0]), len(self.nodes[1]), len(self.nodes[2])

    def lines(self, direction: int, column: int) -> _Lines:
        """All lines along an axis in one of the two families of slices that contain them.

        Args:
            column: 0 or 1: the family whose slopes are along the first or the second other axis.
        """
        across = OTHER_AXES[direction][column]
        axis = OTHER_AXES[direction][1 - column]
        strides = self.shape[1] * self.shape[2], self.shape[2], 1
        rows, slices = (np.flatnonzero(self.planes[a] >= 0) for a in (across, axis))
        ends = self.store.line_ends(
            axis,
            self.planes[axis][slices],
            PLANE_AXES[axis].index(across),
            self.nodes[across][rows],
            (float(self.nodes[direction][0]), float(self.nodes[direction][-1])),
        )
        bases = (slices[:, None] * strides[axis] + rows * strides[across]).ravel()
        rows_of = lattice_kernels.NodeRows(bases, strides[direction], self.nodes[direction])
        return _Lines(direction, column, rows_of, ends)


def draw_part(store: SliceStore, grid: PatchGrid, patch: Patch) -> SurfacePart:
    """Draw one block."""
    (x0, x1), (y0, y1) = grid.cells(patch)
    start = max(0, x0 - 1), max(0, y0 - 1)
    ranges = slice(start[0], x1 + 1), slice(start[1], y1 + 1), slice(None)
    x, y, z = (n[r] for n, r in zip(grid.lattice.nodes_mm, ranges, strict=True))
    px, py, pz = (p[r] for p, r in zip(grid.lattice.planes, ranges, strict=True))
    block = _Block(store, (x, y, z), (px, py, pz))
    found = [block.lines(d, column) for d in range(3) for column in range(2)]
    inside = _inside(block, found)
    numbers = np.empty((3, len(inside)), dtype=np.int32)
    axes = np.empty(3 * len(inside), dtype=np.int8)
    axes = axes[: lattice_kernels.number_edges(inside, block.shape, numbers, axes)]
    points, normals = _crossings(block, found, inside, numbers, axes)
    own = x0 - start[0], y0 - start[1]
    return _contour(block, grid.lattice.shape, start, own, inside, numbers, axes, points, normals)


def _inside(block: _Block, found: Iterable[_Lines]) -> NDArray[np.bool_]:
    """Whether each node is in material, by the vote of all lines through it."""
    votes = np.zeros(math.prod(block.shape), dtype=np.uint8)
    for lines in found:
        lattice_kernels.vote(lines.ends, lines.rows, votes)
    inside: NDArray[np.bool_] = votes >= ENOUGH_VOTES
    return inside


def _crossings(
    block: _Block,
    found: Iterable[_Lines],
    inside: NDArray[np.bool_],
    numbers: NDArray[np.int32],
    axes: NDArray[np.int8],
) -> tuple[FloatArray, FloatArray]:
    """Points and outward unit normals of the crossed edges; without a crossing, the middle and no normal."""
    positions, leans = np.full(len(axes), np.nan), np.full((len(axes), 2), np.nan)
    for d, column, rows, ends in found:
        slack = MARGIN * float(np.diff(rows.nodes).max())
        lattice_kernels.measure(ends, rows, slack, inside, numbers[d], column, positions, leans)
    points, normals = np.empty((len(axes), 3)), np.zeros((len(axes), 3))
    for d in range(3):
        nodes = np.flatnonzero(numbers[d] >= 0)
        mine = numbers[d][nodes]
        at = np.unravel_index(nodes, block.shape)
        for axis in range(3):
            points[mine, axis] = block.nodes[axis][at[axis]]
        middle = 0.5 * (points[mine, d] + block.nodes[d][at[d] + 1])
        points[mine, d] = np.where(np.isnan(positions[mine]), middle, positions[mine])
        sense = np.sign(axes[mine]) * ~np.isnan(positions[mine])
        normals[mine, d] = sense
        for column, across in enumerate(OTHER_AXES[d]):
            normals[mine, across] = -sense * np.nan_to_num(leans[mine, column])
    length = np.linalg.norm(normals, axis=1, keepdims=True)
    return points, normals / np.where(length > 0.0, length, 1.0)


def _contour(
    block: _Block,
    whole: tuple[int, int, int],
    start: tuple[int, int],
    own: tuple[int, int],
    inside: NDArray[np.bool_],
    numbers: NDArray[np.int32],
    axes: NDArray[np.int8],
    points: FloatArray,
    normals: FloatArray,
) -> SurfacePart:
    """Vertices and triangles from the crossings of a block."""
    room = 4 * len(axes) // 3 + 1  # a sheet has at least three crossings, a crossing lies in at most four cells
    first, cases = np.empty(len(inside), dtype=np.int32), np.empty(len(inside), dtype=np.uint8)
    vertices, vertex_normals = np.empty((room, 3)), np.empty((room, 3))
    creased, cells = np.empty(room, dtype=np.bool_), np.empty(room, dtype=np.int64)
    limits = contour_kernels.Limits(math.cos(SMOOTH_RAD), (math.tan(SMOOTH_RAD) ** 2, SHARP), MARGIN)
    n = contour_kernels.place_vertices(
        contour_kernels.Nodes(inside, *block.nodes),
        contour_kernels.Crossings(numbers, points, normals),
        _sheets(),
        limits,
        contour_kernels.Vertices(first, cases, vertices, vertex_normals, creased, cells),
    )
    quads = np.empty((len(axes), 5), dtype=np.int32)
    quads = quads[: contour_kernels.join_quads(block.shape, own, numbers, axes, _sheets(), first, cases, quads)]
    triangles = np.empty((2 * len(quads), 3), dtype=np.int32)
    contour_kernels.split_quads(quads, vertices, creased, triangles)
    used, corners = in_use(triangles, n)
    i, j, k = np.unravel_index(cells[:n] // 4, block.shape)
    names = 4 * np.ravel_multi_index((i + start[0], j + start[1], k), whole) + cells[:n] % 4
    return SurfacePart(
        vertices=vertices[used],
        normals=vertex_normals[used],
        creased=creased[used],
        names=names[used],
        triangles=corners.astype(np.int32),
        leading=np.repeat(normals[quads[:, 4]], 2, axis=0),
    )


def in_use(triangles: NDArray[np.integer[Any]], count: int) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """The vertices that triangles use, out of ``count``, in order, and the triangles with the numbers of these."""
    used = np.zeros(count, dtype=np.bool_)
    used[triangles] = True
    return np.flatnonzero(used), (np.cumsum(used) - 1)[triangles]
