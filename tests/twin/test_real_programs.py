"""Programs of other people, read from a folder that the environment names; nothing in them is special-cased.

They may not be copied, so these tests run only where ``TWIN_REFERENCE_DIR`` holds ``nc/PARALLEL.NC`` and others.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest
from support.reference import NC

from twin.archive import read_forces, run_info
from twin.job import job_from_dict
from twin.record import RunSummary
from twin.simulation.replay import Replay
from twin.sinks.mcap_sink import McapSink

STEEL = {"Ktc": 1900.0, "Kte": 22.0, "Krc": 700.0, "Kre": 45.0, "Kac": 400.0, "Kae": 2.0, "source": "test"}

JOBS: dict[str, dict[str, Any]] = {
    # an inch program: ball end mill D 0.125 in, as its comment says; stock around its path
    "PARALLEL.NC": {
        "program": {"file": "PARALLEL.NC"},
        "stock": {"box_mm": {"min": [-1.0, -1.0, -17.0], "max": [39.5, 40.0, 0.0]}},
        "tools": [
            {
                "number": 3,
                "kind": "ball",
                "diameter_mm": 3.175,
                "teeth": 2,
                "helix_deg": 30.0,
                "flute_length_mm": 18.0,
                "length_mm": 60.0,
            }
        ],
        "simulation": {"slice_pitch_mm": 0.4, "step_mm": 0.8, "axial_step_mm": 0.4, "angle_step_deg": 10.0},
    },
    # a mm program with absolute arc centres: spherical end mill D 10
    "BOTTLE.NC": {
        "program": {"file": "BOTTLE.NC", "arc_centres": "absolute"},
        "stock": {"box_mm": {"min": [-46.0, -46.0, -30.0], "max": [46.0, 46.0, 0.0]}},
        "tools": [
            {"number": 2, "kind": "ball", "diameter_mm": 10.0, "teeth": 2, "helix_deg": 30.0, "flute_length_mm": 30.0}
        ],
        "simulation": {"slice_pitch_mm": 1.0, "step_mm": 4.0, "axial_step_mm": 1.0, "angle_step_deg": 30.0},
    },
}


@pytest.mark.parametrize("name", JOBS)
def test_a_real_program_replays_with_forces_and_archive(name: str, tmp_path: Path) -> None:
    if not (NC / name).is_file():
        pytest.skip("TWIN_REFERENCE_DIR does not hold it")
    data = {**JOBS[name], "cutting": STEEL}
    data["program"] = {**data["program"], "file": str(NC / name)}
    archive = tmp_path / "run.mcap"
    with Replay(job_from_dict(data, tmp_path)) as replay, McapSink(archive) as sink:
        before = replay.workpiece.volume_mm3(2)
        for record in replay:
            sink.write(record)
        removed = before - replay.workpiece.volume_mm3(2)
    assert isinstance(record, RunSummary)
    assert record.complete
    assert record.machine_time_s == pytest.approx(replay.planned_time_s)
    assert record.removed_volume_mm3 == pytest.approx(removed, rel=0.02)
    assert record.removed_volume_mm3 > 1000.0
    assert record.cutting_time_s > 0.3 * record.machine_time_s
    assert record.peak_force_n[3] > record.mean_force_n[3] > 0.0
    assert run_info(archive).complete
    assert read_forces(archive).num_rows == record.samples
