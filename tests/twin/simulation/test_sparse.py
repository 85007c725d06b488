"""Engagement without forces, found at some steps, next to that with forces, found at each."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

from twin.job import job_from_dict
from twin.record import Step
from twin.simulation.replay import Replay

CUTTING = {"Ktc": 900.0, "Kte": 2.0, "Krc": 400.0, "Kre": 2.0, "Kac": 0.0, "Kae": 0.0, "source": "of no material"}


def steps(folder: Path, blocks: str, **tables: Any) -> list[Step]:
    (folder / "cut.nc").write_text(f"G21 G90 G94\nT1 M6\nS3000 M3\nG0 X-6 Y5\nG43 H1 Z5\nZ-1\n{blocks}\nM30\n")
    shape = {"kind": "flat", "diameter_mm": 6.0, "teeth": 2, "helix_deg": 30.0, "flute_length_mm": 12.0}
    data = {
        "program": {"file": "cut.nc"},
        "stock": {"box_mm": {"min": [0, 0, -4], "max": [16, 10, 0]}},
        "tools": [{"number": 1, **shape, "length_mm": 80.0}],
        "simulation": {"slice_pitch_mm": 0.4, "step_mm": 0.4, "axial_step_mm": 0.4, "angle_step_deg": 6.0},
        **tables,
    }
    with Replay(job_from_dict(data, folder), threads=1, preview=False) as run:
        return [record for record in run if isinstance(record, Step) and not record.rapid]


@pytest.mark.parametrize(
    "blocks", ["G1 X24 F600", "G1 X6 F600\nX8 Y6\nX10\nX12 Y3\nX24", "G1 Z-2 X4 F600\nX12 Z-1\nX24 Z-3"]
)
def test_engagement_without_forces_is_that_with_forces_nearly(tmp_path: Path, blocks: str) -> None:
    every, some = steps(tmp_path, blocks, cutting=CUTTING), steps(tmp_path, blocks)
    assert [step.end_mm for step in every] == [step.end_mm for step in some]
    assert [step.engagement.cutting for step in every] == [step.engagement.cutting for step in some]
    for one, other in zip(every, some, strict=True):
        a, b = one.engagement.radial_width_mm, other.engagement.radial_width_mm
        assert abs(a - b) <= 0.4 + 0.2 * a
