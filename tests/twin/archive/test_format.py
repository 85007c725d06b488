"""The file is a good MCAP file to programs that know nothing of this one."""

from __future__ import annotations

import contextlib
import io
import re
import shutil
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from mcap.opcode import Opcode
from mcap.reader import NonSeekingReader, make_reader
from mcap.records import MessageIndex
from mcap.writer import CompressionType

from tests.support.rewritten_archive import rewrite
from twin.archive import read_run, run_writer, schemas
from twin.archive.container.chunk import MESSAGE_HEAD
from twin.archive.container.frames import RunFile, stream
from twin.errors import ArchiveError
from twin.record import Step

DOC = Path(__file__).parents[3] / "docs" / "archive-format.md"


@pytest.fixture
def path(run_records, write, monkeypatch):
    monkeypatch.setattr(run_writer, "CHUNK_BYTES", 2000)
    return write(run_records, "slot.mcap")


def decoded(path: Path, **select) -> list:
    with path.open("rb") as stream:
        return [
            (channel.topic, message, schemas.embedded_class(schema.data, schema.name).FromString(message.data))
            for schema, channel, message in make_reader(stream, validate_crcs=True).iter_messages(**select)
        ]


def test_the_library_reads_every_message_both_ways(path):
    with path.open("rb") as stream:
        statistics = make_reader(stream).get_summary().statistics
        stream.seek(0)
        in_sequence = list(NonSeekingReader(stream, validate_crcs=True).iter_messages(log_time_order=False))
    assert len(decoded(path)) == len(in_sequence) == statistics.message_count == 45
    assert statistics.chunk_count > 4


def test_the_index_leads_to_every_force_message(path, run_records):
    steps = [r for r in run_records if isinstance(r, Step) and len(r.samples.t_s)]
    forces = decoded(path, topics=["/force/packed"])
    assert [n for _, _, m in forces for n in m.samples] == [len(s.samples.t_s) for s in steps]
    assert [n for _, _, m in forces for n in m.nc_line] == [s.nc_line for s in steps]
    assert [n for _, _, m in forces for n in m.tool] == [s.tool for s in steps]
    ends = np.cumsum([len(m.samples) for _, _, m in forces]) - 1
    assert [m.log_time for _, m, _ in forces] == [round(steps[i].samples.t_s[-1] * 1e9) for i in ends]
    assert [m.sequence for _, m, _ in forces] == list(range(len(forces)))


def test_every_entry_of_every_message_index_points_to_its_message(path):
    with RunFile(path) as file:
        frames = {f.offset: f for f in file.frames()}
        chunk, seen = b"", 0
        for frame in frames.values():
            if frame.opcode == Opcode.CHUNK:
                chunk = file.unpack(frame)
            elif frame.opcode == Opcode.MESSAGE_INDEX:
                index = MessageIndex.read(stream(frame.body))
                for log_time, at in index.records:
                    opcode, _, channel, _, time_ns, _ = MESSAGE_HEAD.unpack_from(chunk, at)
                    assert (opcode, channel, time_ns) == (Opcode.MESSAGE, index.channel_id, log_time)
                seen += len(index.records)
    with path.open("rb") as source:
        summary = make_reader(source).get_summary()
    assert seen == summary.statistics.message_count
    for c in summary.chunk_indexes:
        assert frames[c.chunk_start_offset].opcode == Opcode.CHUNK
        assert {frames[at].opcode for at in c.message_index_offsets.values()} <= {Opcode.MESSAGE_INDEX}


def test_summary_section(path):
    with path.open("rb") as stream:
        reader = make_reader(stream)
        assert (reader.get_header().profile, reader.get_header().library) == ("twin", "machining-twin 0.1.0, archive 2")
        summary = reader.get_summary()
        assert [a.name for a in reader.iter_attachments()] == ["slot.nc", "job.toml", "twin.tools.json"]
        metadata = {m.name: m.metadata for m in reader.iter_metadata()}
    statistics = summary.statistics
    topics = {summary.channels[c].topic: n for c, n in statistics.channel_message_counts.items()}
    assert (topics["/force/packed"], topics["/force/revolution"]) == (5, 2)
    assert (statistics.message_start_time, statistics.message_end_time) == (0, round(60 / 21600 * 1e9))
    assert sum(sum(1 for _ in c.message_index_offsets) > 0 for c in summary.chunk_indexes) == statistics.chunk_count
    assert list(metadata) == ["twin.parameters", "twin.run", "twin.summary"]
    assert metadata["twin.parameters"] == {"cutting.Ktc": "935.62", "program.file": "slot.nc", "crc32": "27850b28"}
    assert metadata["twin.summary"]["mean_force_n"] == "[1.5, 2.5, 3.5, 0.3333333333333333]"


