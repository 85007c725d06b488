"""Tool tables of LinuxCNC (``.tbl``): ``T1 P1 D6.0 Z-12.3 ;6 mm ball``.

D is the diameter and Z the tool length offset, in the unit of the machine, which the file does not state. The type is
not stored: it is taken from the comment where that names one.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from pathlib import Path

from twin.errors import ToolLibraryError
from twin.tool_library.fields import Fields
from twin.tool_library.kinds import SIMULATED, kind_of_word
from twin.tool_library.quantities import LibraryUnit
from twin.tool_library.raw_tool import RawTool

_ROW = re.compile(r"\s*T\s*\d", re.IGNORECASE)
_WORD = re.compile(r"\s*([A-Za-z])\s*([-+]?[\d.,]+)")
_LETTERS = "TPXYZABCUVWDIJQ"


def is_tool_table(text: str) -> bool:
    """Whether a text's first line with words is a row of a tool table."""
    rows = (line for line in text.splitlines() if line.partition(";")[0].strip())
    return bool(_ROW.match(next(rows, "")))


def tool_table(text: str, path: Path, unit: LibraryUnit) -> Iterator[RawTool]:
    """The tools of a table.

    Args:
        text: the file's text.
        path: the file.
        unit: unit of the machine.

    Raises:
        ToolLibraryError: a row that is not words of a letter and a number.
    """
    for line, row in enumerate(text.splitlines(), start=1):
        words, _, comment = row.partition(";")
        if not words.strip():
            continue
        values = _words(words, f"{path}:{line}")
        fields = Fields(values, unit)
        fields.length("diameter", "D")
        gauge = fields.length("gauge", "Z")
        if gauge is not None and gauge.value <= 0.0:
            del fields.sizes["gauge"]  # an offset from another tool, or none
        kind = kind_of_word(comment)
        taken = "flat" if kind is None else kind
        corner = {"bull": "corner radius and flutes", "taper": "angle and flutes"}.get(taken, "flutes")
        where = "not stored" if kind is None else "from the comment"
        yield RawTool(
            source=f"{path}:{line}",
            number=fields.whole("T"),
            name=comment,
            kind=taken,
            word=comment,
            sizes=fields.sizes,
            notes=(
                f"type: {where}, taken as {taken}",
                f"unit: not stored, taken as {unit}",
                *([f"{corner}, lengths, helix angle: not stored in this format"] if taken in SIMULATED else []),
            ),
            warnings=tuple(fields.warnings),
        )


def _words(text: str, source: str) -> dict[str, str]:
    """The words of a row by letter."""
    words: dict[str, str] = {}
    at = 0
    while text[at:].strip():
        found = _WORD.match(text, at)
        letter = found[1].upper() if found else ""
        if found is None or letter not in _LETTERS:
            raise ToolLibraryError(
                f'{source}: "{text[at:].strip()[:20]}": expected a word of T, P, D, Z ... and a number'
            )
        if letter in words:
            raise ToolLibraryError(f"{source}: {letter} is given twice; expected each letter once")
        words[letter], at = found[2], found.end()
    if "T" not in words:
        raise ToolLibraryError(f"{source}: a row without T; expected the number of a tool")
    return words
