"""Compiled code is kept outside the sources, found by the next process, and compiled again when it is damaged."""

from __future__ import annotations

import importlib.util
import os
import subprocess
import sys
import textwrap
from collections.abc import Callable
from pathlib import Path
from types import ModuleType
from typing import Any

import numba
import pytest

from twin.jit import compiled, kept_code, njit, sources
from twin.jit.store import Store, store

ROOT = Path(__file__).parents[3]

pytestmark = pytest.mark.skipif(bool(numba.config.DISABLE_JIT), reason="compiles")

KERNELS = """
    from typing import NamedTuple

    from twin.jit import helper, inlined, njit


    class Pair(NamedTuple):
        a: float
        b: float


    @njit
    def inner(x):
        return 2 * x


    @njit
    def outer(x):
        return inner(x) + 1


    @njit
    def total(pair):
        return pair.a + pair.b


    @inlined
    def half(x):
        return x / 2


    @helper
    def quarter(x):
        return half(half(x))


    @njit
    def eighth(x):
        return half(quarter(x))


    @njit
    def sixteenth(x):
        return quarter(quarter(x))
"""


@pytest.fixture
def kept(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """The folder that compiled code is kept in."""
    monkeypatch.setattr(numba.config, "CACHE_DIR", str(tmp_path / "cache"))
    return tmp_path / "cache" / "machining-twin"


@pytest.fixture
def source(tmp_path: Path) -> Path:
    path = tmp_path / "sources" / "some_kernels.py"
    path.parent.mkdir()
    path.write_text(textwrap.dedent(KERNELS))
    return path


def fresh(path: Path, monkeypatch: pytest.MonkeyPatch) -> ModuleType:
    """The module imported anew, as another process would."""
    spec = importlib.util.spec_from_file_location("some_kernels", path)
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    monkeypatch.setitem(sys.modules, "some_kernels", module)
    monkeypatch.setattr(sys, "dont_write_bytecode", True)
    spec.loader.exec_module(module)
    return module


def hits(function: Callable[..., Any]) -> int:
    return sum(function.stats.cache_hits.values())  # type: ignore[attr-defined]


def files_in(folder: Path) -> set[str]:
    return {p.relative_to(folder).as_posix() for p in folder.rglob("*") if p.is_file()}


def test_the_second_process_compiles_nothing(kept: Path, source: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    first = fresh(source, monkeypatch)
    assert first.outer(2.0) == 5.0
    assert first.outer(2) == 5
    assert hits(first.outer) == 0
    second = fresh(source, monkeypatch)
    assert second.outer(2.0) == 5.0
    assert second.outer(2) == 5
    assert hits(second.outer) == 2
    assert Path(second.outer.stats.cache_path).is_relative_to(kept)


def test_helpers_are_kept_for_other_callers(kept: Path, source: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    assert fresh(source, monkeypatch).eighth(16.0) == 2.0
    again = fresh(source, monkeypatch)
    assert again.sixteenth(16.0) == 1.0
    assert hits(again.quarter) == 1
    assert hits(again.half) == 0  # part of quarter


@pytest.mark.parametrize("name", ["half", "quarter"])
def test_python_cannot_call_helpers(name: str, kept: Path, source: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    module = fresh(source, monkeypatch)
    with pytest.raises(TypeError, match=f"{name} can be called from compiled code only"):
        getattr(module, name)(2.0)
    assert module.eighth(16.0) == 2.0
    with pytest.raises(TypeError, match="compiled code only"):
        getattr(module, name)(2.0)


def test_nothing_is_written_next_to_the_sources(kept: Path, source: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    fresh(source, monkeypatch).outer(2.0)
    assert files_in(source.parent) == {source.name}
    assert len(files_in(kept)) == 2  # inner and outer


def test_kernels_of_the_package_keep_their_code_elsewhere() -> None:
    from twin.tools import meridian_kernels

    functions = [f for f in vars(meridian_kernels).values() if isinstance(f, numba.core.dispatcher.Dispatcher)]
    assert functions
    for function in functions:
        assert isinstance(function._cache, kept_code.KeptCode)
        assert not Path(function.stats.cache_path).is_relative_to(ROOT / "twin")


def test_a_change_of_the_source_compiles_again(kept: Path, source: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    assert fresh(source, monkeypatch).outer(2.0) == 5.0
    source.write_text(source.read_text().replace("2 * x", "3 * x"))
    sources.source_hash.cache_clear()
    sources._read.cache_clear()
    assert fresh(source, monkeypatch).outer(2.0) == 7.0


def test_another_version_of_the_package_has_its_own_folder(
    kept: Path, source: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("twin.jit.compiled.__version__", "8.0")
    fresh(source, monkeypatch).inner(2.0)
    monkeypatch.setattr("twin.jit.compiled.__version__", "9.0")
    again = fresh(source, monkeypatch)
    again.inner(2.0)
    assert hits(again.inner) == 0
    assert sorted(p.name for p in kept.iterdir()) == ["8.0", "9.0"]


@pytest.mark.parametrize("damage", [b"", b"\x00" * 40, None], ids=["empty", "zeros", "cut off"])
def test_damaged_files_are_compiled_again(
    damage: bytes | None, kept: Path, source: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    fresh(source, monkeypatch).outer(2.0)
    for file in kept.rglob("*.code"):
        whole = file.read_bytes()
        file.write_bytes(whole[: len(whole) // 2] if damage is None else damage)
    again = fresh(source, monkeypatch)
    assert again.outer(2.0) == 5.0
    assert hits(again.outer) == 0
    third = fresh(source, monkeypatch)
    assert third.outer(2.0) == 5.0
    assert hits(third.outer) == 1


def test_whole_files_with_unknown_contents_are_compiled_again(
    kept: Path, source: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    fresh(source, monkeypatch).inner(2.0)
    file = next(kept.rglob("*.code"))
    store(str(kept.parent)).write(file.parent.relative_to(kept).as_posix(), file.name, b"not a pickle")
    assert fresh(source, monkeypatch).inner(2.0) == 4.0


def test_tuples_of_one_name_and_other_fields_are_not_mixed_up(
    kept: Path, source: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    module = fresh(source, monkeypatch)
    assert module.total(module.Pair(1.0, 2.0)) == 3.0
    other = fresh(source, monkeypatch)
    assert other.total(other.Pair(3.0, 4.0)) == 7.0  # the class is another one, its name is not


def test_a_folder_that_cannot_be_written_costs_the_compilation_only(
    tmp_path: Path, source: Path, monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture
) -> None:
    (tmp_path / "file").write_text("")
    monkeypatch.setattr(numba.config, "CACHE_DIR", str(tmp_path / "file"))
    monkeypatch.setattr("tempfile.tempdir", str(tmp_path / "file"))
    assert fresh(source, monkeypatch).outer(2.0) == 5.0
    assert len(caplog.messages) == 1
    assert "NUMBA_CACHE_DIR" in caplog.messages[0]


def test_a_numba_with_other_internals_keeps_code_by_itself(
    kept: Path, source: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(compiled, "_KEPT_CODE", None)
    assert fresh(source, monkeypatch).outer(2.0) == 5.0
    again = fresh(source, monkeypatch)
    assert again.outer(2.0) == 5.0
    assert hits(again.outer) == 1
    assert again.eighth(16.0) == 2.0
    assert files_in(source.parent) == {source.name}
    assert any(name.endswith(".nbi") for name in files_in(kept))
    assert str(kept.parent) == numba.config.CACHE_DIR


def test_a_function_without_a_source_is_compiled_and_not_kept(kept: Path) -> None:
    names: dict[str, Any] = {}
    exec("def twice(x):\n    return 2 * x\n", names)
    assert njit(names["twice"])(2.0) == 4.0
    assert not kept.exists()


WRITE_AT_ONCE = """
import sys
from some_kernels import outer
from twin.jit.store import Store

number = int(sys.argv[1])
for kind in (float, int) if number % 2 else (int, float):
    assert outer(kind(number)) == 2 * number + 1
"""


def test_processes_that_compile_at_the_same_time(tmp_path: Path, source: Path) -> None:
    named = {**os.environ, "NUMBA_CACHE_DIR": str(tmp_path / "cache")}
    named["PYTHONPATH"] = os.pathsep.join([str(source.parent), str(ROOT)])
    started = [
        subprocess.Popen([sys.executable, "-c", WRITE_AT_ONCE, str(i)], env=named, stderr=subprocess.PIPE)
        for i in range(3)
    ]
    assert [(p.communicate()[1], p.returncode) for p in started] == [(b"", 0)] * 3
    code = [p for p in files_in(tmp_path / "cache") if p.endswith(".code")]
    assert len(code) == 4  # two functions, two signatures
    files = Store(store(str(tmp_path / "cache"))._roots)
    assert all(files.read(*p.removeprefix("machining-twin/").rsplit("/", 1)) for p in code)


def test_without_the_compiler_functions_stay_as_they_are(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(numba.config, "DISABLE_JIT", 1)

    def twice(x: float) -> float:
        return 2 * x

    assert njit(twice) is twice
