"""What a recording holds: entities, timelines, every sample; and what becomes of its file."""

from __future__ import annotations

from dataclasses import replace
from itertools import takewhile
from pathlib import Path

import numpy as np
import pyarrow as pa
import pytest
from rerun.chunk import RrdReader

from tests.support.recording import Recording
from tests.support.slot_run import SlotRun, patch
from twin.errors import ArchiveError
from twin.record import Collision, NcEvent, Record, RunHeader, RunSummary, Step, WorkpiecePatch
from twin.sinks.rerun import file as rerun_file
from twin.sinks.rerun import layout
from twin.sinks.rerun.sink import RerunSink

RUN = SlotRun(step_mm=1.0, per_turn=36)


def write(path: Path, records: list[Record]) -> None:
    with RerunSink(rrd=path) as sink:
        for record in records:
            sink.write(record)


@pytest.fixture(scope="module")
def records() -> list[Record]:
    return list(RUN.records())


@pytest.fixture(scope="module")
def recording(tmp_path_factory: pytest.TempPathFactory, records: list[Record]) -> Recording:
    path = tmp_path_factory.mktemp("rrd") / "slot.rrd"
    write(path, records)
    return Recording(path)


def steps_of(records: list[Record]) -> list[Step]:
    return [r for r in records if isinstance(r, Step)]


def test_the_entity_tree(recording: Recording) -> None:
    tree = {entity for entity in recording.tables if not entity.startswith("__")}
    assert tree == {
        "",
        layout.TOOL,
        layout.PATH,
        layout.CUT_PATH,
        layout.RAPID_PATH,
        layout.SCALE,
        f"{layout.SCALE}/numbers",
        layout.COLLISIONS,
        layout.STOCK,
        "workpiece/x0_y0",
        "workpiece/x1_y0",
        "workpiece/x2_y0",
        "workpiece/x3_y0",
        "force/samples",
        "force/envelope",
        "force/resultant",
        "torque",
        layout.COLLISION_MARK,
        layout.WARNING_MARK,
        layout.BLOCKS,
        layout.COLLISION_LOG,
        layout.SUMMARY,
    }


@pytest.mark.parametrize(
    "entity",
    [
        layout.TOOL,
        layout.CUT_PATH,
        layout.RAPID_PATH,
        layout.COLLISIONS,
        "workpiece/x0_y0",
        "force/samples",
        "torque",
        layout.COLLISION_MARK,
        "nc/block",
    ],
)
def test_moving_entities_have_the_three_timelines_and_no_clock(recording: Recording, entity: str) -> None:
    assert recording.timelines(entity) == set(layout.TIMELINES)


def test_every_sample_is_there_with_its_value_and_time(recording: Recording, records: list[Record]) -> None:
    samples = [s.samples for s in steps_of(records)]
    force = np.concatenate([s.force_n for s in samples])
    torque = np.concatenate([s.torque_nm for s in samples])
    rows = np.array(recording.column("force/samples", "Scalars:scalars"))
    np.testing.assert_array_equal(rows[:, :3], force)
    np.testing.assert_allclose(rows[:, 3], np.linalg.norm(force, axis=1), rtol=1e-12)
    np.testing.assert_array_equal(rows[:, 4], torque)
    times = np.concatenate(
        [
            t.column(layout.TIME).cast(pa.int64()).to_numpy()
            for t in recording.tables["force/samples"]
            if layout.TIME in t.schema.names
        ]
    )
    expected = np.rint(np.concatenate([s.t_s for s in samples]) * 1e9)
    np.testing.assert_array_equal(np.sort(times), expected)


def test_the_envelope_holds_every_sample_of_its_revolution(recording: Recording, records: list[Record]) -> None:
    samples = [s.samples for s in steps_of(records) if len(s.samples.t_s)]
    angles, force = (np.concatenate([getattr(s, n) for s in samples]) for n in ("spindle_angle_rad", "force_n"))
    turns = np.floor(angles / (2.0 * np.pi))
    rows = np.array(recording.column("force/envelope", "Scalars:scalars")).reshape(-1, 3, 3)
    highest = np.array(recording.column("force/resultant", "Scalars:scalars"))[:, 0]
    each = [force[turns == turn] for turn in np.unique(turns)]
    assert len(rows) == len(each) > 5
    np.testing.assert_array_equal(rows[:, :, 0], [f.min(axis=0) for f in each])
    np.testing.assert_array_equal(rows[:, :, 1], [f.max(axis=0) for f in each])
    assert np.all((rows[:, :, 0] <= rows[:, :, 2]) & (rows[:, :, 2] <= rows[:, :, 1]))
    np.testing.assert_allclose(highest, [np.linalg.norm(f, axis=1).max() for f in each], rtol=1e-12)


