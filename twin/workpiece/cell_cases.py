"""The 256 cases of corners of a cube inside or outside, as tables.

Corner ``c`` lies at (c & 1, c >> 1 & 1, c >> 2 & 1). Edge ``4 d + b`` runs along axis d; bits 0 and 1 of ``b`` are its
position along the two other axes, in ascending order. The surface in a cube is one or more sheets: every face of it
links the crossed edges on its rim two by two, and where all four are crossed the links go round the inside corners.
Neighbouring cubes thus agree on every face, and a surface with one vertex per sheet is closed.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

#: The two other axes of each axis, ascending.
OTHER_AXES: tuple[tuple[int, int], ...] = ((1, 2), (0, 2), (0, 1))


def edge_corners() -> NDArray[np.int64]:
    """The two corners of each edge, shape (12, 2), lower one first."""
    corners = np.empty((12, 2), dtype=np.int64)
    for d, (p, q) in enumerate(OTHER_AXES):
        for b in range(4):
            low = (b & 1) << p | (b >> 1) << q
            corners[4 * d + b] = low, low | 1 << d
    return corners


def sheet_table() -> NDArray[np.int8]:
    """The sheet that each edge belongs to, shape (256, 12), numbered from 0; -1 where an edge is not crossed.

    Row ``s`` is for the cube whose corner c is inside where bit c of s is set.
    """
    corners = edge_corners()
    between = {frozenset(pair): e for e, pair in enumerate(corners.tolist())}
    table = np.full((256, 12), -1, dtype=np.int8)
    for case in range(256):
        inside = [bool(case >> c & 1) for c in range(8)]
        sheet = {e: e for e, (a, b) in enumerate(corners.tolist()) if inside[a] != inside[b]}
        for rim in _faces():
            for e, f in _links(rim, inside, between):
                kept, dropped = sheet[e], sheet[f]
                sheet = {g: kept if s == dropped else s for g, s in sheet.items()}
        for number, name in enumerate(sorted(set(sheet.values()))):
            for e, s in sheet.items():
                if s == name:
                    table[case, e] = number
    return table


def _faces() -> list[list[int]]:
    """The corners of each face in order round it."""
    faces = []
    for d, (p, q) in enumerate(OTHER_AXES):
        rim = [0, 1 << p, 1 << p | 1 << q, 1 << q]
        faces += [rim, [1 << d | corner for corner in rim]]
    return faces


def _links(rim: list[int], inside: list[bool], between: dict[frozenset[int], int]) -> list[tuple[int, int]]:
    """Pairs of crossed edges that the surface joins across a face."""
    edges = [between[frozenset((rim[i], rim[(i + 1) % 4]))] for i in range(4)]
    crossed = [inside[rim[i]] != inside[rim[(i + 1) % 4]] for i in range(4)]
    if all(crossed):
        return [(edges[i - 1], edges[i]) for i in range(4) if inside[rim[i]]]
    pair = [e for e, c in zip(edges, crossed, strict=True) if c]
    return [(pair[0], pair[1])] if pair else []
