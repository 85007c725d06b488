"""Small programs in the style of posts."""

from __future__ import annotations

from pathlib import Path

#: A slot along X with a plunge at its start, 2 mm deep, in the middle of a pocketing program's header.
SLOT = """%
O1001 (SLOT)
(T3 D=8. CR=0. - ZMIN=-2. - flat end mill)
G21 G17 G40 G49 G80 G90 G94
G28 G91 Z0.
G90
T3 M6
G54
S4000 M3
G0 X0. Y0.
G43 Z20. H3
G0 Z2.
G1 Z-2. F200.
X40. F640.
G0 Z20.
M30
%
"""


def written(folder: Path, text: str, name: str = "part.nc") -> Path:
    """A program as a file."""
    path = folder / name
    path.write_text(text)
    return path


def changed(*pairs: tuple[str, str]) -> str:
    """The slot with other text; each old text must be in it."""
    text = SLOT
    for old, new in pairs:
        assert old in text
        text = text.replace(old, new)
    return text
