"""Level motions in short lines without forces are cut in chains: part, times and records are those of each alone."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from tests.support.job_files import NOTHING, job_data
from twin.job import job_from_dict
from twin.record import Collision, NcEvent, Record, RunSummary, Step
from twin.simulation import replay as replay_module
from twin.simulation.replay import Replay

#: Points of level paths about X30 Y15, mm.
SPIRAL = [(30 + (4 + 0.002 * i) * math.cos(0.03 * i), 15 + (4 + 0.002 * i) * math.sin(0.03 * i)) for i in range(280)]
ZIGZAG = [(10 + 0.3 * (i if (i // 60) % 2 == 0 else 60 - i % 60) % 18, 5 + 0.5 * (i // 60)) for i in range(240)]
STAR = [(30 + (6 + (i % 5)) * math.cos(0.2 * i), 15 + (6 + (i % 5)) * math.sin(0.2 * i)) for i in range(60)]
PATHS = {"spiral": SPIRAL, "zigzag": ZIGZAG, "spiral, twice": [*SPIRAL, *SPIRAL]}


def records(folder: Path, path: Iterable[tuple[float, float]], step_mm: float = 0.5, **changes: Any) -> list[Record]:
    """Replay a level path without forces."""
    points = list(path)
    lines = "\n".join(f"X{x:.3f} Y{y:.3f}" for x, y in points)
    (folder / "slot.nc").write_text(
        f"T1 M6\nS3600 M3\nG54 G0 X{points[0][0]:.3f} Y{points[0][1]:.3f} Z5\nG1 Z-2 F1000\n{lines}\nG0 Z5\nM30\n"
    )
    data = job_data(simulation__slice_pitch_mm=0.5, simulation__step_mm=step_mm, cutting=NOTHING, **changes)
    with Replay(job_from_dict(data, folder), threads=1, preview=False) as replay:
        found = list(replay)
        found.append([replay.workpiece.areas_mm2(axis) for axis in range(3)])  # type: ignore[arg-type]
    return found


def one_by_one(items: Iterator[Any], *_: Any) -> Iterator[Any]:
    return items


@pytest.mark.parametrize(("path", "kind"), [("spiral", "flat"), ("zigzag", "ball"), ("spiral, twice", "ball")])
def test_everything_is_as_one_by_one(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, path: str, kind: str) -> None:
    *together, total, areas = records(tmp_path, PATHS[path], tools__0__kind=kind)
    monkeypatch.setattr(replay_module, "level_runs", one_by_one)
    *alone, total_alone, areas_alone = records(tmp_path, PATHS[path], tools__0__kind=kind)
    assert isinstance(total, RunSummary)
    assert isinstance(total_alone, RunSummary)
    for one, other in zip(areas, areas_alone, strict=True):  # type: ignore[call-overload]
        assert one == pytest.approx(other, abs=0.02)
    assert total.machine_time_s == pytest.approx(total_alone.machine_time_s, rel=1e-12)
    assert total.removed_volume_mm3 == pytest.approx(total_alone.removed_volume_mm3, rel=1e-3)
    # back along its own path a tool cuts nothing, and sweeps that wait are known exactly
    assert 0.8 * total_alone.cutting_time_s < total.cutting_time_s < 1.02 * total_alone.cutting_time_s
    assert [r for r in together if isinstance(r, NcEvent)] == [r for r in alone if isinstance(r, NcEvent)]
    steps, others = ([r for r in some if isinstance(r, Step)] for some in (together, alone))
    assert [replace(s, engagement=others[0].engagement) for s in steps] == [
        replace(s, engagement=others[0].engagement, samples=steps[0].samples) for s in others
    ]
    rate, other = (np.array([s.engagement.removal_rate_mm3_s * s.duration_s for s in some]) for some in (steps, others))
    assert rate.sum() == pytest.approx(other.sum(), rel=0.05)


def test_a_path_that_turns_sharply_is_as_one_by_one(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    *_, areas = records(tmp_path, STAR, 2.0, tools__0__kind="flat")
    monkeypatch.setattr(replay_module, "level_runs", one_by_one)
    *_, areas_alone = records(tmp_path, STAR, 2.0, tools__0__kind="flat")
    for one, other in zip(areas, areas_alone, strict=True):  # type: ignore[call-overload]
        assert one == pytest.approx(other, abs=0.02)


def test_a_shank_in_the_stock_is_found(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    changes = {
        "tools__0__kind": "flat",
        "tools__0__flute_length_mm": 1.0,
        "tools__0__shank": {"diameter_mm": 10.0, "length_mm": 20.0},
        "simulation__axial_step_mm": 0.5,
    }
    found = records(tmp_path, SPIRAL, **changes)
    monkeypatch.setattr(replay_module, "level_runs", one_by_one)
    alone = records(tmp_path, SPIRAL, **changes)
    lines, others = ({r.nc_line for r in some if isinstance(r, Collision)} for some in (found, alone))
    assert lines == others
    assert len(lines) > 100
