"""Files that end early, that are damaged, that are something else."""

from __future__ import annotations

import signal
import subprocess
import sys
import textwrap
import time
from dataclasses import dataclass
from pathlib import Path

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from mcap.writer import Writer

from twin.archive import export_forces, read_forces, read_run, run_info, run_writer
from twin.errors import ArchiveError
from twin.record import Record, RunSummary, Step

ONCE = settings(
    max_examples=150, deadline=None, derandomize=True, suppress_health_check=[HealthCheck.function_scoped_fixture]
)


@dataclass(repr=False)
class Small:
    """A run in several chunks: its bytes and its records."""

    data: bytes
    records: list[Record]


@pytest.fixture
def small(run_records, write, monkeypatch):
    monkeypatch.setattr(run_writer, "CHUNK_BYTES", 1500)
    return Small(write(run_records).read_bytes(), run_records)


def read(path: Path, data: bytes) -> list:
    path.write_bytes(data)
    return list(read_run(path))


@ONCE
@given(share=st.floats(0.0, 1.0, exclude_max=True))
def test_a_file_cut_anywhere_gives_what_came_before(small, same, tmp_path, share):
    data, records = small.data, small.records
    cut = tmp_path / "cut.mcap"
    at = int(share * len(data))
    try:
        got = read(cut, data[:at])
    except ArchiveError as error:
        assert "\n" not in str(error)
        assert str(error).startswith(f"{cut}: ")
        assert at < data.index(b"twin.summary")
        return
    same(got, records[: len(got)])
    info = run_info(cut)
    assert (info.intact, info.complete) == (False, False)
    steps = [r for r in got if isinstance(r, Step)]
    assert info.counts.get("/engagement", 0) >= len(steps)
    assert info.counts.get("/force/packed", 0) > 0 or not any(len(s.samples.t_s) for s in steps)


