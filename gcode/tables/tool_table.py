"""Tool tables: LinuxCNC's ``.tbl``, and ``.toml``.

A ``.tbl`` row is words in any order and a comment after a semicolon: ``T1 P1 Z0.511 D0.125 ;1/8 end mill``. T is the
tool's number, P its pocket, X Y Z its offsets, D its diameter, Q the orientation of a lathe tool and I J its angles,
which motions do not depend on.
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from pathlib import Path
from types import MappingProxyType

from gcode.errors import Place
from gcode.settings import ToolOffset
from gcode.tables.settings_file import tools_of
from gcode.tables.text_file import MM_PER_UNIT, Unit, error_at, lines_of, number_at, read_text, token_at
from gcode.tables.toml_document import load_document

#: Field of `ToolOffset` of each word of a row, and the factor of its number in addition to the unit.
_FIELDS: Mapping[str, tuple[str, float]] = MappingProxyType(
    {"X": ("x_mm", 1.0), "Y": ("y_mm", 1.0), "Z": ("length_mm", 1.0), "D": ("radius_mm", 0.5)}
)
_WHOLE = "TPQ"
_LATHE = "IJ"
#: Offsets along axes that a row of `ToolOffset` does not have; they must be 0.
_FURTHER = "ABCUVW"
#: Words that motions do not depend on: the last one of a row holds, as in LinuxCNC.
_REPEATABLE = "PIJ"
_LETTERS = "".join((_WHOLE, *_FIELDS, _LATHE, _FURTHER))
_ROW = "a row such as T1 P1 Z0.5 D0.25 ;comment"

#: First line, and rows, of tables written for EMC2 before 2.5: columns and no letters.
_OLD_HEADER = re.compile(r"\s*(?:POC(?:KET)?|TOOL(?:NO)?)\s+(?:FMS|POCKET|POC|LEN\w*)\b", re.IGNORECASE)
_OLD_ROW = re.compile(r"\s*\d+\s+\d+\s")


def read_tool_table(path: Path | str, units: Unit = "mm") -> dict[int, ToolOffset]:
    """Reads a tool table.

    Args:
        path: a ``.tbl`` or ``.toml`` file.
        units: the machine's unit of length, which a ``.tbl`` is in; a ``.toml`` is in mm.

    Returns:
        Rows by tool number, each with its pocket.

    Raises:
        GcodeError: for a file that cannot be read, an old table of columns (``tool-table-format``), a letter that no
            row has or a word that is not a number (``tool-table-word``), a number that is not whole
            (``tool-table-number``), a row without T (``tool-table-row``), a tool or word given twice
            (``tool-table-duplicate``), an offset along a rotary or parallel axis (``tool-table-axis``), and for what
            `read_settings` refuses.
    """
    path = Path(path)
    text = read_text(path, (".tbl", ".toml"))
    if path.suffix.lower() == ".toml":
        return tools_of(load_document(path, text), only=True)
    rows: dict[int, ToolOffset] = {}
    lines: dict[int, int] = {}
    for place in lines_of(path, text):
        words = _words(place)
        if not words:
            continue
        number = _number(place, words)
        if number in rows:
            problem = f"T{number} is given twice, first in line {lines[number]}"
            raise error_at(place, words["T"][1], "tool-table-duplicate", problem, "each tool once")
        rows[number], lines[number] = _row(place, words, MM_PER_UNIT[units]), place.line
    return rows


def _words(place: Place) -> dict[str, tuple[float, int]]:
    """Number and index of each word of a row, by letter; empty for a line without words."""
    text = place.text.partition(";")[0]
    if _OLD_HEADER.match(text) or _OLD_ROW.match(text):
        problem = "an old table of columns, which LinuxCNC no longer reads"
        raise error_at(place, 0, "tool-table-format", problem, _ROW)
    words: dict[str, tuple[float, int]] = {}
    index = _skip_blanks(text, 0)
    while index < len(text):
        letter = text[index].upper()
        if letter not in _LETTERS:
            problem = f"{token_at(text, index)!r} is not a word of a tool table"
            raise error_at(place, index, "tool-table-word", problem, _ROW)
        if letter in words and letter not in _REPEATABLE:
            raise error_at(place, index, "tool-table-duplicate", f"{letter} twice in one row", "each word once")
        value, end = number_at(place, index + 1, letter, "tool-table-word")
        words[letter] = (value, index)
        index = _skip_blanks(text, end)
    return words


def _skip_blanks(text: str, index: int) -> int:
    while index < len(text) and text[index].isspace():
        index += 1
    return index


def _number(place: Place, words: Mapping[str, tuple[float, int]]) -> int:
    """The row's tool number, after its whole numbers were checked."""
    if "T" not in words:
        raise error_at(place, min(i for _, i in words.values()), "tool-table-row", "a row without a tool number", _ROW)
    for letter in _WHOLE:
        value, index = words.get(letter, (0.0, 0))
        if value < 0.0 or value != int(value):
            problem = f"{letter}{value:g} in a tool table"
            raise error_at(place, index, "tool-table-number", problem, "a whole number of 0 or more")
    return int(words["T"][0])


def _row(place: Place, words: Mapping[str, tuple[float, int]], unit_mm: float) -> ToolOffset:
    for letter in _FURTHER:
        value, index = words.get(letter, (0.0, 0))
        if value != 0.0:
            problem = f"{letter}{value:g}, an offset along a rotary or parallel axis, is not supported"
            raise error_at(place, index, "tool-table-axis", problem, "offsets along X, Y and Z only")
    lengths = {name: words[letter][0] * part * unit_mm for letter, (name, part) in _FIELDS.items() if letter in words}
    pocket = int(words["P"][0]) if "P" in words else None
    orientation = int(words["Q"][0]) if "Q" in words else 0
    comment = place.text.partition(";")[2].strip()
    return ToolOffset(pocket=pocket, orientation=orientation, comment=comment, **lengths)
