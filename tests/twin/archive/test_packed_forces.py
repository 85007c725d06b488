"""Force samples packed together: exact times, forces within their resolution, and damage that is found."""

from __future__ import annotations

import dataclasses
import math
import re
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra import numpy as hnp
from mcap.reader import make_reader

from twin.archive import read_forces, read_run, run_info, run_writer, schemas
from twin.archive.container.container import Container
from twin.archive.run_writer import RunWriter
from twin.archive.samples import packed
from twin.archive.samples.columns import pack, unpack
from twin.comparison.run_forces import read_run_forces
from twin.errors import ArchiveError, CompareError
from twin.record import ForceSamples, Record, RunHeader, Step, WorkpiecePatch

Steps = Callable[..., Step]
Write = Callable[..., Path]
INTEGERS = st.integers(-(2**63), 2**63 - 1)


@given(hnp.arrays(np.int64, st.integers(0, 20), elements=INTEGERS), st.integers(0, 3))
def test_a_column_comes_back(values: Any, order: int) -> None:
    np.testing.assert_array_equal(unpack(pack(values, order), len(values), order), values)


@pytest.mark.parametrize(("data", "count"), [(b"", 3), (bytes(4), 3), (bytes(27), 3), (b"x", 0)])
def test_a_column_of_another_length_is_an_error(data: bytes, count: int) -> None:
    with pytest.raises(ValueError, match=rf"^a column of {count} numbers in {len(data)} bytes$"):
        unpack(data, count, 2)


def test_regular_times_take_a_byte(new_step: Steps) -> None:
    times = np.concatenate([new_step(i).samples.t_s for i in range(100)])
    assert len(pack(times.view(np.int64), 2)) <= 8 * len(times)
    assert np.count_nonzero(np.frombuffer(pack(times.view(np.int64), 2), np.uint8)) < 2 * len(times)


def forced(step: Step, force_n: Any) -> Step:
    """The step with other forces, and a power that follows from the torque."""
    torque = 0.01 * np.abs(force_n).sum(axis=1)
    power = torque * abs(step.spindle_rpm) * (2.0 * math.pi / 60.0)
    return dataclasses.replace(
        step, samples=dataclasses.replace(step.samples, force_n=force_n, torque_nm=torque, power_w=power)
    )


def test_forces_are_within_a_millionth_of_the_step_whatever_they_are_packed_with(
    new_step: Steps, write: Write, run_records: list[Record], monkeypatch: pytest.MonkeyPatch
) -> None:
    """A chunk ends by the clock, so what is read must not depend on where it ended."""
    rng = np.random.default_rng(3)
    scales = 10.0 ** rng.integers(-6, 5, 40)
    steps = [forced(new_step(i), scale * rng.normal(size=(5, 3))) for i, scale in enumerate(scales)]
    together = read_forces(write([run_records[0], *steps], "together.mcap"))
    monkeypatch.setattr(run_writer, "CHUNK_BYTES", 1)
    assert read_forces(write([run_records[0], *steps], "apart.mcap")).equals(together)
    for step, first in zip(steps, range(0, 200, 5), strict=True):
        peak = np.abs(step.samples.force_n).max()
        for axis, name in enumerate(("fx_n", "fy_n", "fz_n")):
            stored = np.asarray(together[name])[first : first + 5]
            np.testing.assert_allclose(stored, step.samples.force_n[:, axis], rtol=0.0, atol=1e-6 * peak)
    torque, power = (np.asarray(together[name]) for name in ("torque_nm", "power_w"))
    np.testing.assert_array_equal(power, torque * 3600.0 * (2.0 * math.pi / 60.0))


@pytest.mark.parametrize("value", [math.nan, math.inf, -1.7e308])
def test_values_beyond_the_units_are_kept_as_they_are(new_step: Steps, value: float) -> None:
    force = np.arange(15.0).reshape(5, 3) / 3.0
    force[2, 1] = value
    step = new_step(0)
    step = dataclasses.replace(step, samples=dataclasses.replace(step.samples, force_n=force))
    (got,) = packed.decode(schemas.message_class(schemas.PACKED).FromString(packed.encode([step])), [3600.0])
    np.testing.assert_array_equal(got.force_n, force)


