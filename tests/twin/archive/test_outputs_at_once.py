"""Two programs with one output; outputs that are removed while they are written; outputs of the same job."""

from __future__ import annotations

import os
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import pytest

from gcode.whole_file import whole_file
from twin.archive import read_run, run_info
from twin.archive.container.partial import PartialFile, replacing
from twin.archive.same_job import is_recording_of, job_key
from twin.errors import ArchiveError, ToolPathError
from twin.record import Attachment, Record, RunHeader
from twin.sinks.mcap_sink import McapSink
from twin.sinks.rerun.sink import RerunSink


def names(folder: Path) -> list[str]:
    return sorted(p.name for p in folder.iterdir())


@pytest.mark.parametrize("force", [True, False])
def test_a_second_run_onto_the_same_output_is_refused_and_the_first_stays_whole(
    tmp_path: Path, run_records: list[Record], same: Callable[..., None], force: bool
) -> None:
    path = tmp_path / "run.mcap"
    with McapSink(path, force=True) as first:
        for record in run_records[:10]:
            first.write(record)
        with pytest.raises(ArchiveError) as error:
            McapSink(path, force=force)
        assert str(error.value) == (
            f"{tmp_path / 'run.partial.mcap'}: another program is writing this file; wait for its end"
        )
        for record in run_records[10:]:
            first.write(record)
    same(list(read_run(path)), run_records)
    assert names(tmp_path) == ["run.mcap"]


def test_tables_and_pictures_are_locked_as_well(tmp_path: Path) -> None:
    with replacing(tmp_path / "a.csv") as partial:
        partial.write_text("first")
        with (
            pytest.raises(ToolPathError, match="another program is writing"),
            replacing(tmp_path / "a.csv", ToolPathError),
        ):
            pass
    assert (tmp_path / "a.csv").read_text() == "first"
    assert names(tmp_path) == ["a.csv"]


def test_programs_that_are_written_at_the_same_time_are_whole(tmp_path: Path) -> None:
    path = tmp_path / "a.nc"
    with whole_file(path) as first, whole_file(path) as second:
        first.write_text("first")
        second.write_text("second")
    assert path.read_text() == "first"
    assert names(tmp_path) == ["a.nc"]


def test_the_lock_ends_with_the_file(tmp_path: Path) -> None:
    """What a killed run left, even an empty file, is not taken for one that is being written."""
    (tmp_path / "a.partial.mcap").write_bytes(b"")
    PartialFile(tmp_path / "a.mcap").discard()
    (tmp_path / "a.partial.mcap").write_bytes(b"past")
    with pytest.raises(ArchiveError, match="file of a run that did not finish; move it away"):
        PartialFile(tmp_path / "a.mcap")
    PartialFile(tmp_path / "a.mcap", force=True).discard()
    assert names(tmp_path) == []


@pytest.mark.parametrize("again", [True, False], ids=["replaced", "deleted"])
@pytest.mark.parametrize("at", ["write", "commit"])
def test_a_partial_file_that_is_removed_during_the_run_is_one_true_error(tmp_path: Path, at: str, again: bool) -> None:
    file = PartialFile(tmp_path / "a.mcap", keep=True)
    file.write(b"x")
    file.partial.unlink()
    if again:
        file.partial.write_text("other")
    with pytest.raises(ArchiveError) as error:
        file.write(b"y") if at == "write" else file.commit()
    assert str(error.value) == (
        f"{tmp_path / 'a.mcap'}: cannot be written: {file.partial} was removed by another program"
    )
    file.discard()
    assert names(tmp_path) == (["a.partial.mcap"] if again else [])


@pytest.fixture
def job(tmp_path: Path) -> Path:
    (path := tmp_path / "jobs" / "job.toml").parent.mkdir()
    path.write_text("a = 1\n")
    return path


def write(path: Path, records: list[Record], job: Path, key: str, text: str = "a = 1\n") -> None:
    header = records[0]
    assert isinstance(header, RunHeader)
    attached = Attachment(name="job.toml", media_type="application/toml", data=text.encode())
    with McapSink(path, job=job) as sink:
        sink.write(replace(header, job=key, attachments=(attached,)))
        for record in records[1:]:
            sink.write(record)


def test_a_run_of_the_same_job_file_is_replaced(tmp_path: Path, job: Path, run_records: list[Record]) -> None:
    path = tmp_path / "run.mcap"
    write(path, run_records, job, job_key(job))
    job.write_text("a = 2\n")
    write(path, run_records[:4], job, job_key(job))
    assert run_info(path).summary is None
    with McapSink(path, job=job) as sink:
        sink.write(run_records[0])
    assert names(tmp_path) == ["jobs", "run.mcap"]


def test_the_unfinished_run_of_the_same_job_file_is_replaced(tmp_path: Path, job: Path, run_records: list) -> None:
    write(tmp_path / "run.mcap", run_records, job, job_key(job))
    (tmp_path / "run.mcap").rename(tmp_path / "run.partial.mcap")
    write(tmp_path / "run.mcap", run_records, job, job_key(job))
    assert names(tmp_path) == ["jobs", "run.mcap"]


@pytest.mark.parametrize(
    ("key", "text", "replaced"),
    [("", "a = 1\n", True), ("", "a = 2\n", False), ("0" * 16, "a = 1\n", True), ("0" * 16, "a = 2\n", False)],
)
def test_a_run_of_an_equal_job_elsewhere_or_of_another_one(
    tmp_path: Path, job: Path, run_records: list[Record], key: str, text: str, replaced: bool
) -> None:
    """A folder that was moved, or an archive of version 0.1.0, is recognised by the text of the job."""
    path = tmp_path / "run.mcap"
    write(path, run_records, job, key, text)
    if replaced:
        McapSink(path, job=job).discard()
        return
    with pytest.raises(ArchiveError, match="already exists; replace it with --force"):
        McapSink(path, job=job)


@pytest.mark.parametrize("content", [b"mine", b"", b"\x89MCAP0\r\n"])
def test_anything_else_is_not_replaced(tmp_path: Path, job: Path, content: bytes) -> None:
    (path := tmp_path / "run.mcap").write_bytes(content)
    with pytest.raises(ArchiveError, match="already exists; replace it with --force"):
        McapSink(path, job=job)
    assert path.read_bytes() == content


def test_a_recording_of_the_same_job_file_is_recognised(tmp_path: Path, job: Path, run_records: list[Record]) -> None:
    path = tmp_path / "run.rrd"
    header = run_records[0]
    assert isinstance(header, RunHeader)
    with RerunSink(rrd=path, job=job) as sink:
        sink.write(replace(header, job=job_key(job)))
    (other := tmp_path / "jobs" / "other.toml").write_text("a = 1\n")
    assert is_recording_of(path, job) and not is_recording_of(path, other)
    with pytest.raises(ArchiveError, match="already exists"):
        RerunSink(rrd=path, job=other)
    RerunSink(rrd=path, job=job).discard()
    assert names(tmp_path) == ["jobs", "run.rrd"]


def test_a_device_is_not_replaced(tmp_path: Path) -> None:
    pipe = tmp_path / "pipe.mcap"
    os.mkfifo(pipe)
    with pytest.raises(ArchiveError, match=r"pipe\.mcap: is a device or a pipe"):
        PartialFile(pipe, force=True)
    assert pipe.is_fifo()
