"""The whole of flow A on small programs: volumes, times, forces, collisions, refusals."""

from __future__ import annotations

import math
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from gcode.errors import GcodeError
from twin.errors import JobError, ReplayError
from twin.job import job_from_dict
from twin.record import Collision, NcEvent, Record, RunHeader, RunSummary, Step, WorkpiecePatch
from twin.run.drive import drive
from twin.simulation.replay import Replay

HEAD = "G21 G90 G94 G17 G40 G49 G80\nG54\nT1 M6\nS3000 M3\nG43 H1\n"
BALL = {
    "number": 1,
    "kind": "ball",
    "diameter_mm": 8.0,
    "teeth": 2,
    "helix_deg": 30.0,
    "flute_length_mm": 12.0,
    "length_mm": 80.0,
}
FLAT = {**BALL, "kind": "flat", "diameter_mm": 6.0}
CUTTING = {"Ktc": 800.0, "Kte": 10.0, "Krc": 300.0, "Kre": 12.0, "Kac": 100.0, "Kae": 1.0, "source": "test"}


def make(folder: Path, program: str, **changes: Any) -> Replay:
    options = {name: changes.pop(name) for name in ("threads", "preview") if name in changes}
    (folder / "part.nc").write_text(program)
    data: dict[str, Any] = {
        "program": {"file": "part.nc"},
        "stock": {"box_mm": {"min": [0, 0, -10], "max": [30, 20, 0]}},
        "tools": [BALL],
        "cutting": CUTTING,
        "simulation": {"slice_pitch_mm": 0.25, "step_mm": 0.5, "axial_step_mm": 0.25, "angle_step_deg": 5.0},
    }
    data.update(changes)
    return Replay(job_from_dict(data, folder), **options)


def run(replay: Replay) -> list[Record]:
    with replay:
        return list(replay)


def summary_of(records: list[Record]) -> RunSummary:
    last = records[-1]
    assert isinstance(last, RunSummary)
    return last


def steps_of(records: list[Record]) -> list[Step]:
    return [r for r in records if isinstance(r, Step)]


def collisions_of(records: list[Record]) -> list[Collision]:
    return [r for r in records if isinstance(r, Collision)]


SLOT = HEAD + "G0 X-6 Y10 Z5\nG1 Z-2 F400\nX36\nG0 Z20\nM5\nM30\n"


def test_a_slot_has_its_volume_time_and_forces(tmp_path: Path) -> None:
    records = run(make(tmp_path, SLOT))
    total = summary_of(records)
    segment = 16.0 * math.acos(0.5) - 2.0 * math.sqrt(12.0)
    assert total.complete
    assert total.removed_volume_mm3 == pytest.approx(30.0 * segment, rel=3e-3)
    assert total.collisions == 0
    header = records[0]
    assert isinstance(header, RunHeader)
    assert total.machine_time_s == pytest.approx(header.planned_time_s)
    # the ball touches the block from 3.46 mm before it (at the height of its top) to when its centre has left
    assert total.cutting_time_s == pytest.approx((30.0 + math.sqrt(12.0)) / 400.0 * 60.0, abs=0.1)
    removal = [s.engagement.removal_rate_mm3_s for s in steps_of(records) if s.nc_line == 8 and 8 < s.start_mm[0] < 22]
    assert np.mean(removal) == pytest.approx(segment * 400.0 / 60.0, rel=2e-3)
    steady = np.concatenate([s.samples.force_n for s in steps_of(records) if s.nc_line == 8 and 8 < s.start_mm[0] < 22])
    assert steady.mean(axis=0)[1] > 0.0
    assert total.peak_force_n[3] == pytest.approx(np.linalg.norm(steady, axis=1).max(), rel=0.05)
    assert total.top_lines[0][:2] == (8, "X36")


