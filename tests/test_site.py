"""The site: every page is in its navigation, every public name on the API page, links lead nowhere outside of it."""

from __future__ import annotations

import importlib.util
import re
from pathlib import Path
from types import ModuleType, SimpleNamespace

import pytest

import gcode
import twin

ROOT = Path(__file__).parents[1]
DOCS = ROOT / "docs"


@pytest.fixture(scope="module")
def links() -> ModuleType:
    spec = importlib.util.spec_from_file_location("site_links", ROOT / "tools" / "site_links.py")
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def test_every_page_is_in_the_navigation_once() -> None:
    named = re.findall(r": ([\w-]+\.md)$", (ROOT / "mkdocs.yml").read_text(), flags=re.MULTILINE)
    assert sorted(named) == sorted(p.name for p in DOCS.glob("*.md"))


@pytest.mark.parametrize("package", [twin, gcode], ids=lambda p: p.__name__)
def test_every_public_name_is_on_the_api_page(package: ModuleType) -> None:
    named = re.findall(rf"^::: {package.__name__}\.(\w+)$", (DOCS / "api.md").read_text(), flags=re.MULTILINE)
    assert sorted(named) == sorted(name for name in package.__all__ if name != "__version__")


@pytest.mark.parametrize(
    ("written", "shown"),
    [
        ("see [the example](../examples/torus).", "see the example (`examples/torus`)."),
        ("see [examples/torus](../examples/torus).", "see `examples/torus`."),
        ("see [paths](paths.md#verification).", "see [paths](paths.md#verification)."),
        ("![picture](../x.png)", "![picture](../x.png)"),
    ],
)
def test_links_out_of_the_site_become_names_of_files(links: ModuleType, written: str, shown: str) -> None:
    page = SimpleNamespace(file=SimpleNamespace(src_uri="index.md"))
    assert links.on_page_markdown(written, page=page) == shown
