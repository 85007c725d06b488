"""Closest points on triangles by a tree of boxes; compiled.

The tree is complete: node i has the children 2 i + 1 and 2 i + 2, the last level's nodes are leaves of a few
consecutive triangles. Closest points: Ericson, Real-Time Collision Detection, 2005, section 5.1.5.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from twin.arrays import FloatArray
from twin.jit import helper, njit

#: Features of a triangle: its face, its edges AB, BC, CA, its corners A, B, C.
_FACE, _AB, _BC, _CA, _A, _B, _C = 0, 1, 2, 3, 4, 5, 6
#: Nodes that wait at most; twice the depth of any tree.
_STACK = 96


class Tree(NamedTuple):
    """Triangles in a tree of boxes.

    Attributes:
        corners: shape (m, 9), in the order of the leaves.
        leaf: triangles of a leaf.
        levels: levels above the leaves.
        boxes: shape (2 ** (levels + 1) - 1, 6): low corner, high corner; empty leaves have low above high.
    """

    corners: FloatArray
    leaf: int
    levels: int
    boxes: FloatArray


class Closest(NamedTuple):
    """Closest points.

    Attributes:
        points: shape (n, 3).
        triangles: shape (n,), index of the triangle among the leaves.
        features: shape (n,), feature of it: 0 face, 1 to 3 edges AB, BC, CA, 4 to 6 corners A, B, C.
    """

    points: FloatArray
    triangles: NDArray[np.int64]
    features: NDArray[np.int8]


@njit
def fill_boxes(tree: Tree) -> None:
    """Fill the boxes of a tree, from the leaves up."""
    corners, leaf, levels, boxes = tree
    first = 2**levels - 1
    for i in range(2**levels):
        node = first + i
        for a in range(3):
            boxes[node, a] = math.inf
            boxes[node, 3 + a] = -math.inf
        for t in range(i * leaf, min((i + 1) * leaf, len(corners))):
            for c in range(9):
                a = c % 3
                boxes[node, a] = min(boxes[node, a], corners[t, c])
                boxes[node, 3 + a] = max(boxes[node, 3 + a], corners[t, c])
    for node in range(first - 1, -1, -1):
        for a in range(3):
            boxes[node, a] = min(boxes[2 * node + 1, a], boxes[2 * node + 2, a])
            boxes[node, 3 + a] = max(boxes[2 * node + 1, 3 + a], boxes[2 * node + 2, 3 + a])


@helper
def _box_distance2(boxes: FloatArray, node: int, x: float, y: float, z: float) -> float:
    if boxes[node, 0] > boxes[node, 3]:
        return math.inf
    dx = max(boxes[node, 0] - x, 0.0, x - boxes[node, 3])
    dy = max(boxes[node, 1] - y, 0.0, y - boxes[node, 4])
    dz = max(boxes[node, 2] - z, 0.0, z - boxes[node, 5])
    return dx * dx + dy * dy + dz * dz


@helper
def _on_triangle(corners: FloatArray, t: int, x: float, y: float, z: float, found: FloatArray) -> int:
    """The closest point of a triangle; fills ``found`` with it and its squared distance, gives the feature it is on."""
    ax, ay, az = corners[t, 0], corners[t, 1], corners[t, 2]
    abx, aby, abz = corners[t, 3] - ax, corners[t, 4] - ay, corners[t, 5] - az
    acx, acy, acz = corners[t, 6] - ax, corners[t, 7] - ay, corners[t, 8] - az
    apx, apy, apz = x - ax, y - ay, z - az
    d1 = abx * apx + aby * apy + abz * apz
    d2 = acx * apx + acy * apy + acz * apz
    bpx, bpy, bpz = apx - abx, apy - aby, apz - abz
    d3 = abx * bpx + aby * bpy + abz * bpz
    d4 = acx * bpx + acy * bpy + acz * bpz
    cpx, cpy, cpz = apx - acx, apy - acy, apz - acz
    d5 = abx * cpx + aby * cpy + abz * cpz
    d6 = acx * cpx + acy * cpy + acz * cpz
    v = w = 0.0
    vc = d1 * d4 - d3 * d2
    vb = d5 * d2 - d1 * d6
    va = d3 * d6 - d5 * d4
    feature = _FACE
    if d1 <= 0.0 and d2 <= 0.0:
        feature = _A
    elif d3 >= 0.0 and d4 <= d3:
        v = 1.0
        feature = _B
    elif d6 >= 0.0 and d5 <= d6:
        w = 1.0
        feature = _C
    elif vc <= 0.0 and d1 >= 0.0 and d3 <= 0.0:
        v = d1 / (d1 - d3)
        feature = _AB
    elif vb <= 0.0 and d2 >= 0.0 and d6 <= 0.0:
        w = d2 / (d2 - d6)
        feature = _CA
    elif va <= 0.0 and d4 - d3 >= 0.0 and d5 - d6 >= 0.0:
        w = (d4 - d3) / ((d4 - d3) + (d5 - d6))
        v = 1.0 - w
        feature = _BC
    else:
        total = va + vb + vc
        v = vb / total
        w = vc / total
    found[0] = ax + v * abx + w * acx
    found[1] = ay + v * aby + w * acy
    found[2] = az + v * abz + w * acz
    found[3] = (found[0] - x) ** 2 + (found[1] - y) ** 2 + (found[2] - z) ** 2
    return feature


@njit
def closest(points: FloatArray, first: int, last: int, tree: Tree, found: Closest) -> None:
    """The closest points on the triangles of some points; each search begins with the triangle found before.

    Args:
        points: shape (n, 3); those from ``first`` to ``last`` - 1 are looked up.
        found: filled for these.
    """
    corners, leaf, levels, boxes = tree
    nearest, triangles, features = found
    stack = np.empty(_STACK, dtype=np.int64)
    bounds = np.empty(_STACK)
    hit = np.empty(4)
    leaves = 2**levels - 1
    guess = 0
    for i in range(first, last):
        x, y, z = points[i, 0], points[i, 1], points[i, 2]
        features[i] = _on_triangle(corners, guess, x, y, z, hit)
        best = hit[3]
        nearest[i, 0], nearest[i, 1], nearest[i, 2] = hit[0], hit[1], hit[2]
        triangles[i] = guess
        stack[0] = 0
        bounds[0] = _box_distance2(boxes, 0, x, y, z)
        size = 1
        while size:
            size -= 1
            node = stack[size]
            if bounds[size] >= best:
                continue
            if node >= leaves:
                begin = (node - leaves) * leaf
                for t in range(begin, min(begin + leaf, len(corners))):
                    feature = _on_triangle(corners, t, x, y, z, hit)
                    if hit[3] < best:
                        best = hit[3]
                        nearest[i, 0], nearest[i, 1], nearest[i, 2] = hit[0], hit[1], hit[2]
                        triangles[i] = t
                        features[i] = feature
                continue
            left, right = 2 * node + 1, 2 * node + 2
            near_left = _box_distance2(boxes, left, x, y, z)
            near_right = _box_distance2(boxes, right, x, y, z)
            if near_left > near_right:
                left, right = right, left
                near_left, near_right = near_right, near_left
            if near_right < best:
                stack[size] = right
                bounds[size] = near_right
                size += 1
            if near_left < best:
                stack[size] = left
                bounds[size] = near_left
                size += 1
        guess = triangles[i]
