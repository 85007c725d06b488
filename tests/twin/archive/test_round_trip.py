"""What is read is what was written."""

from __future__ import annotations

import dataclasses
import tracemalloc

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from hypothesis.extra import numpy as hnp

from twin.archive import read_run, run_info, run_writer
from twin.archive.run_writer import RunWriter
from twin.errors import ArchiveError
from twin.record import ForceSamples, NcEvent, RunSummary, Step

NUMBERS = st.floats(allow_nan=False, allow_infinity=False)
TIMES = st.floats(0.0, 1e6)


def test_every_kind_of_record_comes_back_in_order(run_records, write, same):
    same(list(read_run(write(run_records))), run_records)


@pytest.mark.parametrize("chunk_bytes", [1, 600, 5000])
def test_chunk_boundaries_leave_no_trace(run_records, write, same, monkeypatch, chunk_bytes):
    monkeypatch.setattr(run_writer, "CHUNK_BYTES", chunk_bytes)
    same(list(read_run(write(run_records))), run_records)


def test_a_run_of_its_header_alone(run_records, write, same):
    path = write(run_records[:1])
    same(list(read_run(path)), run_records[:1])
    info = run_info(path)
    assert (info.counts, info.duration_s, info.summary, info.complete, info.intact) == ({}, 0.0, None, False, True)


@settings(max_examples=40, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(
    numbers=hnp.arrays(np.float64, st.tuples(st.integers(0, 9), st.just(6)), elements=NUMBERS),
    start=TIMES,
    line=st.integers(0, 2**31 - 1),
    tool=st.integers(0, 2**31 - 1),
)
def test_any_numbers_come_back(run_records, same, new_step, tmp_path, numbers, start, line, tool):
    """Bit for bit, but forces, torque and power within less than a millionth of the step's largest."""
    samples = ForceSamples(
        t_s=start + np.arange(len(numbers)) * 1e-5,
        spindle_angle_rad=numbers[:, 0].copy(),
        force_n=numbers[:, 1:4].copy(),
        torque_nm=numbers[:, 4].copy(),
        power_w=numbers[:, 5].copy(),
    )
    step = dataclasses.replace(new_step(0), t_s=start, nc_line=line, tool=tool, samples=samples)
    event = NcEvent(t_s=start, nc_line=line, kind="block", text=f"{line}: 1: x\n")
    data = bytearray()
    writer = RunWriter(data.extend)
    for record in (run_records[0], event, step):
        writer.write(record)
    writer.finish()
    (path := tmp_path / "any.mcap").write_bytes(data)
    *others, got = read_run(path)
    for name in ("force_n", "torque_nm", "power_w"):
        values, stored = getattr(samples, name), getattr(got.samples, name)
        with np.errstate(over="ignore"):
            off = np.abs(stored / 4 - values / 4).max(initial=0.0)
        assert off <= 1e-6 * (np.abs(values).max(initial=0.0) / 4) + 5e-324, name
    kept = {name: getattr(got.samples, name) for name in ("force_n", "torque_nm", "power_w")}
    same(
        [*others, got], [run_records[0], event, dataclasses.replace(step, samples=dataclasses.replace(samples, **kept))]
    )


def test_numbers_of_numpy_in_a_summary_are_numbers(run_records, write, same):
    summary = dataclasses.replace(run_records[-1], steps=np.int64(40), machine_time_s=np.float64(0.0125))
    same(list(read_run(write([run_records[0], summary])))[-1], run_records[-1])


def test_a_chunk_is_completed_when_its_first_record_has_waited(run_records, new_step):
    now, pieces = [0.0], []
    writer = RunWriter(pieces.append, clock=lambda: now[0])
    writer.write(run_records[0])
    before = len(pieces)
    for second, grown in ((0.0, 0), (1.9, 0), (2.1, 1), (4.0, 1), (4.2, 1), (6.1, 2)):
        now[0] = second
        writer.write(new_step(0))
        assert len(pieces) - before == grown, second


def test_the_first_record_is_the_header(run_records):
    with pytest.raises(ArchiveError, match=r"^a run begins with its RunHeader, got Step$"):
        RunWriter(bytearray().extend).write(next(r for r in run_records if isinstance(r, Step)))


def test_a_second_header_is_refused(run_records):
    writer = RunWriter(bytearray().extend)
    writer.write(run_records[0])
    with pytest.raises(ArchiveError, match=r"^a run has one RunHeader, got a second one$"):
        writer.write(run_records[0])


@pytest.mark.parametrize("name", ["slot.nc", "twin.tools.json"])
def test_two_attachments_of_one_name_are_refused(run_records, name):
    header = run_records[0]
    double = dataclasses.replace(header.attachments[0], name=name)
    message = f"attachment '{name}' is there twice; names of attachments must differ"
    with pytest.raises(ArchiveError, match=f"^{message}$"):
        RunWriter(bytearray().extend).write(dataclasses.replace(header, attachments=(*header.attachments, double)))


def test_info_of_a_whole_file(run_records, write):
    path = write(run_records)
    info = run_info(path)
    assert info.path == path
    assert info.header.tools[1].description == "flat Ø4 z3"
    assert info.summary == run_records[-1]
    assert (info.complete, info.intact, info.duration_s) == (True, True, 0.0125)
    assert info.attachments == {"slot.nc": 20, "job.toml": 0}
    assert info.counts == {
        "/nc": 7,
        "/workpiece/x0_y0": 1,
        "/workpiece/x0_y1": 2,
        "/machine/tool/shape": 2,
        "/machine/tool": 13,
        "/engagement": 12,
        "/force/packed": 1,
        "/force/revolution": 2,
        "/collision": 1,
    }


def test_a_run_ended_by_the_user_is_whole_but_not_complete(run_records, write):
    stopped = dataclasses.replace(run_records[-1], complete=False)
    info = run_info(write([*run_records[:-1], stopped]))
    assert (info.complete, info.intact, info.summary) == (False, True, stopped)


def test_without_a_summary_the_duration_is_that_of_the_last_message(run_records, write):
    info = run_info(write(run_records[:-1]))
    last = run_records[-2]
    assert info.summary is None
    assert info.duration_s == pytest.approx(last.t_s + last.duration_s, abs=1e-9)


def test_memory_stays_flat_however_long_the_run(run_records, write, new_step):
    def records():
        yield run_records[0]
        for index in range(400):
            yield new_step(index, samples=1000)

    tracemalloc.start()
    path = write(records())
    count = sum(len(r.samples.t_s) for r in read_run(path) if isinstance(r, Step))
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert count == 400_000
    assert peak < 16e6 < count * 104  # bytes: a few chunks, not the run


def test_a_summary_is_the_last_record(run_records, write):
    assert isinstance(list(read_run(write(run_records)))[-1], RunSummary)
