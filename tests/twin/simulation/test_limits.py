"""Numbers of a job or program that would need memory or time without end are refused by name, or cost nothing."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

from tests.support.job_files import job_data, job_folder
from twin.errors import JobError, ReplayError, StockError
from twin.job import job_from_dict, load_job
from twin.record import Step
from twin.simulation.clock import SpindleClock
from twin.simulation.replay import Replay


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        (
            {"tools__0__flute_length_mm": 1e18},
            "flute_length_mm (tool 1) = 1e+18: expected a number above 0 and at most",
        ),
        ({"machine__rapid_mm_min": 1e-308}, "machine.rapid_mm_min = 1e-308: expected at least 0.001"),
        (
            {"machine__axis_rapid_mm_min": [1e4, 0, 1e4]},
            "machine.axis_rapid_mm_min[1] = 0: expected at least 0.001",
        ),
        (
            {"program__dialect": "grbl", "machine__axis_rapid_mm_min": [1e4, 1e4, 1e4]},
            'expected it only with machine.rapid = "independent"',
        ),
        ({"simulation__axial_step_mm": 1e-7}, "simulation.axial_step_mm = 1e-07: expected at least 0.0014, finer edge"),
        ({"simulation__step_mm": 1e-6}, "simulation.step_mm = 1e-06: expected at least 0.005, a hundredth of"),
        ({"simulation__angle_step_deg": 1e-6}, "simulation.angle_step_deg = 1e-06: expected at least 0.01"),
        ({"simulation__preview_pitch_mm": 1e-6}, "simulation.preview_pitch_mm = 1e-06: expected at least 0.03, 2000"),
        ({"simulation__slice_pitch_mm": 1e-4}, "simulation.slice_pitch_mm = 0.0001: expected at least 0.0031, finer"),
        (
            {
                "simulation__slice_pitch_mm": 1e-4,
                "stock": {"cylinder_mm": {"axis": "x", "centre": [0, 0], "diameter": 60, "min": 0, "max": 60}},
            },
            "simulation.slice_pitch_mm = 0.0001: expected at least 0.0046, finer",
        ),
    ],
)
def test_numbers_that_need_memory_without_end_are_named(tmp_path: Path, changes: dict[str, Any], message: str) -> None:
    with pytest.raises(JobError) as caught:
        load_job(job_folder(tmp_path, **changes))
    assert message in str(caught.value)


def replay(folder: Path, program: str, **changes: Any) -> list[Step]:
    (folder / "slot.nc").write_text("T1 M6\nS10000 M3\nG54 G0 X-20 Y15\n" + program + "\nM30\n")
    with Replay(job_from_dict(job_data(**changes), folder), preview=False) as run:
        return [record for record in run if isinstance(record, Step)]


def test_a_day_of_dwell_costs_two_samples(tmp_path: Path) -> None:
    dwell = replay(tmp_path, "G4 X86400.")[-1]
    assert dwell.duration_s == 86400.0
    assert len(dwell.samples.t_s) == 2


def test_the_first_and_the_last_sample_are_those_of_all() -> None:
    for seconds in (0.0001, 0.0013, 7.3):
        clocks = SpindleClock(7), SpindleClock(7)
        for clock in clocks:
            clock.advance(0.0, 0.0123, 1000.0)
        every, ends = (c.advance(1.0, seconds, -900.0, ends_only=i == 1) for i, c in enumerate(clocks))
        for a, b in zip(every, ends, strict=True):
            assert (a[[0, -1]] if len(a) > 2 else a).tolist() == b.tolist()


@pytest.mark.parametrize(
    ("program", "message"),
    [
        ("G1 X70 F1e-12", r"slot.nc:4: 90 mm in 5.4e\+15 s; expected a motion or dwell below 1e\+07 mm and 1e\+09 s"),
        ("G1 Z-2 X1e7 F1000", r"slot.nc:4: 1e\+07 mm in"),
        (
            "G1 X9e6 Z-2 F1000",
            r"slot.nc:4: a motion of 9e\+07 steps; expected at most 1e\+07, a larger simulation.step",
        ),
        ("G1 Z-2 X0 F0.0001", r"slot.nc:4: .* force samples in one step at F0.0001 S10000; expected at most 5e\+06"),
    ],
)
def test_motions_without_end_are_refused_at_their_line(tmp_path: Path, program: str, message: str) -> None:
    program = program.replace("1e-12", "0.000000000001")
    program = program.replace("1e7", "10000000.").replace("9e6", "9000000.")
    with pytest.raises(ReplayError, match=message):
        replay(tmp_path, program, simulation__step_mm=0.1)


def test_the_slices_of_a_mesh_are_limited_too() -> None:
    from twin.workpiece.stock import box_slices

    with pytest.raises(StockError, match=r"slice pitch 0.001 mm; expected at least 0.077 mm"):
        box_slices([0, 0, 0], [1000, 1000, 1000], 0.001)
