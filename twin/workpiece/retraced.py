"""Chords that have been cut before: a later one that is the same in plan meets only the material below them."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from itertools import pairwise

import numpy as np

from twin.arrays import FloatArray
from twin.motion.chain import Chain
from twin.motion.swept_kernels import BodyShape

#: Decimals of the coordinates, mm, by which chords are looked up; how far they may be off; most chords remembered.
_DECIMALS, _SAME_MM, _MOST = 4, 1e-9, 100_000
_Key = tuple[float, float, float, float]


@dataclass(slots=True)
class Retraced:
    """Remembers the chords of chains that were cut, by the body that cut them.

    A chord that lies below an earlier one, and the same in plan, meets material only between the lower sides of both.
    """

    _passed: dict[BodyShape, dict[_Key, tuple[FloatArray, int]]] = field(default_factory=dict)
    _cuts: int = 0
    _settled: int = 0

    def band_mm(self, chain: Chain) -> float:
        """Height above a chain's lower side up to which there may be material.

        Returns:
            inf where not all of its chords have been cut before; below 0 where all were, as deep.
        """
        passed = self._passed.get(chain.body.shape)
        if passed is None:
            return math.inf
        band = -math.inf
        for row, key in zip(_rows(chain), _keys(chain), strict=True):
            found = passed.get(key)
            if found is None or found[1] > self._settled or np.abs(found[0][:4] - row[:4]).max() > _SAME_MM:
                return math.inf
            earlier = found[0]
            if row[5] > earlier[4] + _SAME_MM:
                return math.inf
            band = max(band, float(earlier[5] - row[4]))
        return band + _SAME_MM if band > _SAME_MM else -1.0

    def add(self, chain: Chain, *, end_is_left: bool) -> None:
        """Remember a chain that was cut; what is left at its end counts as cut when a chain leaves nothing."""
        self._cuts += 1
        if not end_is_left:
            self._settled = self._cuts
        passed = self._passed.setdefault(chain.body.shape, {})
        if len(passed) > _MOST:
            passed.clear()
        passed.update({key: (row, self._cuts) for row, key in zip(_rows(chain), _keys(chain), strict=True)})


def _rows(chain: Chain) -> FloatArray:
    """Start and end of each chord in plan, its lowest and its highest tip; shape (n, 6)."""
    a, b = chain.corners_mm[:-1], chain.corners_mm[1:]
    return np.column_stack((a[:, :2], b[:, :2], np.minimum(a[:, 2], b[:, 2]), np.maximum(a[:, 2], b[:, 2])))


def _keys(chain: Chain) -> list[_Key]:
    plan = np.round(chain.corners_mm[:, :2], _DECIMALS).tolist()
    return [(a[0], a[1], b[0], b[1]) for a, b in pairwise(plan)]
