"""Nodes of a lattice in material and its crossed edges, from lines through slices; compiled.

Lattice arrays are flat: node (i, j, k) of a lattice of (nx, ny, nz) nodes is number (i ny + j) nz + k. A lattice edge
is named by its axis and its lower node. Crossed edges are numbered.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from twin.arrays import FloatArray
from twin.geometry.polygons.line_kernels import LineEnds
from twin.jit import njit


class NodeRows(NamedTuple):
    """Rows of nodes that lines run along.

    Attributes:
        bases: shape (n,), number of each line's first node.
        stride: from the number of a node to that of the next one on its line.
        nodes: positions of the nodes along the lines, increasing, mm.
    """

    bases: NDArray[np.int64]
    stride: int
    nodes: FloatArray


@njit
def vote(lines: LineEnds, rows: NodeRows, votes: NDArray[np.uint8]) -> None:
    """Add one vote to every node of some lines that lies in material.

    Args:
        lines: material on each line.
    """
    offsets, ends, _ = lines
    bases, stride, nodes = rows
    for i in range(len(bases)):
        n = 0
        for e in range(offsets[i], offsets[i + 1], 2):
            while n < len(nodes) and nodes[n] < ends[e]:
                n += 1
            while n < len(nodes) and nodes[n] < ends[e + 1]:
                votes[bases[i] + n * stride] += 1
                n += 1


@njit
def number_edges(
    inside: NDArray[np.bool_], shape: tuple[int, int, int], numbers: NDArray[np.int32], axes: NDArray[np.int8]
) -> int:
    """Number the edges with one end inside.

    Args:
        numbers: shape (3, nodes), filled, -1 for edges that are not crossed.
        axes: shape (3 nodes,), filled for every number: axis + 1, negative where material is at the upper end.
    """
    nx, ny, nz = shape
    count = 0
    for i in range(nx):
        for j in range(ny):
            for k in range(nz):
                node = (i * ny + j) * nz + k
                for d in range(3):
                    numbers[d, node] = -1
                    if (d == 0 and i + 1 == nx) or (d == 1 and j + 1 == ny) or (d == 2 and k + 1 == nz):
                        continue
                    step = ny * nz if d == 0 else (nz if d == 1 else 1)
                    if inside[node] != inside[node + step]:
                        numbers[d, node] = count
                        axes[count] = d + 1 if inside[node] else -d - 1
                        count += 1
    return count


@njit
def measure(
    lines: LineEnds,
    rows: NodeRows,
    slack: float,
    inside: NDArray[np.bool_],
    numbers: NDArray[np.int32],
    column: int,
    positions: FloatArray,
    leans: FloatArray,
) -> None:
    """Find the crossing of every numbered edge on some lines: the outermost one of the right sense.

    Args:
        lines: material on each line.
        slack: a crossing this much beyond an edge's end still counts, and is moved to the end, mm.
        numbers: shape (nodes,), of edges along the lines.
        column: of ``leans`` that the slopes go to.
        positions: shape (edges,), NaN until found.
        leans: shape (edges, 2), NaN until found.
    """
    offsets, ends, slopes = lines
    bases, stride, nodes = rows
    for i in range(len(bases)):
        first, last = offsets[i], offsets[i + 1]
        e = first
        for n in range(len(nodes) - 1):
            node = bases[i] + n * stride
            number = numbers[node]
            if number < 0:
                continue
            low, high = nodes[n] - slack, nodes[n + 1] + slack
            while e < last and ends[e] < low:
                e += 1
            leaves = inside[node]
            found = -1
            m = e
            while m < last and ends[m] <= high:
                if ((m - first) % 2 == 1) == leaves and (leaves or found < 0):
                    found = m
                m += 1
            if found >= 0:
                leans[number, column] = slopes[found]
                if math.isnan(positions[number]):
                    positions[number] = min(max(ends[found], nodes[n]), nodes[n + 1])
