"""An archive that an earlier version wrote, described in tests/golden/README.md, is read as it was written."""

from __future__ import annotations

import struct
import zlib
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from mcap.opcode import Opcode
from mcap.records import Chunk
from mcap.writer import CompressionType

import twin
from tests.support.rewritten_archive import rewrite
from twin.archive import read_run
from twin.archive.container.chunk import to_bytes
from twin.archive.container.frames import RunFile

ARCHIVE = Path(__file__).parents[2] / "golden" / "archive" / "slot_0_1_0.mcap"
#: Forces and torque are stored as whole multiples of a unit now, as doubles then; everything else is as it was.
FORCES, OTHERS = ("fx_n", "fy_n", "fz_n"), ("torque_nm", "power_w")
DIGEST = "df488a494958d9635c67a895e918a3beebe1bf3734408fc1c4a49084d6ffd601"


@pytest.fixture(scope="module")
def run() -> twin.Run:
    return twin.open_run(ARCHIVE)


def test_it_opens_whole(run: twin.Run) -> None:
    assert run.complete
    assert run.summary.digest == DIGEST
    assert run.summary.removed_volume_mm3 == pytest.approx(13.1, abs=0.05)
    # as the earlier version printed them
    assert run.summary.peak_force_n == pytest.approx((20.5, 31.9, 14.9, 35.6), abs=0.05)
    assert np.abs(run.forces["fy_n"]).max() == pytest.approx(run.summary.peak_force_n[1], rel=1e-6)
    assert len(run.mesh().triangles) > 0


def test_another_program_may_write_it_anew(run: twin.Run, same: Callable[..., None], tmp_path: Path) -> None:
    """The messages of single samples with their zeros omitted, which have no fixed size."""
    rewrite(ARCHIVE, tmp_path / "other.mcap", CompressionType.ZSTD, chunked=True)
    same(list(twin.open_run(tmp_path / "other.mcap").records()), list(run.records()))


def test_a_sample_that_is_lost_in_it_is_damage(tmp_path: Path) -> None:
    """As a writer would lose it: in a chunk whose checksum is right."""
    with RunFile(ARCHIVE) as file:
        first = next(f for f in file.frames() if f.opcode == Opcode.CHUNK)
        content = file.unpack(first)
    at = content.index(struct.pack("<BQH", Opcode.MESSAGE, 95, 1))
    short = content[:at] + content[at + 104 :]
    path = tmp_path / "lost.mcap"
    path.write_bytes(
        ARCHIVE.read_bytes()[: first.offset] + to_bytes(Chunk("", short, 0, 0, zlib.crc32(short), len(short)))
    )
    with pytest.raises(twin.ArchiveError, match=r"message 1 on /force after message -1$"):
        list(read_run(path))


def test_its_job_replays_to_the_same_forces(run: twin.Run, tmp_path: Path) -> None:
    for attachment in run.header.attachments:
        (tmp_path / Path(attachment.name).name).write_bytes(attachment.data)
    now = twin.replay(tmp_path / "job.toml")
    forces = now.forces
    largest = dict.fromkeys(FORCES, max(np.abs(run.forces[name]).max() for name in FORCES))
    largest |= {name: np.abs(run.forces[name]).max() for name in OTHERS}
    for name, values in run.forces.items():
        np.testing.assert_allclose(forces[name], values, rtol=0.0, atol=1e-6 * largest.get(name, 0.0), err_msg=name)
    # tiny edges of cells have since been merged, and motions are no longer divided where the part was drawn
    assert now.summary.removed_volume_mm3 == pytest.approx(run.summary.removed_volume_mm3, rel=5e-4)


def test_its_table_measured_is_what_a_comparison_uses(run: twin.Run, tmp_path: Path) -> None:
    forces = run.forces
    # the job's map: x = -Fy, y = -Fx, z = Fz
    times = np.arange(0.0, float(forces["t_s"][-1]), 1e-3)
    columns = [np.interp(times, forces["t_s"], c) for c in (-forces["fy_n"], -forces["fx_n"], forces["fz_n"])]
    log = tmp_path / "log.csv"
    np.savetxt(log, np.column_stack([times, *columns]), delimiter=",")
    found = twin.compare(ARCHIVE, log)
    assert [window.span_s for window in found.windows] == [(1.0, 2.0)]
    assert found.lag_s == pytest.approx(0.0, abs=1e-3)
    assert all(error.rms_n < 0.02 * run.summary.peak_force_n[3] for error in found.windows[0].errors)