def test_a_long_run_keeps_whole_revolutions_all_along(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, records: list[Record]
) -> None:
    total = sum(len(s.samples.t_s) for s in steps_of(records))
    monkeypatch.setattr("twin.sinks.rerun.envelope.MOST_SAMPLES", total // 3)
    monkeypatch.setattr("twin.sinks.rerun.batches.BATCH_STEPS", 7)
    write(tmp_path / "a.rrd", records)
    recording = Recording(tmp_path / "a.rrd")
    rows = np.array(recording.column("force/samples", "Scalars:scalars"))
    kept = np.isfinite(rows[:, 0])
    assert 0.8 * total / 3 <= kept.sum() <= total / 3
    gaps = np.flatnonzero(~kept)
    assert len(gaps) > 3
    assert np.all(np.diff(gaps) > 1)
    assert gaps[0] < 0.6 * len(rows)
    assert len(recording.column("force/envelope", "Scalars:scalars")) > len(gaps)
    assert "some revolutions only" in str(recording.column(layout.SUMMARY, "TextDocument:text"))


def test_a_collision_is_marked_on_the_time_axis(recording: Recording, records: list[Record]) -> None:
    (collision,) = [r for r in records if isinstance(r, Collision)]
    (table,) = [t for t in recording.tables[layout.COLLISION_MARK] if "Scalars:scalars" in t.schema.names]
    assert table.column(layout.TIME).cast(pa.int64()).to_pylist() == [round(collision.t_s * 1e9)]


def test_the_tool_stands_at_the_start_of_each_step_and_at_last_at_its_end(
    recording: Recording, records: list[Record]
) -> None:
    tips = np.array(recording.column(layout.TOOL, "Transform3D:translation")).reshape(-1, 3)
    steps = steps_of(records)
    starts = np.array([s.start_mm for s in steps], np.float32)
    assert all(np.any(np.all(tips == start, axis=1)) for start in starts)
    np.testing.assert_array_equal(tips[-1], np.array(steps[-1].end_mm, np.float32))


def test_the_path_has_every_step_once(recording: Recording, records: list[Record]) -> None:
    lengths = {True: 0.0, False: 0.0}
    for step in steps_of(records):
        lengths[step.rapid] += float(np.linalg.norm(np.subtract(step.end_mm, step.start_mm)))
    for entity, rapid in ((layout.CUT_PATH, False), (layout.RAPID_PATH, True)):
        rows = recording.column(entity, "LineStrips3D:strips")
        drawn = sum(
            float(np.linalg.norm(np.diff(np.array(strip), axis=0), axis=1).sum()) for row in rows for strip in row
        )
        assert drawn == pytest.approx(lengths[rapid], rel=1e-6)


def test_blocks_have_their_line_number_and_collisions_are_errors(recording: Recording, records: list[Record]) -> None:
    blocks = [text[0] for text in recording.column(layout.BLOCKS, "TextLog:text")]
    assert blocks == [f"{r.nc_line:>6}  {r.text}" for r in records if isinstance(r, NcEvent)]
    assert recording.column(layout.COLLISION_LOG, "TextLog:text") == [
        ["     5  COLLISION T1: rapid motion through the stock, from X60 Y15 Z-2, 12.5 mm3"]
    ]
    assert recording.column(layout.COLLISION_LOG, "TextLog:level") == [["ERROR"]]
    assert recording.column(layout.COLLISIONS, "Points3D:positions") == [[[60.0, 15.0, -2.0]]]


def test_a_patch_is_sent_when_it_changed_and_only_then(recording: Recording, records: list[Record]) -> None:
    for name in ("x0_y0", "x3_y0"):
        sent = [r for r in records if isinstance(r, WorkpiecePatch) and r.patch == name]
        meshes = recording.column(f"workpiece/{name}", "Mesh3D:vertex_positions")
        assert [len(m) for m in meshes] == [len(r.vertices_mm) for r in sent]


def test_a_patch_with_nothing_left_is_cleared(tmp_path: Path) -> None:
    full = patch(0, -1.0, 0.0)
    empty = replace(
        full, t_s=1.0, vertices_mm=full.vertices_mm[:0], normals=full.normals[:0], triangles=full.triangles[:0]
    )
    write(tmp_path / "a.rrd", [RUN.header(), full, empty])
    recording = Recording(tmp_path / "a.rrd")
    assert len(recording.column("workpiece/x0_y0", "Mesh3D:vertex_positions")) == 1
    assert recording.column("workpiece/x0_y0", "Clear:is_recursive") == [[False]]


def test_a_tool_without_a_shape_is_cleared(tmp_path: Path) -> None:
    step = replace(RUN.rapid(0, 0.0, (0.0, 0.0, 5.0), (1.0, 0.0, 5.0), 1), tool=0)
    write(tmp_path / "a.rrd", [RUN.header(), step])
    assert Recording(tmp_path / "a.rrd").column(layout.TOOL, "Clear:is_recursive") == [[False]]


def test_a_long_motion_moves_the_drawn_tool_on_the_way(tmp_path: Path) -> None:
    step = replace(RUN.rapid(0, 0.0, (0.0, 0.0, 5.0), (10.0, 0.0, 5.0), 1), duration_s=1.0)
    write(tmp_path / "a.rrd", [RUN.header(), step])
    tips = np.array(Recording(tmp_path / "a.rrd").column(layout.TOOL, "Transform3D:translation")).reshape(-1, 3)
    np.testing.assert_allclose(tips[:, 0], np.linspace(0.0, 10.0, 26), atol=1e-5)


def test_an_empty_run_is_a_recording(tmp_path: Path) -> None:
    write(tmp_path / "a.rrd", [RUN.header()])
    assert "force/samples" in Recording(tmp_path / "a.rrd").tables


def test_a_run_ended_early_is_kept(tmp_path: Path, records: list[Record]) -> None:
    begin = list(takewhile(lambda r: not isinstance(r, Collision | RunSummary), records))
    with pytest.raises(KeyboardInterrupt), RerunSink(rrd=tmp_path / "a.rrd") as sink:
        for record in begin:
            sink.write(record)
        raise KeyboardInterrupt
    samples = sum(len(s.samples.t_s) for s in steps_of(begin))
    assert len(Recording(tmp_path / "a.rrd").column("force/samples", "Scalars:scalars")) == samples


def test_without_a_header_no_file_is_left(tmp_path: Path) -> None:
    RerunSink(rrd=tmp_path / "a.rrd").close()
    assert list(tmp_path.iterdir()) == []


def test_the_final_name_comes_with_the_end(tmp_path: Path) -> None:
    sink = RerunSink(rrd=tmp_path / "sub" / "a.rrd")
    sink.write(RUN.header())
    assert [p.name for p in (tmp_path / "sub").iterdir()] == ["a.partial.rrd"]
    sink.close()
    sink.close()
    assert [p.name for p in (tmp_path / "sub").iterdir()] == ["a.rrd"]


@pytest.mark.parametrize("begun", [False, True])
def test_a_discarded_run_leaves_no_file(tmp_path: Path, begun: bool) -> None:
    sink = RerunSink(rrd=tmp_path / "a.rrd")
    if begun:
        sink.write(RUN.header())
    sink.discard()
    sink.discard()
    sink.close()
    assert list(tmp_path.iterdir()) == []


def test_an_existing_file_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "a.rrd"
    path.write_bytes(b"mine")
    with pytest.raises(ArchiveError) as caught:
        RerunSink(rrd=path)
    assert str(caught.value) == f"{path}: already exists; replace it with --force"
    assert path.read_bytes() == b"mine"


def test_an_existing_file_is_replaced_by_force(tmp_path: Path) -> None:
    path = tmp_path / "a.rrd"
    path.write_bytes(b"mine")
    with RerunSink(rrd=path, force=True) as sink:
        sink.write(RUN.header())
    assert "force/samples" in Recording(path).tables


def test_a_run_begins_with_its_header(tmp_path: Path) -> None:
    with RerunSink(rrd=tmp_path / "a.rrd") as sink:
        with pytest.raises(ArchiveError) as caught:
            sink.write(NcEvent(t_s=0.0, nc_line=1, kind="block", text="G0"))
        assert str(caught.value) == "a run begins with its RunHeader, got NcEvent"
        sink.write(RUN.header())
        with pytest.raises(ArchiveError) as caught:
            sink.write(RUN.header())
        assert str(caught.value) == "a run has one RunHeader, got a second one"
    with pytest.raises(ArchiveError) as caught:
        sink.write(RUN.header())
    assert str(caught.value) == "the recording is closed"


def test_somewhere_to_write_is_needed() -> None:
    with pytest.raises(ValueError, match=r"^rrd, spawn or web must be given$"):
        RerunSink()


def test_a_full_disk_is_an_error_and_keeps_what_was_written(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = tmp_path / "a.rrd"
    whole, room = rerun_file.os.write, [20_000]

    def small_disk(file: int, data: memoryview) -> int:
        if room[0] <= 0:
            raise OSError(28, "No space left on device")
        room[0] -= len(data)
        return whole(file, data)

    monkeypatch.setattr("twin.archive.container.partial.os.write", small_disk)
    sink = RerunSink(rrd=path)
    with pytest.raises(ArchiveError) as caught:
        for record in SlotRun(step_mm=0.5, per_turn=360).records():
            sink.write(record)
        sink.close()
    partial = tmp_path / "a.partial.rrd"
    kept = f"the part written so far is kept in {partial}"
    assert str(caught.value) == f"{path}: cannot be written: no space left on device; {kept}"
    sink.close()
    assert partial.exists()
    assert not path.exists()


def test_where_pipes_have_no_names_the_file_is_the_same(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, records: list[Record]
) -> None:
    monkeypatch.setattr(rerun_file, "_OPEN_FILES", tmp_path / "missing")
    write(tmp_path / "a.rrd", records)
    samples = sum(len(s.samples.t_s) for s in steps_of(records))
    assert len(Recording(tmp_path / "a.rrd").column("force/samples", "Scalars:scalars")) == samples


def test_the_header_names_the_recording(tmp_path: Path) -> None:
    header: RunHeader = RUN.header()
    write(tmp_path / "a.rrd", [header])
    (entry,) = RrdReader(tmp_path / "a.rrd").recordings()
    assert entry.application_id == layout.APPLICATION_ID
