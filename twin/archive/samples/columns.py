"""Columns of integers as bytes that compress well: differences, zigzag, and their bytes in planes.

Neighbouring samples differ little, so differences are small numbers. Zigzag makes small unsigned numbers of them
(0, -1, 1, -2 become 0, 1, 2, 3), whose upper bytes are zero. All lowest bytes come first, then the next ones, up to the
last byte that any of the numbers needs.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Column = NDArray[np.int64]


def pack(values: Column, order: int) -> bytes:
    """The bytes of a column: for each of its numbers as many as the largest one needs, at least one.

    Args:
        values: shape (n,).
        order: how often the differences of neighbours are taken, the first number's from 0; overflow wraps around.
    """
    if not len(values):
        return b""
    for _ in range(order):
        values = np.diff(values, prepend=np.int64(0))
    zigzag = ((values << 1) ^ (values >> 63)).astype("<i8").view(np.uint64)
    width = max(1, (int(zigzag.max()).bit_length() + 7) // 8)
    return zigzag.view(np.uint8).reshape(-1, 8)[:, :width].T.tobytes()


def unpack(data: bytes, count: int, order: int) -> Column:
    """The numbers of a column, shape (count,).

    Args:
        data: what `pack` made of them.
        order: as for `pack`.

    Raises:
        ValueError: the bytes are not those of a column of this length.
    """
    width, rest = divmod(len(data), max(count, 1))
    if rest or width > 8 or (count > 0) != (width > 0):
        raise ValueError(f"a column of {count} numbers in {len(data)} bytes")
    planes = np.zeros((count, 8), np.uint8)
    planes[:, :width] = np.frombuffer(data, np.uint8).reshape(width, count).T
    zigzag = planes.view("<u8")[:, 0]
    values = (zigzag >> np.uint64(1)).astype(np.int64) ^ -(zigzag & np.uint64(1)).astype(np.int64)
    for _ in range(order):
        values = np.cumsum(values)
    return values
