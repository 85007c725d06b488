"""Motions far shorter than a step share one engagement and one sweep; records, times and forces stay."""

from __future__ import annotations

import math
from dataclasses import replace
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from gcode.errors import Place
from gcode.events import Block
from tests.support.job_files import job_data
from twin.job import job_from_dict
from twin.motion.path import Move
from twin.record import NcEvent, RunSummary, Step
from twin.simulation.replay import Replay
from twin.simulation.short_motions import Joined, joined


def moves(*points: tuple[float, float], feed: float = 600.0) -> list[Move]:
    corners = [np.array([x, y, -1.0]) for x, y in points]
    return [
        Move(
            start_mm=a,
            end_mm=b,
            duration_s=0.1,
            feed_mm_min=feed,
            spindle_rpm=1000.0,
            tool=1,
            rapid=False,
            nc_line=line,
        )
        for line, (a, b) in enumerate(pairwise(corners), start=1)
    ]


def test_motions_along_a_line_become_one_with_their_blocks_between() -> None:
    first, second, third = moves((0.0, 0.0), (0.1, 0.001), (0.2, 0.0), (0.3, 0.0))
    blocks = [Block(place=Place(file="t.nc", line=line)) for line in (1, 2, 3, 4)]
    found = list(joined([blocks[0], first, blocks[1], second, blocks[2], third, blocks[3]], 0.4, 0.002))
    assert found[0] is blocks[0] and found[2] is blocks[3]
    assert isinstance(found[1], Joined)
    assert found[1].items == (first, blocks[1], second, blocks[2], third)
    assert found[1].whole.end_mm is third.end_mm
    assert found[1].whole.duration_s == pytest.approx(0.3)


@pytest.mark.parametrize(
    "path",
    [
        moves((0.0, 0.0), (0.1, 0.01), (0.2, 0.0)),
        moves((0.0, 0.0), (0.1, 0.0), (0.0, 0.0)),
        moves((0.0, 0.0), (0.3, 0.0), (0.6, 0.0)),
        [replace(m, rapid=True) for m in moves((0.0, 0.0), (0.1, 0.0), (0.2, 0.0))],
        [replace(m, spindle_rpm=0.0) for m in moves((0.0, 0.0), (0.1, 0.0), (0.2, 0.0))],
        [replace(m, tool=i) for i, m in enumerate(moves((0.0, 0.0), (0.1, 0.0), (0.2, 0.0)))],
        [replace(m, feed_mm_min=100.0 * i + 1) for i, m in enumerate(moves((0.0, 0.0), (0.1, 0.0), (0.2, 0.0)))],
    ],
    ids=["off the line", "back", "long", "rapid", "stopped", "tools", "feeds"],
)
def test_other_motions_stay_as_they_are(path: list[Move]) -> None:
    assert list(joined(path, 0.5, 0.002)) == path


def test_a_circle_in_short_blocks_has_steps_times_and_forces_of_the_arc(tmp_path: Path) -> None:
    count = 600
    corners = [(30.0 + 8.0 * math.cos(a), 15.0 + 8.0 * math.sin(a)) for a in np.linspace(0.0, 2.0 * math.pi, count + 1)]
    chords = "\n".join(f"X{x:.4f} Y{y:.4f}" for x, y in corners[1:])
    head = "T1 M6\nS3600 M3\nG54 G0 X38 Y15 Z5\nG1 Z-2 F1000\n"
    results = []
    for body in ("G3 X38 Y15 I-8 J0", chords):
        (tmp_path / "slot.nc").write_text(f"{head}{body}\nM30\n")
        changes: dict[str, Any] = {"simulation__step_mm": 0.5, "simulation__angle_step_deg": 10.0}
        with Replay(job_from_dict(job_data(**changes), tmp_path), preview=False) as replay:
            results.append(list(replay))
    arc, short = (records[-1] for records in results)
    assert isinstance(arc, RunSummary) and isinstance(short, RunSummary)
    assert short.machine_time_s == pytest.approx(arc.machine_time_s, rel=1e-4)
    assert short.removed_volume_mm3 == pytest.approx(arc.removed_volume_mm3, rel=2e-3)
    assert short.mean_force_n == pytest.approx(arc.mean_force_n, abs=0.02 * arc.mean_force_n[3])
    begun = 0
    for record in results[1]:
        if isinstance(record, NcEvent) and record.kind == "block":
            begun = record.nc_line
        if isinstance(record, Step):
            assert record.nc_line == begun
    lines = {record.nc_line for record in results[1] if isinstance(record, Step)}
    assert len(lines) >= count
