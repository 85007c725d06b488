"""The finest slice pitch that fits in memory."""

from __future__ import annotations

import math
from collections.abc import Sequence

#: More planes than this in one family are taken for a mistake in the pitch.
MOST_PLANES = 1_000_000
#: Most columns of cells of all planes together, and the pitches that a cell measures.
_MOST_COLUMNS, _CELL_PITCHES = 100_000_000, 5


def least_pitch_mm(extent_mm: Sequence[float]) -> float:
    """The finest pitch for a stock.

    A plane has one table entry for each column of its cells: those across x have columns along y, the others along x.

    Args:
        extent_mm: the box of the stock along x, y and z.
    """
    x, y, z = (float(e) for e in extent_mm)
    return max(max(x, y, z) / MOST_PLANES, math.sqrt((2.0 * x * y + x * z) / _CELL_PITCHES / _MOST_COLUMNS))
