"""Tool lists as CSV: a heading for each column, a row for each tool; delimiter and decimal comma are detected.

The file that ``twin tools -o tools.csv`` writes reads back as the same tools. Lists typed by hand, and the CSV files
that Fusion 360 exports, are read by the names of their columns.
"""

from __future__ import annotations

import csv
import io
import re
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import replace
from pathlib import Path

from twin.errors import ToolLibraryError
from twin.tool_library.assemble import assemble, cleaned
from twin.tool_library.fields import Fields
from twin.tool_library.formats.csv_columns import ANGLES, COLUMNS, LENGTHS, Column, column_of
from twin.tool_library.kinds import kind_of_word
from twin.tool_library.library_tool import LibraryTool, ToolCylinder
from twin.tool_library.quantities import LibraryUnit, length_mm, unit_named
from twin.tool_library.raw_tool import Frustum, RawTool

_DELIMITERS = (",", ";", "\t", "|")
#: A list is recognised by this many columns.
_FEWEST = 2
#: Lines above the headings, at most.
_ABOVE = 20
_NOTES = " | "
#: Largest size of a cylinder, mm.
_LARGEST_MM = 1e5
_SEGMENT = re.compile(r"\s*H(\S+)\s+U(\S+)\s+L(\S+)\s*")


def csv_tools(text: str, path: Path, unit: LibraryUnit) -> Iterator[LibraryTool]:
    """The tools of a list.

    Args:
        text: the file's text.
        path: the file.
        unit: unit of lengths where neither heading nor row has one.

    Raises:
        ToolLibraryError: no headings that are known, or a row that is not a list of cells.
    """
    lines = text.splitlines(keepends=True)
    above, delimiter, columns = _headings(lines, path)
    seen: set[str] = set()
    reader = csv.reader(lines[above + 1 :], delimiter=delimiter)
    try:
        for cells in reader:
            line = above + 1 + reader.line_num
            if not any(cell.strip() for cell in cells) or cells[0].lstrip().startswith("#"):
                continue
            if len(cells) > len(columns) and any(cell.strip() for cell in cells[len(columns) :]):
                found = f"{len(cells)} cells in a table of {len(columns)} columns"
                raise ToolLibraryError(f"{path}:{line}: {found}; expected quotes around text that has {delimiter!r}")
            values = {c.name: cell for c, cell in zip(columns, cells, strict=False) if c is not None}
            if values.get("index", "").strip() in seen:
                continue  # a further preset of the same tool
            seen |= {values["index"].strip()} - {""} if "index" in values else set()
            yield _tool(columns, cells, f"{path}:{line}", unit)
    except csv.Error as error:
        raise ToolLibraryError(f"{path}:{above + 1 + reader.line_num}: not CSV: {error}; expected a tool") from error


def _headings(lines: Sequence[str], path: Path) -> tuple[int, str, list[Column | None]]:
    """Line of the headings, counted from 0, the delimiter, and the columns."""
    best: tuple[int, int, str, list[Column | None]] | None = None
    for index, line in enumerate(lines[:_ABOVE]):
        for delimiter in _DELIMITERS:
            cells = _cells(line, delimiter)
            columns = [column_of(cell) for cell in cells]
            known = len({column.name for column in columns if column is not None})
            if known >= _FEWEST and (best is None or known > best[0]):
                best = (known, index, delimiter, columns)
    if best is None or not any(column and column.name == "diameter" for column in best[3]):
        raise ToolLibraryError(
            f"{path}: is not a tool library: no row of headings with a diameter; expected a library of Fusion 360, "
            f"FreeCAD, LinuxCNC, CAMotics, Vectric, DIN 4000 or Creo, or CSV with {', '.join(COLUMNS[:5])} ..."
        )
    return best[1], best[2], best[3]


def _cells(line: str, delimiter: str) -> list[str]:
    try:
        return next(csv.reader([line], delimiter=delimiter), [])
    except csv.Error:
        return []


