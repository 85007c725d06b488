from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest
from support.rs274 import RS274

from gcode.dialects import dialect_named
from gcode.events import ArcMotion, LinearMotion
from gcode.flow.interpreter import interpret_file
from gcode.report.path_geometry import points_mm
from gcode.settings import MachineSettings, ToolOffset
from twin.cam.path.arc_fit import FitOptions, fit_path
from twin.cam.path.linking import LinkOptions, Pass, link
from twin.cam.path.to_nc import NcOptions, Operation, describe, plain_comment, write_nc
from twin.cam.path.toolpath import ToolPath
from twin.errors import ToolPathError
from twin.tools.shape import tool_shape

BALL = tool_shape("ball", 8.0, 20.0)
#: Rounding to four decimals, half a count an axis.
ROUNDING = 0.5e-4 * math.sqrt(3.0) + 1e-9


def domes(arcs: bool) -> ToolPath:
    """Rows over a dome, entered by helices, with leads."""
    x = np.linspace(-10.0, 10.0, 301)
    passes = [
        Pass(points_mm=np.column_stack((x, np.full_like(x, y), np.sqrt(225.0 - x * x) - 15.0)), top_mm=1.0)
        for y in (0.0, 1.0, 2.0)
    ]
    moves = link(passes, LinkOptions(safe_z_mm=12.0, entry="helix", helix_mm=2.0))
    path = ToolPath(moves=moves, tool=BALL, name="scan (test)", notes=("step 1 mm",))
    return fit_path(path, FitOptions(tolerance_mm=0.001)) if arcs else path


@pytest.mark.parametrize("dialect", ["fanuc", "haas", "linuxcnc", "grbl"])
@pytest.mark.parametrize("arcs", [False, True])
def test_programs_read_back_to_the_same_path(tmp_path: Path, dialect: str, arcs: bool) -> None:
    path = domes(arcs)
    file = tmp_path / "a.nc"
    write_nc(file, [Operation(path=path, spindle_rpm=3600.0, coolant="off")], NcOptions(dialect=dialect))  # type: ignore[arg-type]
    settings = MachineSettings(tools={1: ToolOffset(length_mm=0.0, radius_mm=4.0)}, tool=int(dialect == "grbl"))
    events = list(interpret_file(file, dialect=dialect_named(dialect), settings=settings))
    motions = [e for e in events if isinstance(e, LinearMotion | ArcMotion)]
    assert {m.state.spindle_rpm for m in motions} == {3600.0} and {m.state.spindle_direction for m in motions} == {1}
    made = np.concatenate([np.array(points_mm(m, 1e-4)) for m in motions if isinstance(m, ArcMotion) or not m.rapid])
    wanted = np.concatenate([m.chords_mm(1e-4) for m in path.moves if not m.rapid])
    nearest = np.min(np.linalg.norm(wanted[::7, None] - made[None], axis=2), axis=1)
    spacing = np.linalg.norm(np.diff(made, axis=0), axis=1)
    assert nearest.max() <= 0.5 * spacing.max() + ROUNDING + 2e-4
    ends = np.array([m.end_mm for m in path.moves])
    named = np.array([m.end_mm for m in motions])
    assert np.min(np.linalg.norm(ends[:, None] - named[None], axis=2), axis=1).max() <= ROUNDING
    assert sum(isinstance(m, ArcMotion) for m in motions) >= (3 if arcs else 0)


@pytest.mark.skipif(RS274 is None, reason="rs274 is not installed")
def test_linuxcnc_takes_the_program(tmp_path: Path) -> None:
    import os
    import subprocess

    file = tmp_path / "a.ngc"
    write_nc(file, [Operation(path=domes(True), spindle_rpm=3600.0)], NcOptions(dialect="linuxcnc"))
    (tmp_path / "tool.tbl").write_text("T1 P1 Z0.0 D0.3 ;\n")
    assert RS274 is not None
    ran = subprocess.run(
        [RS274, "-t", "tool.tbl", "-g", str(file)],
        cwd=tmp_path,
        env={**os.environ, "HOME": str(tmp_path)},
        capture_output=True,
        text=True,
        timeout=60,
        check=False,
    )
    assert ran.returncode == 0, ran.stderr
    assert ran.stdout.count("ARC_FEED") >= 6 and "PROGRAM_END" in ran.stdout


def test_the_header_says_what_it_is(tmp_path: Path) -> None:
    file = tmp_path / "a.nc"
    write_nc(file, [Operation(path=domes(True), spindle_rpm=3600.0)], NcOptions(header=("part (one)",)))
    lines = file.read_text().splitlines()
    assert lines[1:4] == ["(part [one])", "(T1: ball D8, S3600: scan [test])", "(step 1 mm)"]
    assert lines[5:8] == ["T1 M6", "S3600 M3", "M8"]
    assert lines[8].startswith("G43 H1 G0 ")
    assert lines[-4:-1] == ["M9", "M5", "M30"]


def test_two_tools_are_changed_and_grbl_refuses_them(tmp_path: Path) -> None:
    path = domes(True)
    both = [Operation(path=path, spindle_rpm=3600.0), Operation(path=path, number=2, spindle_rpm=5000.0)]
    write_nc(tmp_path / "a.nc", both, NcOptions())
    text = (tmp_path / "a.nc").read_text()
    assert "T2 M6\nS5000 M3\nM8\nG43 H2 X-11.8186 Y2.8323 Z12.\n" in text
    with pytest.raises(ToolPathError, match=r"grbl has no tool change: tools \[1, 2\]; expected one tool"):
        write_nc(tmp_path / "b.nc", both, NcOptions(dialect="grbl"))
    assert not (tmp_path / "b.nc").exists()


def test_an_empty_path_makes_no_file(tmp_path: Path) -> None:
    empty = ToolPath(moves=(), tool=BALL)
    with pytest.raises(ToolPathError, match="no file is written, for the tool path is empty"):
        write_nc(tmp_path / "a.nc", [Operation(path=empty, spindle_rpm=100.0)], NcOptions())
    assert list(tmp_path.iterdir()) == []


def test_comments_are_what_controls_take() -> None:
    assert plain_comment("a (b) 3 µm² é") == "a [b] 3 um2 ?"
    assert describe(tool_shape("bull", 12.0, 30.0, 2.0)) == "bull D12 rc2"
