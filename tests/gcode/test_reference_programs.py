"""Programs of other people, which may not be copied: see `support.reference`."""

from __future__ import annotations

import json
import math
import shutil
from pathlib import Path
from typing import Any

import pytest
from support.reference import GCODE, NC
from support.rs274 import RS274, Move, moves_of, rows_of, run
from support.rs274_compare import our_moves, settings_of, timed

from gcode.errors import GcodeError
from gcode.events import ArcMotion, LinearMotion
from gcode.flow.interpreter import check, interpret_file
from gcode.language.program import read_program
from gcode.settings import MachineSettings, ToolOffset

#: The expected motions were read from text with four decimals of an inch.
TOLERANCE_MM = 0.005
CASES = sorted(p.name for p in GCODE.iterdir()) if GCODE.is_dir() else []

pytestmark = pytest.mark.skipif(not CASES, reason="TWIN_REFERENCE_DIR does not hold it")


def files_of(name: str) -> tuple[Path, Path | None]:
    """The program of a case and its tool table."""
    (program,) = (GCODE / name).glob("*.ngc")
    return program, next((GCODE / name).glob("*.tbl"), None)


def assert_expected(name: str, moves: list[Move]) -> None:
    expected = json.loads((GCODE / name / "expected_motions.json").read_text())
    assert len(moves) == len(expected)
    for number, (move, wanted) in enumerate(zip(moves, expected, strict=True)):
        assert_same(move, wanted, f"motion {number}: {move}, expected {wanted}")


def assert_same(move: Move, wanted: dict[str, Any], said: str) -> None:
    assert move.kind == wanted["t"], said
    assert math.dist(move.end, wanted["end"]) < TOLERANCE_MM, said
    assert math.dist(move.abc, wanted["abc"]) < TOLERANCE_MM, said
    assert (move.tool, move.rpm, move.direction) == (wanted["tool"], wanted["s"], wanted["sdir"]), said
    assert (move.plane, move.turns) == (wanted.get("plane", 0), wanted.get("rot", 0)), said
    assert move.kind == "rapid" or math.isclose(move.feed, wanted["feed"], rel_tol=1e-4), said
    if move.kind == "arc":
        assert math.dist(move.centre, wanted["centre"]) < TOLERANCE_MM, said


@pytest.mark.parametrize("name", CASES)
def test_reference_case(name: str) -> None:
    program, table = files_of(name)
    if (GCODE / name / "expected_error.txt").exists():
        with pytest.raises(GcodeError):
            our_moves(program, settings_of(table))
        return
    assert_expected(name, timed(our_moves(program, settings_of(table))))


@pytest.mark.parametrize("name", CASES)
@pytest.mark.skipif(RS274 is None, reason="rs274 is not installed")
def test_reading_rs274_gives_the_expected_motions(name: str, tmp_path: Path) -> None:
    """The comparisons with ``rs274`` elsewhere read its output as whoever made the expected motions did."""
    program, table = files_of(name)
    listing = run(Path(shutil.copy(program, tmp_path)), table=table)
    if (GCODE / name / "expected_error.txt").exists():
        assert (GCODE / name / "expected_error.txt").read_text().strip() in listing.error
        return
    assert_expected(name, timed(moves_of(listing.calls, rows_of(table))))


@pytest.mark.parametrize(
    ("name", "centres", "lines", "arcs"),
    [
        ("PARALLEL.NC", "incremental", 3658, 60),
        ("BOTTLE.NC", "absolute", 1399, 2051),
        ("G17_18_19.NC", "incremental", 10, 3),
    ],
)
def test_real_programs_run_whole(name: str, centres: Any, lines: int, arcs: int) -> None:
    path = NC / name
    if not path.exists():
        pytest.skip(f"{path} is not there")
    settings = MachineSettings(
        tools={1: ToolOffset(length_mm=100.0), 3: ToolOffset(length_mm=90.0)},
        home_mm=(0.0, 0.0, 400.0),
        start_mm=(0.0, 0.0, 400.0),
        arc_centres=centres,
    )
    events = list(interpret_file(path, settings=settings))
    moving = [e for e in events if isinstance(e, LinearMotion) and math.dist(e.start_mm, e.end_mm) > 0.0]
    assert len(moving) == lines
    assert sum(isinstance(event, ArcMotion) for event in events) == arcs
    assert check(read_program(path), settings=settings) == []
