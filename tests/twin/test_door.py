"""`import twin`: light, complete, and typed as it behaves."""

from __future__ import annotations

import ast
import importlib
import json
import subprocess
import sys
from pathlib import Path

import pytest

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