def test_poses_are_starts_of_steps_and_the_end(path, run_records):
    steps = [r for r in run_records if isinstance(r, Step)]
    poses = [m for topic, _, m in decoded(path) if topic == "/machine/tool"]
    wanted = [s.start_mm for s in steps] + [steps[-1].end_mm]
    assert [(p.translation.x, p.translation.y, p.translation.z) for p in poses] == wanted
    assert {(p.parent_frame_id, p.child_frame_id, p.rotation.w) for p in poses} == {("workpiece", "tool", 1.0)}


def test_events_and_collisions_are_log_lines(path):
    logs = [(topic, m.level, m.message, m.name) for topic, _, m in decoded(path, topics=["/nc", "/collision"])]
    assert logs[0] == ("/nc", 2, "1: 0: text of block", "block")
    assert logs[6] == ("/nc", 3, "7: 6: text of notice", "notice")
    assert logs[7][:3] == ("/collision", 4, "slot.nc:4: shank of T12 in the stock at X0.1 Y-0.2 Z0.333")


def test_the_drawn_tool_lies_on_its_profile(path):
    shape = next(m for topic, _, m in decoded(path) if topic == "/machine/tool/shape")
    points = np.frombuffer(shape.data, np.dtype((np.void, shape.point_stride)))
    xyz = np.frombuffer(points.tobytes(), "<f4").reshape(len(points), -1)[:, :3]
    assert (shape.frame_id, shape.fields[2].name, shape.fields[2].offset) == ("tool", "z", 8)
    assert (xyz[:, 2].min(), xyz[:, 2].max()) == (0.0, 40.0)
    assert np.hypot(xyz[:, 0], xyz[:, 1]).max() == pytest.approx(6.0, abs=1e-5)


@pytest.mark.parametrize(
    ("compression", "chunked"),
    [(CompressionType.ZSTD, True), (CompressionType.NONE, True), (CompressionType.NONE, False)],
)
def test_a_run_written_anew_by_another_program_is_the_same(path, run_records, same, tmp_path, compression, chunked):
    rewrite(path, tmp_path / "other.mcap", compression, chunked)
    same(list(read_run(tmp_path / "other.mcap")), run_records)


def test_another_compression_is_named(path, tmp_path):
    data = path.read_bytes().replace(b"zstd", b"zstf")
    (tmp_path / "other.mcap").write_bytes(data[: data.index(b"twin.summary") - 13])
    problem = "a chunk compressed by 'zstf', expected 'zstd', 'lz4' or nothing"
    with pytest.raises(ArchiveError, match=rf"other.mcap: damaged at byte \d+: {problem}$"):
        list(read_run(tmp_path / "other.mcap"))


@pytest.mark.parametrize("name", schemas.MESSAGES)
def test_embedded_schema_and_own_class_agree(name):
    fields = {f.name: f.number for f in schemas.embedded_class(schemas.descriptor_set(name), name).DESCRIPTOR.fields}
    assert fields == {f.name: f.number for f in schemas.message_class(name).DESCRIPTOR.fields}
    assert fields == {field: number for field, number, _ in schemas.MESSAGES[name]}


@pytest.mark.parametrize("name", schemas.MESSAGES)
def test_the_document_prints_every_message(name):
    assert schemas.proto_text(name) in DOC.read_text(encoding="utf-8")


@pytest.mark.parametrize("topic", [*schemas.TOPICS, "/workpiece/<patch>"])
def test_the_document_names_every_topic(topic):
    assert f"| `{topic}` | `{schemas.message_on(topic)}` |" in DOC.read_text(encoding="utf-8")


def test_the_code_in_the_document_reads_the_forces(path, run_records, monkeypatch):
    code = re.search(r"```python\n(.*?)```", DOC.read_text(encoding="utf-8"), re.DOTALL)[1]
    monkeypatch.chdir(path.parent)
    with contextlib.redirect_stdout(io.StringIO()) as out:
        exec(compile(code, str(DOC), "exec"), {})
    rows = [
        f"{t} {f[0]} {f[1]} {f[2]} {s.nc_line}"
        for s in run_records
        if isinstance(s, Step)
        for t, f in zip(s.samples.t_s.tolist(), s.samples.force_n.tolist(), strict=True)
    ]
    assert out.getvalue().splitlines() == rows


RERUN = shutil.which("rerun", path=str(Path(sys.executable).parent)) or shutil.which("rerun")


@pytest.mark.skipif(RERUN is None, reason="needs the rerun program")
def test_rerun_accepts_a_whole_file_and_recovers_a_cut_one(path, tmp_path):
    def rerun(*arguments: str) -> str:
        done = subprocess.run([RERUN, "mcap", *arguments], capture_output=True, text=True, check=True)
        return done.stdout

    checked = rerun("check", "--full", str(path))
    assert len(re.findall(r"^ok ", checked, re.MULTILINE)) == 9
    assert re.search(r"Messages +45\n", rerun("info", str(path)))
    cut = tmp_path / "cut.partial.mcap"
    cut.write_bytes(path.read_bytes()[:-2500])
    assert "/force" in rerun("check", "--recover", str(cut))
