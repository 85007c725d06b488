"""Ctrl-C while the kernels run: a process of its own, real signals, and an archive that holds what was done."""

from __future__ import annotations

import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

from twin.archive import read_run
from twin.record import RunSummary, Step

#: About 40 minutes of cutting, so that no machine is done before the signal.
PROGRAM = "\n".join(
    ["G21 G90 G94 T1 M6", "S3600 M3", "G0 X-6 Y-4", "G43 H1 Z20", "Z-2", "F200"]
    + [line for n in range(60) for line in (f"G1 X{126 if n % 2 == 0 else -6}", f"Y{0.5 * n - 4:g}")]
    + ["M30"]
)
JOB = """
[program]
file = "face.nc"
[stock]
box_mm = { min = [0, 0, -20], max = [120, 30, 0] }
[[tools]]
number = 1
kind = "ball"
diameter_mm = 8.0
teeth = 2
flute_length_mm = 20.0
length_mm = 80.0
[cutting]
Ktc = 935.62
Kte = 2.0218
Krc = 416.73
Kre = 1.8238
Kac = 0.0
Kae = 0.0
source = "a test"
[simulation]
slice_pitch_mm = 0.1
step_mm = 0.1
[output]
mcap = "run.mcap"
"""


def begun(folder: Path) -> int:
    """Bytes of the archive so far, under whatever name it grows."""
    return sum(path.stat().st_size for path in folder.glob("*.mcap"))


@pytest.mark.parametrize("later_s", [0.0, 0.13, 0.31])
def test_a_signal_while_kernels_run_ends_the_run_in_good_order(tmp_path: Path, later_s: float) -> None:
    (tmp_path / "face.nc").write_text(PROGRAM)
    (tmp_path / "job.toml").write_text(JOB)
    command = [sys.executable, "-c", "from twin.cli import main; main()", "replay", "job.toml", "--quiet"]
    process = subprocess.Popen(command, cwd=tmp_path, stderr=subprocess.PIPE, text=True)
    give_up = time.monotonic() + 240.0
    while begun(tmp_path) < 200_000 and process.poll() is None and time.monotonic() < give_up:
        time.sleep(0.05)
    time.sleep(later_s)
    process.send_signal(signal.SIGINT)
    _, complaints = process.communicate(timeout=60.0)
    assert process.returncode == 130, complaints
    assert "Traceback" not in complaints
    *records, summary = read_run(tmp_path / "run.mcap")
    steps = [record for record in records if isinstance(record, Step)]
    assert isinstance(summary, RunSummary) and not summary.complete
    assert len(steps) > 50
    assert [step.index for step in steps] == list(range(len(steps)))
    assert summary.machine_time_s == pytest.approx(steps[-1].t_s + steps[-1].duration_s)
