"""`import gcode`: light, complete, and typed as it behaves."""

from __future__ import annotations

import ast
import importlib
import json
import subprocess
import sys
from pathlib import Path

import pytest

import gcode

ROOT = Path(__file__).parents[2]
PROGRAM = "G21 G90 G54\nT1 M6\nS1000 M3\nG0 X0 Y0 Z5\nG1 Z-1 F100\nG3 X0 Y0 I5 J0\nM30\n"
#: Public names without a docstring of their own.
PLAIN_DATA = {"DIALECTS", "PLANE_AXES", "Event", "Motion", "Plane", "Point", "ProgramSource"}


def typed_names() -> set[str]:
    """Names that type checkers see: imported under TYPE_CHECKING."""
    tree = ast.parse(Path(gcode.__file__ or "").read_text(encoding="utf-8"))
    guarded = next(node for node in tree.body if isinstance(node, ast.If))
    return {alias.asname or alias.name for n in guarded.body if isinstance(n, ast.ImportFrom) for alias in n.names}


def test_importing_the_package_loads_nothing_else() -> None:
    text = "import json, sys, typing, importlib; old = {*sys.modules}; import gcode; new = {*sys.modules} - old"
    command = [sys.executable, "-c", f"{text}; print(json.dumps([sorted(new), dir(gcode)]))"]
    modules, names = json.loads(subprocess.run(command, check=True, capture_output=True, cwd=ROOT).stdout)
    assert modules == ["gcode"]
    assert set(gcode.__all__) <= set(names)


def test_every_public_name_is_there_and_typed() -> None:
    assert typed_names() == set(gcode.__all__)
    for name in gcode.__all__:
        assert getattr(gcode, name) is not None
    with pytest.raises(AttributeError, match="module 'gcode' has no attribute 'interprets'"):
        gcode.interprets  # noqa: B018


def test_no_module_shadows_a_public_name() -> None:
    folder = Path(gcode.__file__ or "").parent
    modules = {p.stem for p in folder.iterdir()}
    assert modules & set(gcode.__all__) == set()
    for module in modules - {"__init__", "__main__", "__pycache__", "py"}:
        importlib.import_module(f"gcode.{module}")
    assert all(callable(getattr(gcode, name)) for name in gcode.__all__ if name[0].islower())


def test_every_public_function_and_class_explains_itself() -> None:
    for name in set(gcode.__all__) - PLAIN_DATA:
        text = getattr(gcode, name).__doc__ or ""
        assert len(text.split()) > 3, name


def test_a_program_is_a_text_lines_a_path_or_read_before(tmp_path: Path) -> None:
    path = tmp_path / "part.nc"
    path.write_text(PROGRAM, encoding="ascii")
    sources = (PROGRAM, PROGRAM.encode(), PROGRAM.splitlines(), path, gcode.read_program(path))
    kinds = [[type(event) for event in gcode.interpret(source)] for source in sources]
    assert kinds == [kinds[0]] * len(sources)
    assert [type(event) for event in gcode.interpret_file(str(path))] == kinds[0]
    assert gcode.check(path) == []
    assert [len(part) for part in gcode.motion_arrays(path)] == [3]
    assert gcode.program_stats(gcode.interpret_file(path)).total.motions == {"rapid": 1, "feed": 1, "arc": 1}


def test_a_dialect_may_be_named() -> None:
    program = "o100 sub\nG1 X1 F100\no100 endsub\no100 call\nM2\n"
    (motion,) = (e for e in gcode.interpret(program, dialect="linuxcnc") if isinstance(e, gcode.LinearMotion))
    assert motion.end_mm == (1.0, 0.0, 0.0)
    with pytest.raises(ValueError, match="unknown dialect 'siemens'; expected one of fanuc, haas, linuxcnc, grbl"):
        gcode.check(program, dialect="siemens")


def test_a_program_is_written_again(tmp_path: Path) -> None:
    settings = gcode.MachineSettings(offsets={"G54": (100.0, 0.0, 0.0)}, tool=1)
    options = gcode.WriteOptions(dialect=gcode.LINUXCNC, units="inch", decimals=6)
    lines = gcode.rewrite(PROGRAM, tmp_path / "part.ngc", options, settings=settings)
    written = (tmp_path / "part.ngc").read_text(encoding="ascii").splitlines()
    assert (len(written), written[0].split()[0]) == (lines, "G20")
    old, new = (
        [e.end_mm for e in events if isinstance(e, gcode.LinearMotion | gcode.ArcMotion)]
        for events in (
            gcode.interpret(PROGRAM, settings=settings),
            gcode.interpret_file(tmp_path / "part.ngc", dialect="linuxcnc", settings=settings),
        )
    )
    assert new == [pytest.approx(end, abs=3e-5) for end in old]