def _tool(columns: Sequence[Column | None], cells: Sequence[str], source: str, unit: LibraryUnit) -> LibraryTool:
    by_heading = {c.heading: cell for c, cell in zip(columns, cells, strict=False) if c is not None}
    headings = {c.name: c for c in columns if c is not None and c.heading in by_heading}
    texts = {name: by_heading[column.heading] for name, column in headings.items()}
    own = unit_named(texts.get("unit"))
    fields = Fields(by_heading, own or unit)
    for name in LENGTHS:
        if name in headings:
            fields.length(name.removesuffix("_diameter"), headings[name].heading, unit=headings[name].unit)
    for name in ANGLES:
        if name in headings:
            fields.angle(name, headings[name].heading)
    word = texts.get("kind", "")
    kind = kind_of_word(word)
    if kind == "chamfer mill" and "diameter" in fields.sizes:
        fields.sizes["top"] = fields.sizes["diameter"]
    tool = assemble(
        RawTool(
            source=source,
            number=fields.whole(headings["number"].heading) if "number" in headings else None,
            name=texts.get("name", ""),
            kind=kind if word.strip() else "flat",
            word=word,
            sizes=fields.sizes,
            teeth=fields.whole(headings["teeth"].heading) if "teeth" in headings else None,
            shaft=tuple(_frusta(texts.get("shaft_segments", ""), fields)),
            holder=tuple(_frusta(texts.get("holder_segments", ""), fields)),
            holder_name=texts.get("holder_name", ""),
            notes=_notes(texts, word),
            warnings=tuple(fields.warnings),
        )
    )
    return _with_cylinders(tool, texts, own or unit)


def _notes(texts: dict[str, str], word: str) -> tuple[str, ...]:
    own = [cleaned(note) for note in texts.get("notes", "").split(_NOTES) if note.strip()]
    return (*own, *([] if word.strip() else ["kind: not in the list, taken as flat"]))


def _with_cylinders(tool: LibraryTool, texts: dict[str, str], unit: LibraryUnit) -> LibraryTool:
    """The tool with the shank and holder of its own columns."""
    warnings = [*tool.warnings]
    shank = [*_cylinders(texts.get("shank", ""), "shank", unit, warnings)]
    holder = [*_cylinders(texts.get("holder", ""), "holder", unit, warnings)]
    return replace(
        tool,
        shank=shank[0] if shank else tool.shank,
        holder=(*shank[1:], *holder) if shank or holder else tool.holder,
        warnings=tuple(warnings),
    )


def _cylinders(text: str, what: str, unit: LibraryUnit, warnings: list[str]) -> Iterator[ToolCylinder]:
    """Cylinders as ``20 x 30 + 40 x 10``: diameter and length, upwards."""
    for piece in text.split("+") if text.strip() else []:
        try:
            diameter, length = (length_mm(size.strip(), unit) for size in re.split(r"[x×]", piece.strip()))
            if not (0.0 < diameter <= _LARGEST_MM and 0.0 < length <= _LARGEST_MM):
                raise ValueError
        except ValueError:
            warnings.append(f'{what} = "{cleaned(piece)}": expected diameter x length, e.g. 20 x 30')
        else:
            yield ToolCylinder(diameter_mm=diameter, length_mm=length)


def _frusta(text: str, fields: Fields) -> Iterator[Frustum]:
    """Segments as Fusion 360 exports them: ``H4.0 U3.175 L1.0; H10.5 U3.175 L3.175``, upwards."""
    for piece in text.split(";") if text.strip() else []:
        found = _SEGMENT.fullmatch(piece)
        try:
            height, upper, lower = (length_mm(size, fields.unit) for size in (found.groups() if found else ()))
        except ValueError:
            fields.warnings.append(f'segment "{cleaned(piece)}": expected H, U and L, e.g. H4 U6 L3')
        else:
            yield Frustum(lower_mm=lower, upper_mm=upper, length_mm=height)


def csv_text(tools: Iterable[LibraryTool]) -> str:
    """Tools as CSV with the columns `COLUMNS`; `csv_tools` reads the same tools from it."""
    out = io.StringIO()
    writer = csv.writer(out, lineterminator="\n")
    writer.writerow(COLUMNS)
    for tool in tools:
        values = {name: getattr(tool, name) for name in COLUMNS}
        values["shank"] = _joined([] if tool.shank is None else [tool.shank])
        values["holder"] = _joined(tool.holder)
        values["notes"] = _NOTES.join(tool.notes)
        writer.writerow(["" if value is None else _cell(value) for value in values.values()])
    return out.getvalue()


def _cell(value: object) -> str:
    return repr(value) if isinstance(value, float) else str(value)


def _joined(pieces: Iterable[ToolCylinder]) -> str:
    return " + ".join(f"{piece.diameter_mm!r} x {piece.length_mm!r}" for piece in pieces)
