"""Programs of other people, read from the directory that TWIN_REFERENCE_DIR names; skipped where it is not set.

Layout: ``reference/gcode/NAME/*.ngc`` (or ``gcode/NAME``) with ``expected_motions.json`` or ``expected_error.txt``,
made by LinuxCNC on an inch machine, and ``nc/*.NC``. A case whose language is not covered is skipped with the refusal.
"""

from __future__ import annotations

import json
import math
import os
import re
from pathlib import Path
from typing import Any

import pytest

from gcode.dialects import LINUXCNC
from gcode.errors import GcodeError
from gcode.events import ArcMotion, LinearMotion, Motion
from gcode.interpret import check, interpret, interpret_file
from gcode.settings import MachineSettings
from gcode.source import read_program

TOLERANCE_MM = 0.005
ROOT = Path(os.environ.get("TWIN_REFERENCE_DIR", "/nonexistent"))
GCODE = next((p for p in (ROOT / "reference" / "gcode", ROOT / "gcode") if p.is_dir()), None)
CASES = sorted(p.name for p in GCODE.iterdir()) if GCODE else []
NOT_COVERED = {"unsupported-macro", "unsupported-code", "unsupported-word"}
#: Cases that are covered whatever else is: without these the comparison below would prove nothing.
COVERED = {"interp__good__good-arc.medium.metric.center-format"}
ORIGIN = (0.0, 0.0, 0.0)

pytestmark = pytest.mark.skipif(GCODE is None, reason="TWIN_REFERENCE_DIR names no directory with gcode cases")


def without_constant_expressions(line: str) -> str:
    """Puts the value of ``[a * b]`` in its place; the case that is meant tests an arc, not expressions."""
    return re.sub(r"\[([\d.]+) \* ([\d.]+)\]", lambda m: f"{float(m[1]) * float(m[2]):.9g}", line)


def start_units_mm() -> MachineSettings:
    return MachineSettings(offsets={f"G{n}": ORIGIN for n in range(54, 60)})


def motions_of(path: Path) -> list[Motion]:
    lines = map(without_constant_expressions, read_program(path))
    events = interpret(lines, file=path.name, dialect=LINUXCNC, settings=start_units_mm())
    return [event for event in events if isinstance(event, LinearMotion | ArcMotion)]


def moving(expected: list[dict[str, Any]]) -> list[dict[str, Any]]:
    """The expected motions that go anywhere; LinuxCNC lists those that do not, too."""
    at, kept = ORIGIN, []
    for motion in expected:
        if motion["t"] == "arc" or math.dist(at, motion["end"]) > 1e-6:
            kept.append(motion)
        at = motion["end"]
    return kept


def assert_same(motion: Motion, expected: dict[str, Any]) -> None:
    assert math.dist(motion.end_mm, expected["end"]) < TOLERANCE_MM
    assert motion.state.tool == expected["tool"]
    if isinstance(motion, ArcMotion):
        assert expected["t"] == "arc"
        assert (motion.plane, motion.turns) == (expected["plane"], expected["rot"])
        assert math.dist(motion.centre_mm, expected["centre"]) < TOLERANCE_MM
    else:
        assert expected["t"] == ("rapid" if motion.rapid else "feed")
    if expected["t"] != "rapid":
        assert math.isclose(motion.feed_mm_min, expected["feed"], rel_tol=1e-4)


@pytest.mark.parametrize("name", CASES)
def test_reference_case(name: str) -> None:
    assert GCODE is not None
    (program,) = (GCODE / name).glob("*.ngc")
    if (GCODE / name / "expected_error.txt").exists():
        lines = map(without_constant_expressions, read_program(program))
        assert check(lines, file=program.name, dialect=LINUXCNC, settings=start_units_mm())
        return
    try:
        motions = motions_of(program)
    except GcodeError as error:
        if error.code in NOT_COVERED and name not in COVERED:
            pytest.skip(f"not covered: {error}")
        raise
    expected = moving(json.loads((GCODE / name / "expected_motions.json").read_text()))
    assert len(motions) == len(expected)
    for motion, wanted in zip(motions, expected, strict=True):
        assert_same(motion, wanted)


@pytest.mark.parametrize(
    ("name", "centres", "lines", "arcs"),
    [
        ("PARALLEL.NC", "incremental", 3658, 60),
        ("BOTTLE.NC", "absolute", 1399, 2051),
        ("G17_18_19.NC", "incremental", 10, 3),
    ],
)
def test_real_programs_run_whole(name: str, centres: Any, lines: int, arcs: int) -> None:
    path = ROOT / "nc" / name
    if not path.exists():
        pytest.skip(f"{path} is not there")
    settings = MachineSettings(
        length_offsets_mm={1: 100.0, 3: 90.0},
        home_mm=(0.0, 0.0, 400.0),
        start_mm=(0.0, 0.0, 400.0),
        arc_centres=centres,
    )
    events = list(interpret_file(path, settings=settings))
    assert sum(isinstance(event, LinearMotion) for event in events) == lines
    assert sum(isinstance(event, ArcMotion) for event in events) == arcs
    assert check(read_program(path), settings=settings) == []
