"""Tools of libraries as a table and as a JSON object."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import asdict
from pathlib import Path
from typing import Any

from rich import box
from rich.console import Console
from rich.table import Table
from rich.text import Text

from twin.number_format import plural
from twin.tool_library import LibraryTool, ToolCylinder, ToolLibrary

_HEADS = ("T", "name", "kind", "D", "corner", "taper", "teeth", "flutes", "shank", "holder")
_TEXTS = ("name", "kind")
#: Width of the column of names, at least.
_LEAST_NAME = 16
#: Most remarks below a table.
_MOST_REMARKS = 12


def print_tools(console: Console, chosen: Iterable[tuple[ToolLibrary, Sequence[LibraryTool]]]) -> None:
    """Print each library's tools as a table, and what was assumed below it."""
    for library, tools in chosen:
        if not tools:
            continue
        title = f"{library.path}: {plural(len(tools), 'tool')}, {library.format}; mm, deg"
        console.print(Text(title, style="bold"))
        console.print(_table(tools))
        remarks = [*_remarks(library, tools)]
        for remark in remarks[:_MOST_REMARKS]:
            console.print(Text(remark))
        if len(remarks) > _MOST_REMARKS:
            console.print(Text(f"and {plural(len(remarks) - _MOST_REMARKS, 'more remark')}; see --json"))


def print_written(console: Console, path: Path, tools: Sequence[LibraryTool]) -> None:
    """Print how many tools a file has, and how many of them are comments of a job's tables."""
    comments = sum(not tool.simulated for tool in tools) if path.suffix.lower() == ".toml" else 0
    rest = f", {comments} of them as comments: they cannot be simulated" if comments else ""
    console.print(Text(f"{plural(len(tools), 'tool')} written to {path}{rest}"), soft_wrap=True)


def _table(tools: Sequence[LibraryTool]) -> Table:
    """A row for each tool, with the columns that any of them needs; those that cannot be simulated are dim."""
    rows = [_cells(tool) for tool in tools]
    used = [index for index, head in enumerate(_HEADS) if head in _TEXTS or any(row[index] for row in rows)]
    table = Table(box=box.SIMPLE_HEAD, pad_edge=False, padding=(0, 1, 0, 0))
    for index in used:
        head = _HEADS[index]
        if head == "name":
            table.add_column(head, overflow="fold", min_width=_LEAST_NAME)
        else:
            table.add_column(head, justify="left" if head in _TEXTS else "right", no_wrap=True)
    for tool, row in zip(tools, rows, strict=True):
        table.add_row(*(row[index] for index in used), style="" if tool.simulated else "dim")
    return table


def _cells(tool: LibraryTool) -> list[str]:
    sizes = (tool.diameter_mm, tool.corner_radius_mm, tool.taper_deg, tool.teeth, tool.flute_length_mm)
    number = "" if tool.number is None else str(tool.number)
    return [number, tool.name, tool.kind, *map(_size, sizes), _cylinder(tool.shank), _holder(tool.holder)]


def _size(value: float | None) -> str:
    return "" if value is None else f"{value:.4g}"


def _cylinder(piece: ToolCylinder | None) -> str:
    return "" if piece is None else f"{piece.diameter_mm:.3g} x {piece.length_mm:.3g}"


def _holder(pieces: Sequence[ToolCylinder]) -> str:
    """Largest diameter and length of all pieces."""
    if not pieces:
        return ""
    largest, length = max(p.diameter_mm for p in pieces), sum(p.length_mm for p in pieces)
    return f"{largest:.3g} x {length:.3g}"


def _remarks(library: ToolLibrary, tools: Sequence[LibraryTool]) -> Iterator[str]:
    """Reasons, assumptions and shared numbers, each once."""
    for obstacle, count in Counter(tool.obstacle for tool in tools if tool.obstacle).items():
        which = _which([tool for tool in tools if tool.obstacle == obstacle], count)
        yield f"{which} cannot be simulated: {obstacle}"
    notes = Counter(note for tool in tools for note in tool.notes)
    for note, count in notes.items():
        yield f"{_which([tool for tool in tools if note in tool.notes], count, len(tools))}: {note}"
    for number, same in library.shared_numbers.items():
        if any(tool.number == number for tool in tools):
            yield f"number {number}: {len(same)} tools have it; a job names one by its name"


def _which(tools: Sequence[LibraryTool], count: int, total: int = 0) -> str:
    """A few tools by number and name, or how many there are."""
    if count == total and count > 1:
        return f"all {count} tools"
    return ", ".join(tool.title for tool in tools) if count <= 3 else plural(count, "tool")


def tools_object(chosen: Iterable[tuple[ToolLibrary, Sequence[LibraryTool]]]) -> dict[str, Any]:
    """All tools as one JSON object."""
    pairs = [(library, tool) for library, tools in chosen for tool in tools]
    return {"tools": [_object(library, tool) for library, tool in pairs]}


def _object(library: ToolLibrary, tool: LibraryTool) -> dict[str, Any]:
    values = asdict(tool)
    texts = {key: list(values.pop(key)) for key in ("notes", "warnings")}
    source = values.pop("source")
    return {
        **values,
        "holder": list(values["holder"]),
        "simulated": tool.simulated,
        "obstacle": tool.obstacle,
        "missing": list(tool.missing),
        **texts,
        "file": str(library.path),
        "format": library.format,
        "source": source,
    }