def test_steps_join_in_time_and_place(tmp_path: Path) -> None:
    program = HEAD + "G0 X5 Y5 Z5\nG1 Z-1 F300\nG3 X5 Y5 I5 Z-2\nG1 X20 Y9\nG4 X0.5\nG0 Z20\nM30\n"
    records = run(make(tmp_path, program, tools=[FLAT]))
    steps = steps_of(records)
    for before, after in pairwise(steps):
        assert after.t_s == pytest.approx(before.t_s + before.duration_s, abs=1e-9)
        assert after.start_mm == pytest.approx(before.end_mm, abs=1e-9)
        assert after.index == before.index + 1
    times = np.concatenate([s.samples.t_s for s in steps])
    assert np.all(np.diff(times) > 0.0)
    cutting = [s for s in steps if s.engagement.cutting]
    assert all(math.dist(s.start_mm, s.end_mm) <= 0.5 + 1e-9 for s in cutting)
    assert {s.nc_line for s in cutting} == {7, 8, 9}


def test_a_full_circle_and_a_helix_remove_a_ring(tmp_path: Path) -> None:
    program = HEAD + "G0 X20 Y10 Z1\nG1 Z0 F300\nG2 I-5 Z-3\nG2 I-5\nG0 Z20\nM30\n"
    total = summary_of(run(make(tmp_path, program, tools=[FLAT])))
    # all directions feed at 300 mm/min through a block 20 mm wide: ring from radius 2 to 8, 3 mm deep
    assert total.removed_volume_mm3 == pytest.approx(math.pi * (64.0 - 4.0) * 3.0, rel=5e-3)
    assert total.collisions == 0


def test_drawing_the_part_changes_no_number(tmp_path: Path) -> None:
    program = HEAD + "G0 X-6 Y6\nZ-2\nG1 X12 F300\nG0 Z20\nM30\n"
    full, bare = (run(make(tmp_path, program, preview=preview)) for preview in (True, False))
    assert any(isinstance(record, WorkpiecePatch) for record in full)
    assert not any(isinstance(record, WorkpiecePatch) for record in bare)
    assert summary_of(bare).digest == summary_of(full).digest
    assert summary_of(bare).removed_volume_mm3 == summary_of(full).removed_volume_mm3


def test_threads_change_no_number(tmp_path: Path) -> None:
    """Bit for bit: steps are solved in parts of one size, and each family of slices by one thread."""
    program = HEAD + "G0 X-6 Y6\nZ-2\nG1 X12 F300\nG2 X18 Y12 I0 J6 Z-3\nG1 X14.1 Y13.3\nX16 Y2 Z-1\nG0 Z20\nM30\n"
    runs = [run(make(tmp_path, program, threads=n)) for n in (1, 2, 3)]
    assert len({summary_of(records).digest for records in runs}) == 1
    for first, *others in zip(*map(steps_of, runs), strict=True):
        for other in others:
            assert np.array_equal(other.samples.force_n, first.samples.force_n)
            assert other.engagement == first.engagement


def test_equal_runs_have_equal_digests_and_other_runs_do_not(tmp_path: Path) -> None:
    first, second = (summary_of(run(make(tmp_path, SLOT))) for _ in range(2))
    assert first == second
    other = summary_of(run(make(tmp_path, SLOT.replace("Z-2", "Z-1.9"))))
    assert other.digest != first.digest


def test_fast_and_reference_store_agree(tmp_path: Path) -> None:
    coarse = {"slice_pitch_mm": 1.0, "step_mm": 4.0, "axial_step_mm": 1.0, "angle_step_deg": 15.0}
    fast, slow = (
        summary_of(run(make(tmp_path, SLOT, simulation={**coarse, "store": store}))) for store in ("fast", "reference")
    )
    assert fast.removed_volume_mm3 == pytest.approx(slow.removed_volume_mm3, abs=1e-3)
    assert fast.mean_force_n == pytest.approx(slow.mean_force_n, rel=1e-3)


