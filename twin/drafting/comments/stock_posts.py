"""Comments about the stock: one row for each form in which posts write them."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from twin.drafting.comments.program_text import Comment, Unit
from twin.drafting.comments.tool_words import length_mm

_N = r"(-?(?:\d+\.?\d*|\.\d+))"
_U = r"\s*(MM|IN(?:CH(?:ES)?)?\b|\"|'')?"
_BLOCK = re.compile(rf"STOCK/BLOCK\s*,\s*{_N}\s*,\s*{_N}\s*,\s*{_N}\s*,\s*{_N}\s*,\s*{_N}\s*,\s*{_N}", re.IGNORECASE)
_CORNER = re.compile(rf"STOCK(MIN|MAX)\s*:\s*{_N}{_U}\s*,\s*{_N}{_U}\s*,\s*{_N}{_U}", re.IGNORECASE)
_VECTRIC = re.compile(
    rf"^(?:MATERIAL\s+SIZE\s*:?\s*)?X\s*=\s*{_N}\s*,\s*Y\s*=\s*{_N}\s*,\s*Z\s*=\s*{_N}\s*$", re.IGNORECASE
)
_LIMITS = re.compile(rf"^X\s+(MIN|MAX)\s*=\s*{_N}\s*,?\s*Y\s+\1\s*=\s*{_N}\s*,?\s*Z\s+\1\s*=\s*{_N}\s*$", re.IGNORECASE)
_LIMITS_HEAD = re.compile(r"^MATERIAL\s+(?:SETUP|SIZE)", re.IGNORECASE)
_VECTRIC_HEAD = re.compile(r"^MATERIAL\s+SIZE", re.IGNORECASE)
_VECTRIC_Z = re.compile(r"Z\s+ORIGIN\s+FOR\s+MATERIAL\s*=\s*(.*)", re.IGNORECASE)
_VECTRIC_XY = re.compile(r"XY\s+ORIGIN\s+FOR\s+MATERIAL\s*=\s*(.*)", re.IGNORECASE)
_WORDS = re.compile(rf"{_N}{_U}\s*[X*×]\s*{_N}{_U}\s*[X*×]\s*{_N}{_U}", re.IGNORECASE)
_ABOUT_STOCK = re.compile(r"\b(?:STOCK|BLOCK|BLANK|BILLET|WORK ?PIECE|ROHTEIL|BRUT)\b", re.IGNORECASE)
_CENTRE = re.compile(r"\b(?:CENT(?:ER|RE|RED|ERED|RO)|MITTE)\b", re.IGNORECASE)
_TOP = re.compile(r"\b(?:TOP|SURFACE|OBEN|OBERKANTE|DESSUS)\b", re.IGNORECASE)
_BOTTOM = re.compile(r"\b(?:BOTTOM|TABLE|BED)\b(?!\s*(?:LEFT|RIGHT))", re.IGNORECASE)
_LOWER_LEFT = re.compile(r"\b(?:BOTTOM|LOWER|FRONT)[ -]+LEFT\b", re.IGNORECASE)
_NEAR_LINES = 3


@dataclass(frozen=True, slots=True, kw_only=True)
class StockStatement:
    """A box of stock as a program states it.

    Attributes:
        size_mm: extents along X, Y and Z.
        low_mm: lower corner, in each axis None where the program does not state it.
        line: line of the comment.
        post: programs that write it so.
    """

    size_mm: tuple[float, float, float]
    low_mm: tuple[float | None, float | None, float | None]
    line: int
    post: str


def stock_comment(comments: Sequence[Comment], unit: Unit) -> StockStatement | None:
    """The stock that the comments of a program state, None for none.

    Args:
        unit: of the program.
    """
    for read in (_carbide_block, _carbide_corners, _vectric, _vectric_limits, _in_words):
        found = read(comments, unit)
        if found is not None and min(found.size_mm) > 0.0:
            return found
    return None


def _lengths(values: Sequence[str], marks: Sequence[str | None], unit: Unit) -> tuple[float, float, float]:
    x, y, z = (length_mm(value, mark, unit) for value, mark in zip(values, marks, strict=True))
    return x, y, z


def _carbide_block(comments: Sequence[Comment], unit: Unit) -> StockStatement | None:
    """Carbide Create: size, then the position of the program's zero in the block, from its lower corner."""
    for comment in comments:
        match = _BLOCK.search(comment.text)
        if match is not None:
            size = _lengths(match.groups()[:3], (None,) * 3, unit)
            x, y, z = _lengths(match.groups()[3:], (None,) * 3, unit)
            return StockStatement(size_mm=size, low_mm=(-x, -y, -z), line=comment.line, post="Carbide Create")
    return None


