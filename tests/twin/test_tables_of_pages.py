"""Tables of keys and options on the pages are those of the models."""

from __future__ import annotations

import runpy
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
MARKS = ("<!-- keys of ", "<!-- options of ")
PAGES = sorted(p.name for p in (ROOT / "docs").glob("*.md") if any(mark in p.read_text("utf-8") for mark in MARKS))


@pytest.mark.parametrize("name", PAGES)
def test_a_pages_tables_are_its_models_fields(name: str) -> None:
    filled = runpy.run_path(str(ROOT / "tools" / "fill_tables.py"))["filled"]
    page = (ROOT / "docs" / name).read_text("utf-8")
    assert filled(page) == page, "python tools/fill_tables.py rewrites the page"


def test_pages_have_tables() -> None:
    assert {"command-line.md", "compare.md", "identify.md", "job-file.md"} <= set(PAGES)


def test_the_page_of_materials_has_every_row() -> None:
    filled = runpy.run_path(str(ROOT / "tools" / "fill_materials.py"))["filled"]
    page = (ROOT / "docs" / "materials.md").read_text("utf-8")
    assert filled(page) == page, "python tools/fill_materials.py rewrites the page"