def test_a_path_in_many_short_blocks_has_the_forces_of_one_long_block(tmp_path: Path) -> None:
    """Each block begins on the surface that the one before has just made; sweeps that wait keep that surface exact."""
    one = summary_of(run(make(tmp_path, SLOT)))
    blocks = "".join(f"X{-6 + 0.3 * i:.3f}\n" for i in range(1, 141))
    many = summary_of(run(make(tmp_path, SLOT.replace("X36\n", blocks))))
    assert many.mean_force_n == pytest.approx(one.mean_force_n, rel=0.01)
    assert many.peak_force_n == pytest.approx(one.peak_force_n, rel=0.02)
    assert many.removed_volume_mm3 == pytest.approx(one.removed_volume_mm3, rel=2e-3)


def test_m4_mirrors_the_slot(tmp_path: Path) -> None:
    right = summary_of(run(make(tmp_path, SLOT)))
    left = summary_of(run(make(tmp_path, SLOT.replace("S3000 M3", "S3000 M4"))))
    x, y, z, r = right.mean_force_n
    assert left.mean_force_n == pytest.approx((x, -y, z, r), rel=1e-3)


def test_without_coefficients_there_are_engagements_but_no_forces(tmp_path: Path) -> None:
    records = run(make(tmp_path, SLOT, cutting=None))
    total = summary_of(records)
    assert total.samples == 0
    assert total.mean_force_n == (0.0, 0.0, 0.0, 0.0)
    assert any(s.engagement.cutting for s in steps_of(records))


def test_no_samples_while_the_spindle_stands(tmp_path: Path) -> None:
    steps = steps_of(run(make(tmp_path, SLOT)))
    assert all(len(s.samples.t_s) > 0 for s in steps if s.engagement.cutting)
    stopped = steps_of(run(make(tmp_path, SLOT.replace("S3000 M3\n", ""))))
    assert all(len(s.samples.t_s) == 0 for s in stopped)


@pytest.mark.parametrize(
    ("program", "tool", "kind", "line", "volume"),
    [
        (HEAD + "G0 X-6 Y10 Z-2\nX36\nG0 Z20\nM30\n", BALL, "rapid", 7, 294.8),
        (SLOT.replace("S3000 M3\n", ""), BALL, "spindle-stopped", 7, 294.8),
        (
            HEAD + "G0 X10 Y10 Z5\nG1 Z-8 F300\nG0 Z20\nM30\n",
            {**FLAT, "flute_length_mm": 5.0, "shank": {"diameter_mm": 8.0, "length_mm": 20.0}},
            "shank",
            7,
            math.pi * (16.0 - 9.0) * 3.0,
        ),
        (
            HEAD + "G0 X10 Y10 Z5\nG1 Z-6 F300\nG0 Z20\nM30\n",
            {**FLAT, "flute_length_mm": 5.0, "holder": [{"diameter_mm": 12.0, "length_mm": 20.0}]},
            "holder",
            7,
            math.pi * (36.0 - 9.0) * 1.0,
        ),
    ],
)
def test_collisions_are_reported_with_line_and_volume_and_the_replay_goes_on(
    tmp_path: Path, program: str, tool: dict[str, Any], kind: str, line: int, volume: float
) -> None:
    records = run(make(tmp_path, program, tools=[tool]))
    found = [c for c in collisions_of(records) if c.kind == kind]
    assert found
    assert found[0].nc_line == line
    assert found[0].volume_mm3 == pytest.approx(volume, rel=0.15)
    assert found[0].message.startswith(f"{tmp_path / 'part.nc'}:{line}: T1: ")
    assert summary_of(records).complete
    assert summary_of(records).collisions == len(collisions_of(records))
    strict: list[Record] = []
    with make(tmp_path, program, tools=[tool]) as replay:
        ending = drive(replay, strict.append, strict=True)
    assert ending.refused == strict[-2] == found[0]
    assert ending.summary == strict[-1]
    assert not ending.summary.complete