def _carbide_corners(comments: Sequence[Comment], unit: Unit) -> StockStatement | None:
    corners: dict[str, tuple[float, float, float]] = {}
    line = 0
    for comment in comments:
        match = _CORNER.search(comment.text)
        if match is not None:
            groups = match.groups()
            corners[groups[0].upper()] = _lengths(groups[1::2], groups[2::2], unit)
            line = comment.line
    return _between(corners, line, "Carbide Create")


def _vectric(comments: Sequence[Comment], unit: Unit) -> StockStatement | None:
    """Vectric: the size after its heading, and the zero in words, where the post writes it."""
    heads = [comment.line for comment in comments if _VECTRIC_HEAD.search(comment.text)]
    for comment in comments:
        match = _VECTRIC.search(comment.text)
        if match is None or not any(0 <= comment.line - head <= _NEAR_LINES for head in heads):
            continue
        size = _lengths(match.groups(), (None,) * 3, unit)
        z = _first(_VECTRIC_Z, comments)
        xy = _first(_VECTRIC_XY, comments)
        low_z = None if z is None else 0.0 if _BOTTOM.search(z) else -size[2] if _TOP.search(z) else None
        low_x, low_y = _corner(xy or "", size)
        return StockStatement(size_mm=size, low_mm=(low_x, low_y, low_z), line=comment.line, post="Vectric")
    return None


def _vectric_limits(comments: Sequence[Comment], unit: Unit) -> StockStatement | None:
    """Vectric, by limits: ``X Min = 0 Y Min = 0 Z Min = -38.1`` and the same with Max, after a heading."""
    heads = [comment.line for comment in comments if _LIMITS_HEAD.search(comment.text)]
    corners: dict[str, tuple[float, float, float]] = {}
    line = 0
    for comment in comments:
        match = _LIMITS.search(comment.text)
        if match is not None and any(0 <= comment.line - head <= _NEAR_LINES for head in heads):
            corners[match[1].upper()] = _lengths(match.groups()[1:], (None,) * 3, unit)
            line = comment.line
    return _between(corners, line, "Vectric")


def _between(corners: Mapping[str, tuple[float, float, float]], line: int, post: str) -> StockStatement | None:
    """The box between two corners, None where one is missing."""
    if len(corners) < 2:
        return None
    low, high = corners["MIN"], corners["MAX"]
    size = (high[0] - low[0], high[1] - low[1], high[2] - low[2])
    return StockStatement(size_mm=size, low_mm=low, line=line, post=post)


def _in_words(comments: Sequence[Comment], unit: Unit) -> StockStatement | None:
    """A size with crosses next to a word for stock; its zero in words close to it."""
    for index, comment in enumerate(comments):
        match = _WORDS.search(comment.text)
        if match is None:
            continue
        near = " ".join(c.text for c in comments[max(0, index - 1) : index + 3] if abs(c.line - comment.line) <= 2)
        if not _ABOUT_STOCK.search(near):
            continue
        marks = match.groups()[1::2]
        last = next((mark for mark in reversed(marks) if mark), None)
        size = _lengths(match.groups()[::2], [mark or last for mark in marks], unit)
        low_z = -size[2] if _TOP.search(near) else 0.0 if _BOTTOM.search(near) else None
        low_x, low_y = _corner(near, size)
        return StockStatement(size_mm=size, low_mm=(low_x, low_y, low_z), line=comment.line, post="in words")
    return None


def _corner(text: str, size: tuple[float, float, float]) -> tuple[float | None, float | None]:
    if _LOWER_LEFT.search(text):
        return 0.0, 0.0
    return (-0.5 * size[0], -0.5 * size[1]) if _CENTRE.search(text) else (None, None)


def _first(pattern: re.Pattern[str], comments: Sequence[Comment]) -> str | None:
    matches = (pattern.search(comment.text) for comment in comments)
    return next((match[1] for match in matches if match is not None), None)
