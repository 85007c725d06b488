"""Numbers that are hardly meant get one line each; sound programs get none."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

from tests.support.job_files import job_data
from twin.job import job_from_dict
from twin.record import RunSummary
from twin.run.plausibility import Plausibility
from twin.run.watch import Watch
from twin.simulation.replay import Replay

SLOT = "T1 M6\nS3600 M3\nG54 G0 X-6 Y15 Z5\nG1 Z-2 F600\nX66\nM30\n"


def doubts(folder: Path, program: str = SLOT, **changes: Any) -> list[str]:
    """The lines for a program that cuts a slot with a ball of 8 mm, in a stock of 60 mm."""
    (folder / "slot.nc").write_text(program)
    plausibility = Plausibility()
    values = {"simulation__axial_step_mm": 2.0, "simulation__angle_step_deg": 30.0, **changes}
    with Replay(job_from_dict(job_data(**values), folder), preview=False) as replay:
        for record in replay:
            plausibility.take(record)
    assert isinstance(record, RunSummary)
    return list(plausibility.warnings(record))


@pytest.mark.parametrize(
    ("old", "new", "changes", "expected"),
    [
        ("F600", "F600", {}, []),
        (
            "F600",
            "F20000",
            {},
            ["line 5: T1: a feed per tooth of 2.78 mm (F20000 S3600) is more than a quarter of the tool"],
        ),
        (
            "S3600",
            "S1",
            {},
            [
                "line 5: T1: a feed per tooth of 300 mm (F600 S1) is more than a quarter of the tool's radius, 4 mm",
                "line 5: T1: the tool travels 50 mm between two force samples, more than simulation.step_mm = 1",
            ],
        ),
        (
            "F600",
            "F1",
            {},
            ["line 5: T1: a feed per tooth of 0.000139 mm (F1 S3600) is below 0.001 mm"],
        ),
        (
            "F600",
            "F600",
            {"machine__max_feed_mm_min": 500.0},
            ["line 4: F600 is above machine.max_feed_mm_min"],
        ),
        (
            "F600",
            "F600",
            {"machine__max_spindle_rpm": 3000.0},
            ["line 4: S3600 is above machine.max_spindle_rpm = 3000"],
        ),
        ("F600", "F600", {"machine__rapid_mm_min": 500.0}, ["line 4: F600 is above machine.rapid_mm_min = 500"]),
    ],
)
def test_feeds_and_speeds_that_are_hardly_meant(
    tmp_path: Path, old: str, new: str, changes: dict[str, Any], expected: list[str]
) -> None:
    found = doubts(tmp_path, SLOT.replace(old, new), **changes)
    assert len(found) == len(expected)
    for line, start in zip(found, expected, strict=True):
        assert line.startswith(start)


def test_a_program_in_inches_that_is_read_as_mm(tmp_path: Path) -> None:
    inches = "T1 M6\nS3600 M3\nG54 G0 X0 Y0.6 Z1\nG1 Z-0.08 F600\nX2.3\nM30\n"
    (found,) = doubts(tmp_path, inches)
    assert found.startswith("the feed motions extend over 2.3 mm, the stock over 60 mm, and the program has no G20 or")
    assert found.endswith('program.units = "inch"')
    assert doubts(tmp_path, "G21\n" + inches) == []
    (found,) = doubts(tmp_path, SLOT.replace("X66", "X68"), program__units="inch", cutting__Ktc=900.0)[-1:]
    assert found.endswith('program.units = "mm"')


def test_removal_without_force(tmp_path: Path) -> None:
    none = dict.fromkeys(("Ktc", "Kte", "Krc", "Kre", "Kac", "Kae"), 0.0) | {"source": "none"}
    (found,) = doubts(tmp_path, cutting=none)
    assert "removed without any force" in found


def test_a_reversed_spindle_is_stated_and_no_error_of_a_strict_replay(tmp_path: Path) -> None:
    (tmp_path / "slot.nc").write_text(SLOT.replace("M3\n", "M4\n"))
    watch = Watch()
    with Replay(job_from_dict(job_data(simulation__axial_step_mm=2.0), tmp_path), preview=False) as replay:
        for record in replay:
            watch.take(record)
    assert isinstance(record, RunSummary)
    assert "line 5: T1 cuts under M4: it is taken for a left-hand cutting tool" in watch.warnings(record)[0]
    assert not watch.doubts(record)