def test_a_shank_of_the_cutters_own_diameter_may_rub_in_its_slot(tmp_path: Path) -> None:
    tool = {**FLAT, "flute_length_mm": 3.0, "shank": {"diameter_mm": 6.0, "length_mm": 30.0}}
    program = HEAD + "".join(f"G0 X-6 Y10 Z5\nG1 Z{-d} F400\nX36\nG0 Z20\n" for d in (2, 4, 6)) + "M30\n"
    assert collisions_of(run(make(tmp_path, program, tools=[tool]))) == []


def test_events_come_before_what_they_begin(tmp_path: Path) -> None:
    records = run(make(tmp_path, SLOT))
    events = [r for r in records if isinstance(r, NcEvent)]
    texts = [(e.kind, e.text) for e in events]
    assert ("tool", "T1 ball D8 z2") in texts
    assert ("spindle", "M3 S3000") in texts
    assert ("stop", "program end") in texts
    begun: set[int] = set()
    for record in records:
        if isinstance(record, NcEvent) and record.kind == "block":
            begun.add(record.nc_line)
        if isinstance(record, Step):
            assert record.nc_line in begun


@pytest.mark.parametrize(
    ("program", "changes", "message"),
    [
        (
            "T7 M6\nM30\n",
            {},
            "{folder}/part.nc:1:1: tool T7 is not in the job; expected one of 1",
        ),
        (
            "G1 X5 F100\nM30\n",
            {},
            "{folder}/part.nc:1: feed motion without a tool in the spindle; expected a tool change (T.. M6) before it, "
            "program.tool in the job, or --tool N",
        ),
    ],
)
def test_programs_that_cannot_be_replayed(tmp_path: Path, program: str, changes: Any, message: str) -> None:
    with pytest.raises(ReplayError) as caught:
        make(tmp_path, program, **changes)
    found = str(caught.value)
    assert found.replace(":1:4:", ":1:1:") == message.format(folder=tmp_path)


def test_a_feed_motion_without_feed_is_refused_before_anything_is_cut(tmp_path: Path) -> None:
    with pytest.raises(GcodeError) as caught:
        make(tmp_path, HEAD + "G0 X-6 Y10 Z5\nG1 Z-2\nM30\n")
    assert caught.value.code == "missing-feed"
    assert caught.value.place.line == 7


def test_a_start_inside_the_stock_is_an_error(tmp_path: Path) -> None:
    replay = make(tmp_path, HEAD + "G1 X20 F100\nM30\n", machine={"start_mm": [10.0, 10.0, 77.0]})
    with replay, pytest.raises(ReplayError, match=r"tool T1 \(ball D8 z2\) begins inside the stock at X10 Y10 Z-3;"):
        list(replay)


def test_a_dwell_before_the_first_motion_is_at_the_start_not_in_the_stock(tmp_path: Path) -> None:
    program = HEAD + "G4 X0.5\nG0 X-6 Y10 Z25\nM30\n"
    records = run(make(tmp_path, program, stock={"box_mm": {"min": [-5, -5, 0], "max": [30, 20, 16]}}))
    dwell = steps_of(records)[0]
    assert dwell.duration_s == 0.5
    assert dwell.start_mm == pytest.approx(steps_of(records)[1].start_mm)


def test_tool_shapes_that_cannot_be_name_the_tool(tmp_path: Path) -> None:
    with pytest.raises(JobError, match="flute"):
        make(tmp_path, SLOT, tools=[{**BALL, "flute_length_mm": 1.0}])


def test_a_stock_far_from_the_path_is_only_air(tmp_path: Path) -> None:
    records = run(make(tmp_path, SLOT, stock={"box_mm": {"min": [100, 0, -10], "max": [130, 20, 0]}}))
    assert summary_of(records).removed_volume_mm3 == 0.0
    assert summary_of(records).cutting_time_s == 0.0


def test_a_summary_can_be_had_at_any_time(tmp_path: Path) -> None:
    with make(tmp_path, SLOT) as replay:
        for record in replay:
            if isinstance(record, Step) and record.engagement.cutting:
                break
        part = replay.summary()
    assert not part.complete
    assert 0.0 < part.machine_time_s < replay.planned_time_s
