"""Names, refusals and ends of a run's file."""

from __future__ import annotations

import os
import signal
from concurrent.futures import ThreadPoolExecutor

import pytest

from twin.archive import read_run, run_info
from twin.errors import ArchiveError
from twin.record import Step
from twin.sinks.base import Sink
from twin.sinks.mcap_sink import McapSink


def names(folder) -> list[str]:
    return sorted(p.name for p in folder.iterdir())


def test_the_final_name_comes_with_close(tmp_path, run_records):
    sink: Sink = McapSink(tmp_path / "deep" / "run.mcap")
    for record in run_records:
        sink.write(record)
        assert names(tmp_path / "deep") == ["run.partial.mcap"]
    sink.close()
    sink.close()
    assert names(tmp_path / "deep") == ["run.mcap"]


def test_nothing_is_left_of_a_run_that_never_began(tmp_path):
    with McapSink(tmp_path / "run.mcap"):
        pass
    assert names(tmp_path) == []


def test_a_file_that_is_there_is_refused(tmp_path, run_records):
    (old := tmp_path / "run.mcap").write_text("old")
    with pytest.raises(ArchiveError) as error:
        McapSink(old)
    assert str(error.value) == f"{old}: already exists; replace it with --force"
    assert names(tmp_path) == ["run.mcap"]


def test_force_replaces_only_at_the_end(tmp_path, run_records):
    (old := tmp_path / "run.mcap").write_text("old")
    with McapSink(old, force=True) as sink:
        sink.write(run_records[0])
        assert old.read_text() == "old"
    assert run_info(old).intact
    assert names(tmp_path) == ["run.mcap"]


def test_what_a_killed_run_left_is_not_overwritten(tmp_path, run_records):
    (left := tmp_path / "run.partial.mcap").write_text("past")
    with pytest.raises(ArchiveError) as error:
        McapSink(tmp_path / "run.mcap")
    assert str(error.value) == (f"{left}: file of a run that did not finish; move it away, or replace it with --force")
    assert left.read_text() == "past"
    with McapSink(tmp_path / "run.mcap", force=True) as sink:
        sink.write(run_records[0])
    assert names(tmp_path) == ["run.mcap"]


def test_a_file_that_came_meanwhile_is_not_replaced(tmp_path, run_records):
    sink = McapSink(tmp_path / "run.mcap")
    sink.write(run_records[0])
    (tmp_path / "run.mcap").write_text("other")
    with pytest.raises(ArchiveError) as error:
        sink.close()
    kept = tmp_path / "run.partial.mcap"
    assert str(error.value) == (
        f"{tmp_path}/run.mcap: already exists; replace it with --force; this run is kept in {kept}"
    )
    assert (tmp_path / "run.mcap").read_text() == "other"
    assert run_info(kept).intact


def test_an_exception_leaves_a_whole_file_up_to_there(tmp_path, run_records, same):
    with pytest.raises(KeyboardInterrupt), McapSink(tmp_path / "run.mcap") as sink:
        for record in run_records[:15]:
            sink.write(record)
        raise KeyboardInterrupt
    same(list(read_run(tmp_path / "run.mcap")), run_records[:15])
    assert not run_info(tmp_path / "run.mcap").complete


def test_ctrl_c_while_writing_waits_for_the_record(tmp_path, run_records, same, monkeypatch):
    write = os.write

    def interrupted(file: int, data: bytes) -> int:
        signal.raise_signal(signal.SIGINT)
        done = write(file, data)
        signal.raise_signal(signal.SIGINT)
        return done

    monkeypatch.setattr("twin.archive.run_writer.CHUNK_BYTES", 1)
    monkeypatch.setattr("twin.archive.container.partial.os.write", interrupted)
    sink = McapSink(tmp_path / "run.mcap")
    for record in run_records:
        with pytest.raises(KeyboardInterrupt):
            sink.write(record)
    with pytest.raises(KeyboardInterrupt):
        sink.close()
    same(list(read_run(tmp_path / "run.mcap")), run_records)
    assert run_info(tmp_path / "run.mcap").complete


def test_a_sink_works_in_any_thread(tmp_path, run_records, same):
    with ThreadPoolExecutor(1) as pool, McapSink(tmp_path / "run.mcap") as sink:
        for record in run_records:
            pool.submit(sink.write, record).result()
    same(list(read_run(tmp_path / "run.mcap")), run_records)


def test_writing_after_close_is_an_error(tmp_path, run_records, new_step):
    sink = McapSink(tmp_path / "run.mcap")
    sink.write(run_records[0])
    sink.close()
    with pytest.raises(ArchiveError, match=r"run.mcap: is closed$"):
        sink.write(next(r for r in run_records if isinstance(r, Step)))


def test_a_place_that_cannot_be_written_is_one_error(tmp_path):
    (tmp_path / "file").write_text("")
    with pytest.raises(ArchiveError, match=r"file/run.mcap: cannot be written: (not a directory|file exists)$"):
        McapSink(tmp_path / "file" / "run.mcap")
    device = "/dev/null: is a device or a pipe, which a finished file cannot replace; expected a file name"
    with pytest.raises(ArchiveError, match=rf"^{device}$"):
        McapSink("/dev/null")
