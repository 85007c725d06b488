"""An entry of a library, its sizes converted to mm and degrees, before anything is checked."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import NamedTuple


class Size(NamedTuple):
    """A size, and how the file writes it.

    Attributes:
        value: mm, or degrees.
        text: key, value and unit for messages: ``LCF = 0.5 in``.
    """

    value: float
    text: str


@dataclass(frozen=True, slots=True, kw_only=True)
class Frustum:
    """A piece of a shaft or holder, from its lower end to its upper one.

    Attributes:
        lower_mm: diameter at the end towards the tip, mm.
        upper_mm: diameter at the other end, mm.
        length_mm: length along the axis, mm.
    """

    lower_mm: float
    upper_mm: float
    length_mm: float


@dataclass(frozen=True, slots=True, kw_only=True)
class RawTool:
    """An entry of a library.

    Attributes:
        source: the library, and the entry in it.
        number: tool number.
        name: description.
        kind: one that `twin.tool_library.kinds.kind_of_word` gives.
        word: the file's own word for the type, used where ``kind`` is None.
        sizes: lengths and angles by name, see `twin.tool_library.assemble`.
        teeth: number of flutes; 0 for none.
        shaft: pieces above the shoulder, upwards.
        holder: pieces of the holder, upwards.
        holder_name: description of the holder.
        notes: what was assumed.
        warnings: values that cannot be right.
    """

    source: str
    number: int | None = None
    name: str = ""
    kind: str | None = None
    word: str = ""
    sizes: Mapping[str, Size]
    teeth: int | None = None
    shaft: tuple[Frustum, ...] = ()
    holder: tuple[Frustum, ...] = ()
    holder_name: str = ""
    notes: tuple[str, ...] = ()
    warnings: tuple[str, ...] = ()
