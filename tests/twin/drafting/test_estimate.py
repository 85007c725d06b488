"""Sizes of archive and recording are those that the estimate printed, within a factor of 1.5."""

from __future__ import annotations

from pathlib import Path

from twin.drafting import estimate
from twin.drafting.draft import draft_job
from twin.simulation import preview
from twin.simulation.replay import Replay
from twin.sinks.outputs import opened
from twin.sinks.rerun import envelope

ROOT = Path(__file__).parents[3]


def test_the_limits_are_those_of_the_outputs() -> None:
    assert estimate.MOST_BYTES == preview.MOST_BYTES
    assert estimate.MOST_SAMPLES == envelope.MOST_SAMPLES


def test_files_have_the_size_that_was_estimated(tmp_path: Path) -> None:
    program = ROOT / "examples" / "casting" / "bracket.nc"
    draft = draft_job(program, material="Al7075-T6", angle_step_deg=20.0)
    mcap, rrd = tmp_path / "a.mcap", tmp_path / "a.rrd"
    with Replay(draft.job()) as replay, opened(mcap, rrd, view=False, force=False) as write:
        for record in replay:
            write(record)
    assert 1.0 / 1.5 < draft.estimate.archive_bytes / mcap.stat().st_size < 1.5
    assert 1.0 / 1.5 < draft.estimate.recording_bytes / rrd.stat().st_size < 1.5
