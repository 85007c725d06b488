"""Shank and holder of a tool as cylinders, upwards from its flutes."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Mapping

from twin.tool_library.library_tool import ToolCylinder
from twin.tool_library.raw_tool import Frustum, RawTool, Size

#: A cone is replaced by cylinders around it whose diameters differ by at most this, mm; at most this many.
_STEP_MM = 2.0
_MOST_STEPS = 6
#: Most pieces of a shaft or holder.
_MOST_PIECES = 60
_LARGEST_MM = 1000.0
#: Pieces shorter or thinner than this are left out, mm.
_SHORTEST_MM = 1e-3


def above_flutes(
    raw: RawTool, sizes: Mapping[str, Size], warnings: list[str]
) -> tuple[ToolCylinder | None, tuple[ToolCylinder, ...]]:
    """The first cylinder above the flutes, and all others up to the end of the holder.

    The shank begins at the end of the flutes; below the shoulder it has the neck's diameter, above it the shaft's
    pieces, or the shank's diameter up to the holder. Where the length below the holder is not known, the overall
    length ends it, and a holder is left out.

    Args:
        raw: the entry.
        sizes: its sizes that can be right.
        warnings: takes what cannot be right.
    """
    holder = _joined(_pieces(raw.holder, "holder", warnings))
    flutes = sizes.get("flutes")
    if raw.kind == "holder":
        return None, tuple(holder)
    if flutes is None:
        return None, ()
    shaft = [*_neck(sizes, flutes.value), *_pieces(raw.shaft, "shaft", warnings)]
    shaft = _joined(_filled(shaft, sizes, flutes.value, fill=bool(holder)))
    if holder and "stickout" not in sizes and not raw.shaft:
        warnings.append("holder: the length below the holder is not known; expected it")
        holder = []
    return (shaft[0] if shaft else None), (*shaft[1:], *holder)


def _neck(sizes: Mapping[str, Size], flutes_mm: float) -> Iterator[ToolCylinder]:
    """The part between flutes and shoulder."""
    shoulder, neck = sizes.get("shoulder"), sizes.get("neck") or sizes.get("top") or sizes.get("diameter")
    if shoulder is not None and neck is not None and shoulder.value - flutes_mm > _SHORTEST_MM:
        yield ToolCylinder(diameter_mm=neck.value, length_mm=shoulder.value - flutes_mm)


def _filled(
    shaft: list[ToolCylinder], sizes: Mapping[str, Size], flutes_mm: float, *, fill: bool
) -> list[ToolCylinder]:
    """The shaft, continued with the shank's diameter up to the holder or to the tool's end.

    Args:
        fill: the shaft must reach the holder, with the diameter of the cutting part if that of the shank is not known.
    """
    shank, end = sizes.get("shank"), sizes.get("stickout") or sizes.get("overall")
    if shank is None and fill:
        shank = sizes.get("top") or sizes.get("diameter")
    if shank is None or end is None:
        return shaft
    rest = end.value - flutes_mm - sum(piece.length_mm for piece in shaft)
    if rest > _SHORTEST_MM:
        return [*shaft, ToolCylinder(diameter_mm=shank.value, length_mm=rest)]
    return shaft


def _pieces(frusta: Iterable[Frustum], what: str, warnings: list[str]) -> Iterator[ToolCylinder]:
    """Cylinders around the pieces of a shaft or holder; those that no tool has are left out with a warning."""
    for index, piece in enumerate(frusta):
        if index >= _MOST_PIECES:
            warnings.append(f"{what}: more than {_MOST_PIECES} segments; expected at most that")
            return
        largest = max(piece.lower_mm, piece.upper_mm)
        if min(piece.lower_mm, piece.upper_mm, piece.length_mm) < 0.0 or max(largest, piece.length_mm) > _LARGEST_MM:
            sizes = f"{piece.lower_mm:g} to {piece.upper_mm:g} mm, {piece.length_mm:g} mm long"
            warnings.append(f"{what} segment {index + 1}, {sizes}: expected sizes from 0 to {_LARGEST_MM:g} mm")
        elif min(piece.length_mm, largest) > _SHORTEST_MM:
            yield from _cylinders(piece)


def _cylinders(piece: Frustum) -> Iterator[ToolCylinder]:
    rise = piece.upper_mm - piece.lower_mm
    steps = max(1, min(_MOST_STEPS, math.ceil(abs(rise) / _STEP_MM - 1e-9)))
    for step in range(steps):
        ends = (piece.lower_mm + rise * step / steps, piece.lower_mm + rise * (step + 1) / steps)
        yield ToolCylinder(diameter_mm=max(ends), length_mm=piece.length_mm / steps)


def _joined(pieces: Iterable[ToolCylinder]) -> list[ToolCylinder]:
    """The pieces, with neighbours of one diameter as one; lengths rounded to nanometres."""
    joined: list[ToolCylinder] = []
    for piece in pieces:
        if joined and math.isclose(joined[-1].diameter_mm, piece.diameter_mm, rel_tol=1e-9):
            piece = ToolCylinder(diameter_mm=joined[-1].diameter_mm, length_mm=joined[-1].length_mm + piece.length_mm)
            joined.pop()
        joined.append(piece)
    return [ToolCylinder(diameter_mm=round(p.diameter_mm, 6), length_mm=round(p.length_mm, 6)) for p in joined]