def revolutions(path: Path) -> list[Any]:
    """The messages of each revolution."""
    with path.open("rb") as stream:
        found = make_reader(stream, validate_crcs=True).iter_messages([schemas.REVOLUTION_TOPIC], log_time_order=False)
        return [(m.log_time, schemas.message_class(schemas.REVOLUTION).FromString(m.data)) for _, _, m in found]


def turns(new_step: Steps, idle: range) -> list[Step]:
    """Eight revolutions of 360 samples, forward, without forces in some of them."""
    steps = []
    for index in range(8):
        step = new_step(index, samples=360)
        angle = 2.0 * math.pi * (index + (np.arange(360) + 0.5) / 360)
        samples = dataclasses.replace(step.samples, t_s=angle / 377.0, spindle_angle_rad=angle)
        if index in idle:
            zero = np.zeros(360)
            samples = dataclasses.replace(samples, force_n=np.zeros((360, 3)), torque_nm=zero, power_w=zero)
        steps.append(dataclasses.replace(step, t_s=float(samples.t_s[0]), samples=samples))
    return steps


@pytest.mark.parametrize("chunk_bytes", [1, 1 << 20])
def test_each_revolution_has_its_lowest_highest_and_mean(
    new_step: Steps, write: Write, run_records: list[Record], monkeypatch: pytest.MonkeyPatch, chunk_bytes: int
) -> None:
    monkeypatch.setattr(run_writer, "CHUNK_BYTES", chunk_bytes)
    steps = turns(new_step, range(0))
    rows = revolutions(write([run_records[0], *steps]))
    assert [time for time, _ in rows] == [round(s.samples.t_s[0] * 1e9) for s in steps]
    for (_, row), step in zip(rows, steps, strict=True):
        force = step.samples.force_n
        for axis, name in enumerate("xyz"):
            got = [getattr(row, f"f{name}_{which}_n") for which in ("lowest", "highest", "mean")]
            column = force[:, axis]
            assert got == pytest.approx([column.min(), column.max(), column.mean()], rel=1e-6, abs=1e-5)
        resultant = np.linalg.norm(force, axis=1)
        assert (row.resultant_highest_n, row.resultant_mean_n) == pytest.approx((resultant.max(), resultant.mean()))
        assert row.torque_highest_nm == pytest.approx(step.samples.torque_nm.max())
        assert row.nc_line == step.nc_line


def test_of_revolutions_without_forces_the_first_and_the_last_are_kept(
    new_step: Steps, write: Write, run_records: list[Record]
) -> None:
    steps = turns(new_step, range(2, 6))
    shown = [0, 1, 2, 5, 6, 7]
    assert [row.t_s for _, row in revolutions(write([run_records[0], *steps]))] == [
        float(steps[i].samples.t_s[0]) for i in shown
    ]


def with_samples(records: list[Record], kept: str) -> list[Record]:
    header = records[0]
    assert isinstance(header, RunHeader)
    return [dataclasses.replace(header, parameters={**header.parameters, "output.samples": kept}), *records[1:]]


@pytest.mark.parametrize(("kept", "rows"), [("all", 8 * 360), ("cutting", 4 * 360), ("revolution", 0)])
def test_the_job_chooses_the_samples(
    new_step: Steps, write: Write, run_records: list[Record], kept: str, rows: int
) -> None:
    steps = turns(new_step, range(2, 6))
    steps = [s if i not in range(2, 6) else air(s) for i, s in enumerate(steps)]
    path = write(with_samples([run_records[0], *steps, run_records[-1]], kept))
    if rows:
        assert read_forces(path).num_rows == rows
    else:
        reason = 'holds no force samples (output.samples = "revolution"); replay its job with output.samples = "all"'
        with pytest.raises(ArchiveError, match=rf"^{path}: {re.escape(reason)}$"):
            read_forces(path)
        with pytest.raises(CompareError, match=rf"^{path}: {re.escape(reason)}$"):
            read_run_forces(path)
    assert len(revolutions(path)) == 6
    assert len([r for r in read_run(path) if isinstance(r, Step)]) == 8
    assert run_info(path, verify=True).damage is None


