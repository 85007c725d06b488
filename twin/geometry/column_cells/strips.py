"""Sections of bodies by parallel planes, as strips lo(u) <= v <= hi(u)."""

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


class Bins(NamedTuple):
    """Material on consecutive planes, in bins along u; beyond them there is none.

    Attributes:
        heights: shape (planes, bins): v of the highest material, -inf without any, inf where it is not known.
        u_low, size: where the first bin begins, and their width, mm.
    """

    heights: FloatArray
    u_low: float
    size: float


class HeightMap(NamedTuple):
    """Heights of the material of consecutive vertical planes, in bins along them; beyond them there is none.

    Attributes:
        heights: shape (planes, bins); see `Bins`.
        w_low, u_low: where the space nearest to the first plane, and the first bin, begin, mm.
        per_w, per_u: planes and bins in a millimetre.
    """

    heights: FloatArray
    w_low: float
    u_low: float
    per_w: float
    per_u: float


#: Heights that are not known.
NO_TOPS = Tops(np.empty((0, 0)), 0.0, 1.0)


class Strips(NamedTuple):
    """Strips of planes, of which several may lie on one plane; those of lower planes come first.

    Attributes:
        at: shape (strips,), index of each strip's plane.
        offsets: shape (strips + 1,), first node of each strip; one that the body misses has none.
        nodes: shape (n, 3): u increasing in each strip, lo, hi, lo <= hi.
        fresh: shape (n,), False where the strip holds no material, because it has been cut already; between two such
            nodes nothing is cut.
    """

    at: NDArray[np.int64]
    offsets: NDArray[np.int64]
    nodes: FloatArray
    fresh: NDArray[np.bool_]

    def outline(self, i: int) -> FloatArray | None:
        """Polygon of a strip by its number, counter-clockwise, shape (n, 2), or None where there is none."""
        nodes = self.nodes[self.offsets[i] : self.offsets[i + 1]]
        if len(nodes) < 2:
            return None
        lower, upper = nodes[:, [0, 1]], nodes[::-1][:, [0, 2]]
        return np.concatenate((lower, upper))
