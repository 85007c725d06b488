"""Put the rows of the material table into docs/materials.md, after its mark.

python tools/fill_materials.py
"""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

from twin.cli.show.material_tables import row_items
from twin.materials import Material, load_materials

PAGE = Path(__file__).parents[1] / "docs" / "materials.md"
MARK = "<!-- rows of twin/data/materials.toml -->\n"


def filled(page: str) -> str:
    """The page with the rows of the table in place of everything after the mark."""
    head, mark, _ = page.partition(MARK)
    return head + mark + "".join(f"{line}\n" for line in _lines())


def _lines() -> Iterator[str]:
    rows = load_materials().values()
    published = [row for row in rows if row.kind == "published test"]
    groups = [row for row in rows if row.kind == "order of magnitude"]
    yield from ("", "## Published tests")
    for row in published:
        yield from _section(row)
    first = groups[0]
    yield from ("", "## Groups of VDI 3323, order of magnitude", "")
    yield f"Source: {first.source}. {first.note.partition('. ')[2]}"
    yield ""
    yield from ("| name | ISO 513 | material | kc1.1 = Ktc, N/mm2 | mc | Krc | Kac | also |", "| --- " * 8 + "|")
    for row in groups:
        values = [f"{v:g}" for v in (row.Ktc, row.mt, row.Krc, row.Kac)]
        cells = (row.name, row.iso_group, row.note.partition(". ")[0], *values, "; ".join(row.aliases[:-1]))
        yield f"| {' | '.join(cells)} |"


def _section(row: Material) -> Iterator[str]:
    yield from ("", f"### {row.name}", "", "| item | value |", "| --- | --- |")
    yield from (f"| {name} | {text} |" for name, text in row_items(row) if name != "name")


if __name__ == "__main__":
    PAGE.write_text(filled(PAGE.read_text("utf-8")), "utf-8")