def test_longer_pieces_hold_more_of_the_run(small, tmp_path):
    data, records = small.data, small.records
    counts = [len(read(tmp_path / "cut.mcap", data[:at])) for at in range(len(data) // 3, len(data), 97)]
    assert counts == sorted(counts)
    assert len(set(counts)) > 3
    assert counts[-1] == len(records)


@ONCE
@given(share=st.floats(0.0, 1.0, exclude_max=True), flip=st.integers(1, 255))
def test_one_wrong_byte_is_an_error_or_harmless_but_no_traceback(small, tmp_path, share, flip):
    data = bytearray(small.data)
    data[int(share * len(data))] ^= flip
    path = tmp_path / "flipped.mcap"
    for use in (lambda: read(path, bytes(data)), lambda: run_info(path)):
        try:
            use()
        except ArchiveError as error:
            assert str(error).startswith(f"{path}: ")


def test_a_wrong_byte_in_a_chunk_is_named(small, tmp_path):
    data = bytearray(small.data)
    frame = data.index(b"zstd") + 40
    data[frame] ^= 0xFF
    with pytest.raises(ArchiveError, match=r"^\S+wrong.mcap: damaged at byte \d+: a chunk that cannot be unpacked$"):
        read(tmp_path / "wrong.mcap", bytes(data))


def test_zeros_after_the_last_chunk_are_an_early_end(small, same, tmp_path):
    data, records = small.data, small.records
    end = data.index(b"twin.summary") - 100
    got = read(tmp_path / "cut.mcap", data[:end] + bytes(4096))
    assert len(got) > 5
    same(got, records[: len(got)])


def foreign(path: Path, profile: str) -> None:
    writer = Writer(str(path))
    writer.start(profile=profile, library="other")
    writer.finish()


WRONG = {
    "empty": (b"", "is empty, expected a run's MCAP file"),
    "text": (b"G1 X10 F200\n", "is not an MCAP file, expected a run's MCAP file"),
    "magic": (b"\x89MCAP0\r\n", "ends within its first bytes, expected a run's MCAP file"),
    "part of the magic": (b"\x89MC", "ends within its first bytes, expected a run's MCAP file"),
}


@pytest.mark.parametrize("use", [lambda p: list(read_run(p)), run_info, read_forces])
@pytest.mark.parametrize("kind", WRONG)
def test_a_file_of_another_kind(tmp_path, kind, use):
    path = tmp_path / "wrong.mcap"
    data, problem = WRONG[kind]
    path.write_bytes(data)
    with pytest.raises(ArchiveError) as error:
        use(path)
    assert str(error.value) == f"{path}: {problem}"


def test_another_profile_is_named(tmp_path):
    foreign(path := tmp_path / "ros.mcap", "ros2")
    with pytest.raises(ArchiveError) as error:
        run_info(path)
    assert str(error.value) == f"{path}: an MCAP file of profile 'ros2', expected 'twin'"


def test_the_profile_alone_makes_no_run(tmp_path):
    foreign(path := tmp_path / "none.mcap", "twin")
    with pytest.raises(ArchiveError, match=r"none.mcap: ends before the run's header is whole \(byte \d+\)$"):
        list(read_run(path))


def test_a_missing_file_and_a_folder(tmp_path):
    with pytest.raises(ArchiveError, match=r"no.mcap: cannot be read: no such file or directory$"):
        run_info(tmp_path / "no.mcap")
    with pytest.raises(ArchiveError, match=r": cannot be read: is a directory$"):
        run_info(tmp_path)


def test_a_missing_file_whose_run_did_not_finish_is_pointed_to(tmp_path):
    (tmp_path / "run.partial.mcap").write_bytes(b"")
    wanted = rf"no such file or directory; a run that did not finish is kept in {tmp_path}/run.partial.mcap$"
    with pytest.raises(ArchiveError, match=wanted):
        run_info(tmp_path / "run.mcap")


WRITES_FOREVER = textwrap.dedent(
    """
    import itertools, sys
    sys.path[:0] = sys.argv[2:]
    import conftest
    from twin.sinks.mcap_sink import McapSink
    sink = McapSink(sys.argv[1])
    sink.write(conftest.make_header())
    for index in itertools.count():
        sink.write(conftest.make_step(index))
        if index == 6_000:
            print("written", flush=True)
    """
)


def start(path: Path, **more) -> subprocess.Popen:
    here = Path(__file__).resolve()
    command = [sys.executable, "-c", WRITES_FOREVER, str(path), str(here.parent), str(here.parents[3])]
    return subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, **more)


def test_a_killed_run_keeps_its_past(tmp_path, new_step, same):
    path = tmp_path / "killed.mcap"
    with start(path) as process:
        assert process.stdout.readline() == "written\n"
        time.sleep(0.05)
        process.send_signal(signal.SIGKILL)
        process.wait()
    assert [p.name for p in tmp_path.iterdir()] == ["killed.partial.mcap"]
    partial = tmp_path / "killed.partial.mcap"
    steps = [r for r in read_run(partial) if isinstance(r, Step)]
    assert len(steps) > 3_000
    same(steps[:50], [new_step(i) for i in range(50)])
    assert [s.index for s in steps] == list(range(len(steps)))
    info = run_info(partial)
    assert (info.intact, info.complete, info.summary) == (False, False, None)
    assert read_forces(partial).num_rows == 5 * len(steps)
    assert export_forces(partial, tmp_path / "killed.csv") == 5 * len(steps)


LIMIT = 2_000_000


def limit_file_size() -> None:
    import resource

    resource.setrlimit(resource.RLIMIT_FSIZE, (LIMIT, LIMIT))


@pytest.mark.skipif(sys.platform == "win32", reason="no limit of file sizes there")
def test_a_full_disk_is_one_error_and_the_partial_file_stays_readable(tmp_path):
    path = tmp_path / "full.mcap"
    with start(path, preexec_fn=limit_file_size) as process:
        _, err = process.communicate()
    partial = tmp_path / "full.partial.mcap"
    assert err.splitlines()[-1] == (
        f"twin.errors.ArchiveError: {path}: cannot be written: file too large; "
        f"the part written so far is kept in {partial}"
    )
    assert [p.name for p in tmp_path.iterdir()] == ["full.partial.mcap"]
    assert partial.stat().st_size <= LIMIT
    records = list(read_run(partial))
    assert len(records) > 1000
    assert not any(isinstance(r, RunSummary) for r in records)
