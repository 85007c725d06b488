"""The reference recording: what the job beside it gives today, with a log that says what it is."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import twin

FOLDER = Path(__file__).parents[1] / "recordings" / "reference"
RUN, LOG = FOLDER / "slot.mcap", FOLDER / "slot_synthetic.csv"


def test_a_replay_of_the_job_gives_the_recorded_run() -> None:
    kept, now = twin.open_run(RUN), twin.replay(FOLDER / "slot.toml")
    assert kept.complete
    assert kept.intact
    for name, values in kept.forces.items():
        assert np.array_equal(values, now.forces[name]), name
    assert now.summary.removed_volume_mm3 == pytest.approx(kept.summary.removed_volume_mm3, rel=1e-7)


def test_it_is_small() -> None:
    assert RUN.stat().st_size < 1_000_000
    assert LOG.stat().st_size < 1_000_000


def test_the_log_says_that_it_is_synthetic() -> None:
    assert LOG.read_text().startswith("# SYNTHETIC DATA: computed by tools/make_reference_recording.py, not measured.")


def test_the_log_is_of_the_same_cut_by_another_model() -> None:
    run = twin.open_run(RUN)
    log = np.loadtxt(LOG, delimiter=",", skiprows=2)
    steady = (log[:, 0] > 2.8) & (log[:, 0] < 3.4)
    cut = (run.forces["t_s"] > 2.6) & (run.forces["t_s"] < 3.2)
    on_tool = np.column_stack((6.0 - log[:, 1], log[:, 2] + 4.0, 2.0 - log[:, 3]))[steady]  # offsets of the script
    expected = np.column_stack((run.forces["fy_n"], run.forces["fx_n"], run.forces["fz_n"]))[cut]
    assert on_tool.mean(axis=0) == pytest.approx(expected.mean(axis=0), abs=1.0)
