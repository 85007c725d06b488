from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from support.job_files import job_folder

from twin.errors import ReplayError
from twin.job import load_job
from twin.simulation.replay import Replay
from twin.verification.machining import machined

BOX = {"min": [0, 0, -4], "max": [20, 16, 0]}


def test_removal_alone_leaves_what_a_replay_leaves(tmp_path: Path) -> None:
    job = load_job(job_folder(tmp_path, stock__box_mm=BOX, tools__0__teeth=2))
    motions = "G0 X-6 Y8 Z-2\nG1 X10 F600\nG2 X14 Y4 I0 J-4 F400\nG1 Z1\n"
    (tmp_path / "slot.nc").write_text(f"T1 M6\nS3600 M3\n{motions}M30\n")
    store, collisions = machined(job)
    with Replay(job.without_forces(), preview=False) as run:
        for _ in run:
            pass
        wanted = run.workpiece
        assert all(np.array_equal(store.areas_mm2(a), wanted.areas_mm2(a)) for a in range(3))
    assert collisions == ()


def test_a_rapid_through_the_stock_is_reported(tmp_path: Path) -> None:
    job = load_job(job_folder(tmp_path, stock__box_mm=BOX))
    (tmp_path / "slot.nc").write_text("T1 M6\nS3600 M3\nG0 X-6 Y8 Z-2\nX30\nM30\n")
    times: list[float] = []
    _, collisions = machined(job, begin=times.append)
    assert [c.kind for c in collisions] == ["rapid"] and collisions[0].nc_line == 4
    assert times[0] > 0.0


def test_a_tool_that_is_not_in_the_job_is_refused(tmp_path: Path) -> None:
    job = load_job(job_folder(tmp_path, stock__box_mm=BOX))
    (tmp_path / "slot.nc").write_text("T5 M6\nS3600 M3\nG0 X-6 Y8 Z-2\nG1 X30 F100\nM30\n")
    with pytest.raises(ReplayError, match="tool T5 is not in the job; expected one of 1, 7"):
        machined(job)
