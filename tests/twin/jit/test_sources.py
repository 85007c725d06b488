"""The hash of a kernel module's sources: it changes with every module that its compiled code is made from."""

from __future__ import annotations

import ast
import doctest
from pathlib import Path

import pytest

from twin.jit import sources
from twin.jit.sources import imported_names, source_hash

ROOT = Path(__file__).parents[3]
KERNELS = sorted((ROOT / "twin").rglob("*kernels.py"))


def named_by_syntax(source: str) -> set[str]:
    """The same as `imported_names`, by Python's own parser."""
    found = set()
    for node in ast.walk(ast.parse(source)):
        if isinstance(node, ast.ImportFrom) and (node.module or "").split(".")[0] == "twin":
            found |= {node.module or "", *(f"{node.module}.{alias.name}" for alias in node.names)}
        elif isinstance(node, ast.Import):
            found |= {alias.name for alias in node.names if alias.name.split(".")[0] == "twin"}
    return found


def test_all_imports_are_seen() -> None:
    texts = {file: file.read_text("utf-8") for file in (ROOT / "twin").rglob("*.py")}
    missed = {file: named_by_syntax(text) - imported_names(text) for file, text in texts.items()}
    assert {file: names for file, names in missed.items() if names} == {}


def test_imports_over_several_lines_with_comments() -> None:
    source = "from twin.a import (\n    b,  # why, what\n    c as d,\n)\nimport twin.e\nfrom gcode import f\n"
    assert imported_names(source) == {"twin.a", "twin.a.b", "twin.a.c", "twin.e"}


def test_the_example_in_the_docstring() -> None:
    assert doctest.testmod(sources) == doctest.TestResults(failed=0, attempted=1)


def test_a_change_in_an_imported_module_changes_the_hash(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(sources, "_PACKAGE", tmp_path)
    (tmp_path / "kernels.py").write_text("from twin.helpers import inner\n")
    (tmp_path / "helpers.py").write_text("from twin import numbers\n")
    (tmp_path / "numbers.py").write_text("N = 1\n")
    (tmp_path / "others.py").write_text("M = 1\n")

    def hash_of_kernels() -> str:
        sources.source_hash.cache_clear()
        sources._read.cache_clear()
        return source_hash(tmp_path / "kernels.py")

    before = hash_of_kernels()
    (tmp_path / "others.py").write_text("M = 2\n")
    assert hash_of_kernels() == before
    (tmp_path / "numbers.py").write_text("N = 2\n")
    assert hash_of_kernels() != before


def test_circular_imports_end() -> None:
    assert len(source_hash(ROOT / "twin" / "jit" / "compiled.py")) == 16


def test_modules_have_hashes_of_their_own() -> None:
    assert len({source_hash(file) for file in KERNELS}) == len(KERNELS)


def test_kernel_modules_do_not_depend_on_the_whole_package() -> None:
    assert [file for file in KERNELS if "twin" in imported_names(file.read_text())] == []
    assert "twin" not in imported_names((ROOT / "twin" / "jit" / "compiled.py").read_text())
