"""Cuts that are jobs: the replay's forces for unit coefficients, beside those of the exact straight pass."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from support.cut_logs import QUARTER_TURN, mean_tables, write_log
from support.edge_integral import BULL_CUTS, SOME, Pass
from support.job_files import job_folder

from twin.errors import IdentifyError, JobError
from twin.identification.cuts.load import cuts_from_dict
from twin.identification.fit.harmonics import to_waveform
from twin.identification.identify import identify
from twin.identification.models.job_model import JobRun, replay_units
from twin.identification.models.model import pass_model

#: A side cut, down milling: the stock lies 3 mm deep under the tool's side of negative y.
SIDE = Pass(axial=3.0, feed=320.0, wall=(-math.inf, -4.0))
PROGRAM = "%\nT1 M6\nS800 M3\nG54 G0 X-12 Y10\nZ-3\nG1 X22 F320\nG0 Z20\nM30\n%\n"
TOOL = {"number": 1, "kind": "bull", "diameter_mm": 16.0, "corner_radius_mm": 3.0, "teeth": 2, "helix_deg": 25.0}


def side_job(folder: Path, program: str = PROGRAM) -> Path:
    path = job_folder(
        folder,
        stock__box_mm={"min": [0, -4, -8], "max": [10, 6, 0]},
        tools=[TOOL | {"flute_length_mm": 12.0}],
        simulation={"slice_pitch_mm": 0.25, "step_mm": 0.25, "angle_step_deg": 2.0, "axial_step_mm": 0.25},
    )
    (folder / "slot.nc").write_text(program)
    return path


@pytest.fixture(scope="module")
def run(tmp_path_factory: pytest.TempPathFactory) -> JobRun:
    return replay_units(side_job(tmp_path_factory.mktemp("job")))


def exact() -> Any:
    cuts = cuts_from_dict(mean_tables((SIDE,), SOME), "cuts.toml")
    assert cuts.tool is not None
    return pass_model(cuts.tool, cuts.cuts[0], "")


def steady(run: JobRun) -> tuple[float, float]:
    """While the tool's axis is in the block and its front has not come out: 2.5 mm of way."""
    speed = 320.0 / 60.0
    middle = run.cut_s[0] + (8.0 + 1.3) / speed
    return middle - 0.12, middle + 0.12


def test_a_job_is_the_exact_pass_within_a_percent(run: JobRun) -> None:
    model, want = run.model(steady(run)), exact()
    assert np.abs(model.means() - want.means()).max() <= 0.01 * np.abs(want.means()).max()
    assert model.means() @ SOME == pytest.approx(SIDE.mean(SOME), abs=0.01 * float(np.linalg.norm(SIDE.mean(SOME))))
    assert model.feed_per_tooth_mm == pytest.approx(0.2)
    angle = np.linspace(0.0, 2.0 * math.pi, 90)
    got, waves = to_waveform(model.harmonics(20) @ SOME, angle), to_waveform(want.harmonics(20) @ SOME, angle)
    assert np.sqrt(((got - waves) ** 2).sum(axis=1).mean()) <= 0.02 * np.sqrt((waves**2).sum(axis=1)).max()


def test_a_window_without_cutting_is_refused(run: JobRun) -> None:
    with pytest.raises(IdentifyError, match=r"nothing is cut for a revolution \(0.0750 s\) from 0 to 0.05 s"):
        run.model((0.0, 0.05))


def test_a_job_among_the_cuts_with_a_mean_force(tmp_path: Path) -> None:
    side_job(tmp_path)
    data = mean_tables(BULL_CUTS[:6], SOME)
    run = replay_units(tmp_path / "job.toml")
    data["cuts"].append(
        {"job": "job.toml", "mean_force_n": SIDE.mean(SOME).tolist(), "run_window_s": list(steady(run))}
    )
    found = identify(cuts_from_dict(data, tmp_path / "cuts.toml"))
    assert found.estimate.values == pytest.approx(SOME, rel=0.01)
    assert found.cuts[-1].name == "job"
    assert np.linalg.norm(found.cuts[-1].residual_n) < 0.01 * np.linalg.norm(found.cuts[-1].measured.mean_n)


@pytest.mark.parametrize("method", ["mean", "waveform"])
def test_jobs_alone_with_a_log_each(tmp_path: Path, run: JobRun, method: Any) -> None:
    """Entry and exit are in the cut; the log begins 0.37 s after the program and lies in other axes."""
    late, rate = -0.37, 2500.0
    t = np.arange(run.cut_s[0] - 1.0, run.cut_s[1] + 1.0, 1.0 / rate)
    force = np.column_stack([np.interp(t, run.t_s, run.force_n[:, a] @ SOME, left=0.0, right=0.0) for a in range(3)])
    cuts = []
    for i in (1, 2):
        # a job with half the feed would need a replay of its own: the same cut twice, the second with errors in it
        write_log(tmp_path / f"cut{i}.csv", t + late, force + np.array([12.0, -3.0, 5.0]))
        cuts.append({"name": f"c{i}", "job": str(run.file), "log": f"cut{i}.csv"})
    cuts[1]["lag_s"] = late
    data = {"defaults": dict(QUARTER_TURN), "cuts": cuts, "fit": {"fixed": {"Kte": 22.0, "Kre": 45.0, "Kae": 12.0}}}
    found = identify(cuts_from_dict(data, tmp_path / "cuts.toml"), method)
    assert found.estimate.values == pytest.approx(SOME, rel=0.03)
    assert any("found by correlation with the run" in note for note in found.cuts[0].measured.notes)
    assert any(f"lags the run by {late:.4f} s, as given" in note for note in found.cuts[1].measured.notes)


@pytest.mark.parametrize(
    ("program", "message"),
    [
        (PROGRAM.replace("G1 X22 F320", "G0 Z20"), "this job cuts nothing, expected a test cut"),
        (PROGRAM.replace("G1 X22 F320", "G1 X-5 F320\nS900\nX22"), r"at 800, 900 rpm; expected one tool at one speed"),
        (PROGRAM.replace("S800 M3", "S800 M4"), "at -800 rpm; expected one tool at one speed, M3"),
    ],
)
def test_jobs_that_are_no_test_cut(tmp_path: Path, program: str, message: str) -> None:
    with pytest.raises(IdentifyError, match=message):
        replay_units(side_job(tmp_path, program))


def test_a_broken_job_says_what_is_wrong_in_it(tmp_path: Path) -> None:
    path = job_folder(tmp_path, stock__box_mm={"min": [0, 0, 0], "max": [1, 1, 0]})
    cuts = cuts_from_dict({"cuts": [{"job": path.name, "mean_force_n": [1, 2, 3]}]}, tmp_path / "cuts.toml")
    with pytest.raises(JobError, match="the box's extent along z"):
        identify(cuts)
