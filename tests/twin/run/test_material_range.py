"""Coefficients outside their range get one line for each tool; a material gives the forces of its numbers."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from support.job_files import job_data

from twin.job import job_from_dict
from twin.materials import find_material
from twin.record import RunSummary, Step
from twin.run.watch import Watch
from twin.simulation.replay import Replay

SLOT = "T1 M6\nS3600 M3\nG54 G0 X-6 Y15 Z5\nG1 Z-2 F600\nX30\nM30\n"


def run(folder: Path, cutting: dict[str, Any]) -> tuple[Watch, RunSummary, np.ndarray]:
    """A slot of a ball of 8 mm with some coefficients: 90.5 m/min, feed per tooth 0.083 mm."""
    (folder / "slot.nc").write_text(SLOT)
    data = job_data(cutting=cutting, simulation__axial_step_mm=2.0, simulation__angle_step_deg=30.0)
    watch, forces = Watch(), []
    with Replay(job_from_dict(data, folder), preview=False) as replay:
        for record in replay:
            watch.take(record)
            if isinstance(record, Step):
                forces.append(record.samples.force_n)
    assert isinstance(record, RunSummary)
    return watch, record, np.concatenate(forces)


def typed(name: str) -> dict[str, Any]:
    row = find_material(name)
    keys = ("Ktc", "Kte", "Krc", "Kre", "Kac", "Kae", "source")
    return {key: getattr(row, key) for key in keys}


def test_a_material_gives_the_forces_of_its_numbers(tmp_path: Path) -> None:
    named, summary, forces = run(tmp_path, {"material": "Al7075-T6"})
    _, _, by_hand = run(tmp_path, typed("Al7075-T6"))
    assert np.array_equal(forces, by_hand) and forces.any()
    assert named.header is not None
    held = {key: named.header.parameters[f"cutting.{key}"] for key in ("material", "source", "Ktc")}
    assert held == {"material": "Al7075-T6", "source": find_material("7075").source, "Ktc": "767.01"}
    assert [w for w in named.warnings(summary) if "states no range" in w] == [
        'cutting.material = "Al7075-T6": the source states no range of chip thickness and cutting speed'
    ]
    assert named.doubts(summary) == []


@pytest.mark.parametrize(
    ("ranges", "expected"),
    [
        ({"chip_range_mm": [0.0, 0.1], "speed_range_m_min": [50.0, 100.0]}, []),
        (
            {"chip_range_mm": [0.0, 0.05]},
            ["T1: 100 % of the engaged time is outside the range of the coefficients in cutting: largest uncut chip "],
        ),
        (
            {"chip_range_mm": [0.0, 0.1], "speed_range_m_min": [100.0, 200.0]},
            [
                "T1: 100 % of the engaged time is outside the range of the coefficients in cutting: "
                "cutting speed at the tool's diameter of 90.5 m/min (range 100 to 200)"
            ],
        ),
    ],
)
def test_outside_the_range(tmp_path: Path, ranges: dict[str, Any], expected: list[str]) -> None:
    watch, summary, _ = run(tmp_path, {**typed("Al7075-T6"), **ranges})
    found = watch.doubts(summary)
    assert len(found) == len(expected)
    assert all(line.startswith(start) for line, start in zip(found, expected, strict=True))


def test_a_row_of_the_table_is_checked_against_its_own_range(tmp_path: Path) -> None:
    watch, summary, _ = run(tmp_path, {"material": "AISI1045"})
    (line,) = watch.doubts(summary)
    assert line == (
        'T1: 100 % of the engaged time is outside the range of cutting.material = "C45": largest uncut chip '
        "thickness of 0.0589 mm (range 0 to 0.04); cutting speed at the tool's diameter of 90.5 m/min (range 37.7)"
    )


def test_an_order_of_magnitude_warns_at_every_use(tmp_path: Path) -> None:
    watch, summary, forces = run(tmp_path, {"material": "P6"})
    assert forces.any()
    assert any(
        line.startswith('cutting.material = "VDI 3323 group 6": order of magnitude only')
        for line in watch.warnings(summary)
    )
