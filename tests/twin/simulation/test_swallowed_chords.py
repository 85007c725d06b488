"""Turns of a helix that later ones swallow are not subtracted, and nothing differs for it."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from twin.job import job_from_dict
from twin.record import Step
from twin.simulation import material
from twin.simulation.replay import Replay

TOOL = {"number": 1, "teeth": 2, "helix_deg": 30.0, "flute_length_mm": 4.0, "length_mm": 80.0}
DOWN = "".join(f"G3 X12 Y10 I-2 Z{-0.1 * k:.1f}\n" for k in range(1, 13))
FINE = "G3 X12 Y10 I-2 Z-0.6 P30\n"
PROGRAMS = {
    "down, then up, then down again": DOWN + "G3 X12 Y10 I-2 Z-0.3\nG3 X12 Y10 I-2 Z-1.5\n",
    "one arc of many turns": "G3 X12 Y10 I-2 Z-1.2 P12\n",
    "two places in turns": "".join(
        f"G3 X12 Y10 I-2 Z{-0.1 * k:.1f}\nG0 Z1\nG0 X20\nG1 Z0\nG3 I-2 Z{-0.1 * k:.1f}\nG0 Z1\nG0 X12\nG1 Z0\n"
        for k in range(1, 4)
    ),
    "away and back": DOWN + "G1 X16\nG1 X12\n" + "G3 X12 Y10 I-2 Z-1.3\nG3 X12 Y10 I-2 Z-1.4\n",
}
TOOLS: dict[str, dict[str, Any]] = {
    "flat": {"kind": "flat", "diameter_mm": 6.0},
    "ball": {"kind": "ball", "diameter_mm": 6.0},
    "bull": {"kind": "bull", "diameter_mm": 6.0, "corner_radius_mm": 1.0},
    "short flutes": {
        "kind": "flat",
        "diameter_mm": 6.0,
        "flute_length_mm": 0.5,
        "shank": {"diameter_mm": 4.0, "length_mm": 30.0},
    },
}


def cut(folder: Path, blocks: str, tool: dict[str, Any]) -> tuple[list[np.ndarray[Any, Any]], float, list[Step]]:
    """Areas of all slices, the removed volume and the steps."""
    (folder / "part.nc").write_text(
        f"G21 G90 G94 G17\nG54\nT1 M6\nS3000 M3\nG43 H1\nG0 X12 Y10 Z1\nG1 Z0 F500\n{blocks}G0 Z20\nM30\n"
    )
    data = {
        "program": {"file": "part.nc", "dialect": "linuxcnc"},
        "stock": {"box_mm": {"min": [0, 0, -4], "max": [30, 20, 0]}},
        "tools": [TOOL | tool],
        "simulation": {"slice_pitch_mm": 0.4, "step_mm": 0.5, "axial_step_mm": 0.05, "angle_step_deg": 10.0},
    }
    with Replay(job_from_dict(data, folder), threads=1, preview=False) as replay:
        steps = [record for record in replay if isinstance(record, Step)]
        areas = [replay.workpiece.areas_mm2(axis) for axis in range(3)]
        return areas, replay.summary().removed_volume_mm3, steps


@pytest.mark.parametrize(
    ("program", "tool"),
    [
        ("down, then up, then down again", "ball"),
        ("one arc of many turns", "flat"),
        ("two places in turns", "bull"),
        ("away and back", "bull"),
        ("away and back", "short flutes"),
    ],
)
def test_the_part_is_the_same(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, program: str, tool: str) -> None:
    areas, volume, steps = cut(tmp_path, PROGRAMS[program], TOOLS[tool])
    monkeypatch.setattr(material, "RETRACED_TOGETHER", 0)
    each, each_volume, each_steps = cut(tmp_path, PROGRAMS[program], TOOLS[tool])
    for one, other in zip(areas, each, strict=True):
        assert one == pytest.approx(other, abs=1e-2)
    assert volume == pytest.approx(each_volume, rel=1e-4)
    assert len(steps) == len(each_steps)
    rate, other = (sum(s.engagement.removal_rate_mm3_s * s.duration_s for s in some) for some in (steps, each_steps))
    assert rate == pytest.approx(other, rel=0.03)


def test_few_of_many_turns_are_subtracted(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    whole, taken = material.Material._subtract, list[int]()

    def counted(self: material.Material, count: int, *args: Any) -> float:
        taken.append(count)
        return whole(self, count, *args)

    monkeypatch.setattr(material.Material, "_subtract", counted)
    cut(tmp_path, FINE, TOOLS["flat"])
    few = sum(taken)
    taken.clear()
    monkeypatch.setattr(material, "RETRACED_TOGETHER", 0)
    cut(tmp_path, FINE, TOOLS["flat"])
    assert few < 0.3 * sum(taken)
