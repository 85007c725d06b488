"""Tables of keys on the pages are those of the models."""

from __future__ import annotations

import runpy
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
MARK = "<!-- keys of "
PAGES = sorted(p.name for p in (ROOT / "docs").glob("*.md") if MARK in p.read_text("utf-8"))


@pytest.mark.parametrize("name", PAGES)
def test_a_pages_tables_are_its_models_fields(name: str) -> None:
    filled = runpy.run_path(str(ROOT / "tools" / "fill_tables.py"))["filled"]
    page = (ROOT / "docs" / name).read_text("utf-8")
    assert filled(page) == page, "python tools/fill_tables.py rewrites the page"


def test_pages_have_tables() -> None:
    assert "job-file.md" in PAGES
