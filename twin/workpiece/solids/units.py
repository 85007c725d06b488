"""Units of STL files, which do not state theirs: how long a unit is, a guess where it is not known, and doubts."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import TYPE_CHECKING, Literal, TypeAlias, get_args

from twin.errors import MeshError

if TYPE_CHECKING:
    from twin.arrays import FloatArray

Unit: TypeAlias = Literal["mm", "inch", "m", "auto"]

#: Length of a unit, mm.
UNITS_MM: dict[str, float] = {"mm": 1.0, "inch": 25.4, "m": 1000.0}
#: A typical part is this many tool diameters long.
TOOL_DIAMETERS = 12.0
#: A typical part where neither tool nor stock is known, mm.
TYPICAL_MM = 100.0
#: No machining centre takes a part longer than this, mm.
LARGEST_MM = 10_000.0
#: A design and its stock differ in length by less than this factor.
_UNLIKE = 10.0


def unit_of(name: str, unit: str, corners: FloatArray, like_mm: float) -> tuple[str, tuple[str, ...]]:
    """The unit of a file, and notes where it is a guess.

    Args:
        name: of the file, for messages.
        unit: a unit, or ``auto`` for the one in which the part's longest side is most like ``like_mm``.
        corners: of the file's triangles in its unit, shape (m, 3, 3).
        like_mm: length that the part's longest side should be comparable with.

    Raises:
        MeshError: an unknown unit.
    """
    if unit not in get_args(Unit):
        raise MeshError(f"{name}: unit {unit!r}; expected one of {', '.join(get_args(Unit))}")
    if unit != "auto":
        return unit, ()
    import numpy as np  # the unit is an option of commands, whose help needs no arrays

    sides = np.ptp(corners.reshape(-1, 3), axis=0)
    longest = float(sides.max()) if np.isfinite(sides).all() else 0.0
    if longest <= 0.0:
        return "mm", ()
    guess = min(UNITS_MM, key=lambda u: abs(math.log(longest * UNITS_MM[u] / like_mm)))
    size = " x ".join(f"{side * UNITS_MM[guess]:.4g}" for side in sides)
    return guess, (f"{name}: unit auto: taken to be in {guess}, so the part is {size} mm",)


def size_doubts(
    name: str, box_mm: FloatArray, *, tool_mm: float | None = None, stock_mm: float | None = None
) -> Iterator[str]:
    """Doubts about the unit of a part: smaller than the tool, larger than any machine, or unlike its stock.

    Args:
        name: of the file.
        box_mm: the part's box, shape (2, 3).
        tool_mm: diameter of the smallest tool, None where there is none.
        stock_mm: longest side of the stock, None where it does not matter.
    """
    longest = float((box_mm[1] - box_mm[0]).max())
    others = ", ".join(f"{longest * f:.4g} mm if it is in {u}" for u, f in UNITS_MM.items() if u != "mm")
    advice = f"check the unit of the file (unit, --unit): {others}"
    if tool_mm is not None and longest < tool_mm:
        yield f"{name}: the part is {longest:.4g} mm long, less than the tool's diameter {tool_mm:.4g} mm; {advice}"
    elif stock_mm is not None and longest * _UNLIKE < stock_mm:
        yield f"{name}: the part is {longest:.4g} mm long, its stock {stock_mm:.4g} mm; {advice}"
    if longest > LARGEST_MM:
        yield f"{name}: the part is {longest:.4g} mm long, larger than any machine takes; check the unit of the file"
    elif stock_mm is not None and longest > _UNLIKE * stock_mm:
        yield f"{name}: the part is {longest:.4g} mm long, its stock only {stock_mm:.4g} mm; check the unit of the file"
