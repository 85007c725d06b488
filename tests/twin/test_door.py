"""`import twin`: light, complete, and typed as it behaves."""

from __future__ import annotations

import ast
import importlib
import json
import re
import subprocess
import sys
from pathlib import Path
from types import ModuleType

import pytest

import gcode
import twin

ROOT = Path(__file__).parents[2]

MEASURE = """
import json, sys, time
begin = time.perf_counter()
import twin
took = time.perf_counter() - begin
names = dir(twin)
print(json.dumps([took, sorted(sys.modules), names]))
"""


def typed_names() -> set[str]:
    """Names that type checkers see: imported under TYPE_CHECKING."""
    tree = ast.parse(Path(twin.__file__ or "").read_text())
    guarded = next(node for node in tree.body if isinstance(node, ast.If))
    return {alias.asname or alias.name for n in guarded.body if isinstance(n, ast.ImportFrom) for alias in n.names}


def test_importing_the_package_loads_nothing_heavy() -> None:
    command = [sys.executable, "-c", MEASURE]
    took, modules, names = json.loads(subprocess.run(command, check=True, capture_output=True, cwd=ROOT).stdout)
    assert took < 0.1
    assert {m.split(".")[0] for m in modules} & {"numpy", "numba", "pydantic", "typer", "rerun", "matplotlib"} == set()
    assert [m for m in modules if m.startswith("twin.")] == []
    assert set(twin.__all__) <= set(names)


def test_every_public_name_is_there_and_typed() -> None:
    assert typed_names() == set(twin.__all__)
    for name in twin.__all__:
        assert getattr(twin, name) is not None
    with pytest.raises(AttributeError, match="module 'twin' has no attribute 'replays'"):
        twin.replays  # noqa: B018


def test_no_module_shadows_a_name_of_the_door() -> None:
    modules = {p.stem for p in Path(twin.__file__ or "").parent.iterdir()}
    assert modules & set(twin.__all__) == set()
    for name in ("simulation", "comparison", "run", "job", "record"):
        importlib.import_module(f"twin.{name}")
    assert callable(twin.replay) and callable(twin.records)


def test_every_public_function_and_class_explains_itself() -> None:
    for name in twin.__all__:
        value = getattr(twin, name)
        if name not in ("Record", "__version__"):
            assert value.__doc__ and len(value.__doc__.split()) > 5, name


def test_errors_have_one_root() -> None:
    errors = [getattr(twin, name) for name in twin.__all__ if name.endswith("Error")]
    assert all(issubclass(error, twin.TwinError) for error in errors)


def shown_code() -> list[tuple[str, str]]:
    """Python that users are shown: blocks of pages, and the examples."""
    pages = [ROOT / "README.md", *sorted((ROOT / "docs").glob("**/*.md")), *sorted((ROOT / "examples").glob("**/*.md"))]
    blocks = [
        (f"{page.relative_to(ROOT)}:{text.count(chr(10), 0, block.start()) + 1}", block[1])
        for page in pages
        for text in [page.read_text()]
        for block in re.finditer(r"^```(?:python|py)\n(.*?)^```", text, flags=re.MULTILINE | re.DOTALL)
    ]
    examples = sorted((ROOT / "examples").glob("**/*.py"))
    return blocks + [(str(file.relative_to(ROOT)), file.read_text()) for file in examples]


def private_names(code: str) -> set[str]:
    """Names of twin and gcode that code uses and that are not public."""
    doors: dict[str, ModuleType] = {"twin": twin, "gcode": gcode}
    tree = ast.parse(code)
    used = {n.name for node in ast.walk(tree) if isinstance(node, ast.Import) for n in node.names}
    used |= {
        f"{node.module}.{alias.name}"
        for node in ast.walk(tree)
        if isinstance(node, ast.ImportFrom) and node.module
        for alias in node.names
    }
    used |= {
        f"{node.value.id}.{node.attr}"
        for node in ast.walk(tree)
        if isinstance(node, ast.Attribute) and isinstance(node.value, ast.Name)
    }
    split = [name.split(".", 1) for name in used if name.split(".")[0] in doors]
    return {".".join(parts) for parts in split if len(parts) > 1 and parts[1] not in doors[parts[0]].__all__}


@pytest.mark.parametrize(("where", "code"), shown_code(), ids=[where for where, _ in shown_code()])
def test_pages_and_examples_use_public_names_only(where: str, code: str) -> None:
    assert private_names(code) == set()


def test_a_private_name_is_found() -> None:
    code = "import twin.job\nfrom twin import replay, jit\nfrom gcode.events import Event\ntwin.simulation\ntwin.replay"
    assert private_names(code) == {"twin.job", "twin.jit", "gcode.events.Event", "twin.simulation"}
