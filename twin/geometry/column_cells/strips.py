"""Sections of a convex body by consecutive parallel planes, each a strip lo(u) <= v <= hi(u)."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from twin.arrays import FloatArray


class Tops(NamedTuple):
    """Heights of the material in columns of consecutive vertical planes.

    Attributes:
        heights: shape (planes, columns), v of the highest material; -inf without any. Beyond them there is none.
        u_low, size: where the first column begins, and the width of each, mm.
    """

    heights: FloatArray
    u_low: float
    size: float


#: Heights that are not known.
NO_TOPS = Tops(np.empty((0, 0)), 0.0, 1.0)


class Strips(NamedTuple):
    """One strip per plane; a plane that the body misses has no nodes.

    Attributes:
        first: index of the first plane.
        offsets: shape (planes + 1,), first node of each plane.
        nodes: shape (n, 3): u increasing on each plane, lo (convex in u), hi (concave in u), lo <= hi.
        fresh: shape (n,), False where the strip holds no material, because it has been cut already; between two such
            nodes nothing is cut.
    """

    first: int
    offsets: NDArray[np.int64]
    nodes: FloatArray
    fresh: NDArray[np.bool_]

    @property
    def planes(self) -> int:
        """Number of planes, those without nodes included."""
        return len(self.offsets) - 1

    def outline(self, i: int) -> FloatArray | None:
        """Polygon of the strip on plane ``first + i``, counter-clockwise, shape (n, 2), or None where there is none."""
        nodes = self.nodes[self.offsets[i] : self.offsets[i + 1]]
        if len(nodes) < 2:
            return None
        lower, upper = nodes[:, [0, 1]], nodes[::-1][:, [0, 2]]
        return np.concatenate((lower, upper))
