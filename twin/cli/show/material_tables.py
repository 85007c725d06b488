"""Materials as tables and as JSON objects."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from typing import Any

from rich import box
from rich.console import Console
from rich.table import Table
from rich.text import Text

from twin.materials import Material

_NAMES = ("Ktc", "Kte", "Krc", "Kre", "Kac", "Kae")
_SHEAR, _EDGE = ("Ktc", "Krc", "Kac"), ("Kte", "Kre", "Kae")


def print_rows(console: Console, rows: Sequence[Material]) -> None:
    """Print published tests and catalogue values in a table each."""
    published = [row for row in rows if row.kind == "published test"]
    groups = [row for row in rows if row.kind == "order of magnitude"]
    if published:
        console.print(Text("Published tests: Ktc, Krc, Kac in N/mm2, Kte, Kre, Kae in N/mm", style="bold"))
        console.print(_table(("material", "ISO"), _SHEAR + _EDGE, map(_published_cells, published)))
    if groups:
        console.print(Text("Order of magnitude only: kc1.1 in N/mm2 and mc by material group", style="bold"))
        console.print(_table(("material", "ISO"), ("kc1.1", "mc"), map(_group_cells, groups), "for"))
    console.print(Text("twin materials NAME prints a row with its source, range and notes."))


def _table(names: Sequence[str], numbers: Sequence[str], rows: Iterable[Sequence[str]], *texts: str) -> Table:
    table = Table(box=box.SIMPLE_HEAD, pad_edge=False)
    for head in names:
        table.add_column(head, no_wrap=True)
    for head in numbers:
        table.add_column(head, justify="right", no_wrap=True)
    for head in texts:
        table.add_column(head)
    for cells in rows:
        table.add_row(*cells)
    return table


def _published_cells(row: Material) -> list[str]:
    shear = [f"{getattr(row, name):.5g}" for name in _SHEAR]
    return [row.name, row.iso_group, *shear, *(f"{getattr(row, name):.4g}" for name in _EDGE)]


def _group_cells(row: Material) -> list[str]:
    return [row.name, row.iso_group, f"{row.Ktc:g}", f"{row.mt:g}", row.aliases[-1]]


def row_lines(row: Material) -> Table:
    """A whole row, one line for each item."""
    grid = Table.grid(padding=(0, 3))
    grid.add_column(style="dim", no_wrap=True)
    for name, text in row_items(row):
        grid.add_row(name, Text(text, overflow="fold"))
    return grid


def row_items(row: Material) -> Iterator[tuple[str, str]]:
    """The items of a row that are given, in words."""
    yield "name", row.name
    if row.aliases:
        yield "also", "; ".join(row.aliases)
    yield "family", row.family
    yield "ISO 513 group", row.iso_group
    yield "kind", row.kind
    yield "law", "linear: F = (K h + Ke) b" if row.law == "linear-edge" else "kienzle: F = K h^(1 - m) b, h in mm"
    for name in _NAMES:
        yield name, f"{getattr(row, name):g} {'N/mm2' if name.endswith('c') else 'N/mm'}"
    if row.law == "kienzle":
        yield "mt, mr, ma", f"{row.mt:g}, {row.mr:g}, {row.ma:g}"
    if row.orthogonal is not None:
        values = row.orthogonal.model_dump().items()
        yield "orthogonal tests", ", ".join(f"{key} {value:g}" for key, value in values)
    yield "chip thickness", _interval(row.chip_range_mm, "mm")
    yield "cutting speed", _interval(row.speed_range_m_min, "m/min")
    yield "tool", row.tool
    yield "uncertainty", row.uncertainty
    yield "source", row.source
    if row.note:
        yield "note", row.note
    if row.caution:
        yield "caution", row.caution


def _interval(interval: tuple[float, float] | None, unit: str) -> str:
    if interval is None:
        return "not stated"
    low, high = interval
    return f"{low:g} {unit}" if low == high else f"{low:g} to {high:g} {unit}"


def row_object(row: Material) -> dict[str, Any]:
    """A whole row for JSON."""
    return row.model_dump(mode="json")


def listing_objects(rows: Sequence[Material]) -> list[dict[str, Any]]:
    """The rows of the list for JSON: name, law, source and range."""
    keys = {"name", "aliases", "family", "iso_group", "kind", "law", "source", "chip_range_mm", "speed_range_m_min"}
    return [row.model_dump(mode="json", include=keys) for row in rows]
