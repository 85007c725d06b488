"""No two files need each other: imports make no circle, counted with those for type checkers and inside functions."""

from __future__ import annotations

import ast
from collections.abc import Iterator, Mapping
from graphlib import CycleError, TopologicalSorter
from pathlib import Path

import pytest
from support.sources import nodes_of

ROOT = Path(__file__).parents[1]


def modules(root: Path, package: str) -> dict[str, Path]:
    """Files of a package by module name."""
    files = sorted((root / package).rglob("*.py"))
    return {".".join(f.relative_to(root).with_suffix("").parts).removesuffix(".__init__"): f for f in files}


def imported(path: Path, known: Mapping[str, Path]) -> Iterator[str]:
    """Modules of the package that a file imports, wherever in it the import is written."""
    for node in nodes_of(path):
        if isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names if alias.name in known)
        elif isinstance(node, ast.ImportFrom) and node.module in known and not node.level:
            names = (f"{node.module}.{alias.name}" for alias in node.names)
            yield from (name if name in known else str(node.module) for name in names)


def circle(root: Path, package: str) -> list[str]:
    """Modules of a circle of imports, the first one again at its end; empty where there is none."""
    known = modules(root, package)
    graph = {name: set(imported(path, known)) - {name} for name, path in known.items()}
    try:
        TopologicalSorter(graph).prepare()
    except CycleError as error:
        return list(error.args[1])
    return []


@pytest.mark.parametrize("package", ["gcode", "twin"])
def test_imports_make_no_circle(package: str) -> None:
    assert circle(ROOT, package) == []


@pytest.mark.parametrize(
    "back",
    [
        "from pkg.a import A",
        "from pkg import a",
        "import pkg.a",
        "from typing import TYPE_CHECKING\nif TYPE_CHECKING:\n    from pkg.a import A",
        "def f():\n    from pkg.a import A",
    ],
)
def test_a_circle_is_found(back: str, tmp_path: Path) -> None:
    (tmp_path / "pkg").mkdir()
    for name, text in {"__init__": "", "a": "from pkg.b import B", "b": "from pkg.c import C", "c": back}.items():
        (tmp_path / "pkg" / f"{name}.py").write_text(text)
    assert set(circle(tmp_path, "pkg")) == {"pkg.a", "pkg.b", "pkg.c"}