def air(step: Step) -> Step:
    return dataclasses.replace(step, engagement=type(step.engagement)())


def test_a_chunk_holds_no_more_samples_than_with_a_message_each(run_records: list[Record], new_step: Steps) -> None:
    pieces: list[bytes] = []
    writer = RunWriter(pieces.append, clock=lambda: 0.0)
    writer.write(run_records[0])
    before = len(pieces)
    for index in range(11):
        writer.write(new_step(index, samples=1000))
    assert len(pieces) == before + 1


def rewritten(monkeypatch: pytest.MonkeyPatch, change: Callable[[Any], None]) -> None:
    """Write packed forces that something is wrong with, in chunks whose checksums are right."""
    encode = packed.encode

    def wrong(steps: list[Step]) -> bytes:
        message = schemas.message_class(schemas.PACKED).FromString(encode(steps))
        change(message)
        return bytes(message.SerializeToString())

    monkeypatch.setattr("twin.archive.container.container.packed.encode", wrong)


def cut_column(message: Any) -> None:
    message.fx_n = message.fx_n[:-1]


def lost_column(message: Any) -> None:
    message.ClearField("torque_nm")


def other_count(message: Any) -> None:
    message.samples[0] += 1


def another_step(message: Any) -> None:
    message.samples.append(5)


def lost_step(message: Any) -> None:
    del message.samples[-1]


def bomb(message: Any) -> None:
    message.samples[:] = [2**32 - 1] * len(message.samples)


def lost_exponent(message: Any) -> None:
    del message.force_exponent[-1]


@pytest.mark.parametrize(
    "change",
    [cut_column, lost_column, other_count, another_step, lost_step, bomb, lost_exponent],
    ids=lambda f: f.__name__,
)
def test_forces_that_do_not_fit_their_steps_are_damage(
    write: Write, run_records: list[Record], monkeypatch: pytest.MonkeyPatch, change: Callable[[Any], None]
) -> None:
    rewritten(monkeypatch, change)
    path = write(run_records)
    with pytest.raises(ArchiveError, match=rf"^{path}: damaged at byte \d+"):
        list(read_run(path))
    assert run_info(path, verify=True).damage is not None


def test_a_message_of_impossible_length_takes_no_memory(new_step: Steps) -> None:
    message = schemas.message_class(schemas.PACKED).FromString(packed.encode([new_step(0)]))
    bomb(message)
    with pytest.raises(ValueError, match=r"^4294967295 force samples with the times of 40 at most$"):
        packed.decode(message, [3600.0])


def test_lost_forces_are_damage(write: Write, run_records: list[Record], monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(Container, "_pack_forces", lambda self: self._steps.clear())
    path = write(run_records)
    with pytest.raises(ArchiveError, match=r"step 0 without all of its samples$"):
        list(read_run(path))


def test_normals_are_within_half_a_degree(write: Write, run_records: list[Record]) -> None:
    patch = next(r for r in run_records if isinstance(r, WorkpiecePatch))
    normals = np.random.default_rng(1).normal(size=patch.vertices_mm.shape)
    normals = (normals / np.linalg.norm(normals, axis=1, keepdims=True)).astype(np.float32)
    path = write([run_records[0], dataclasses.replace(patch, normals=normals)])
    got = next(r for r in read_run(path) if isinstance(r, WorkpiecePatch)).normals
    assert (got * normals).sum(axis=1).min() > math.cos(math.radians(0.5))
    assert np.linalg.norm(got, axis=1) == pytest.approx(np.ones(len(got)), abs=1e-6)


def test_an_empty_step_has_empty_arrays(new_step: Steps, write: Write, run_records: list[Record]) -> None:
    step = next(r for r in read_run(write([run_records[0], new_step(0, samples=0)])) if isinstance(r, Step))
    assert isinstance(step.samples, ForceSamples)
    assert step.samples.force_n.shape == (0, 3)
