"""Forces out of an archive."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import numpy as np
import pyarrow as pa
import pytest
from pyarrow import csv, parquet

from twin.archive import export_forces, force_table, read_forces
from twin.errors import ArchiveError
from twin.record import Step

HEADER = "t_s,spindle_angle_rad,fx_n,fy_n,fz_n,torque_nm,power_w,nc_line,tool"


@pytest.fixture
def path(run_records, write):
    return write(run_records)


def test_a_table_of_every_sample(path, run_records):
    table = read_forces(path)
    steps = [r for r in run_records if isinstance(r, Step)]
    assert ",".join(table.column_names) == HEADER
    np.testing.assert_array_equal(table["t_s"], np.concatenate([s.samples.t_s for s in steps]))
    np.testing.assert_array_equal(table["fy_n"], np.concatenate([s.samples.force_n[:, 1] for s in steps]))
    np.testing.assert_array_equal(table["tool"], [s.tool for s in steps for _ in s.samples.t_s])
    assert table.schema.metadata == {b"force_on": b"tool"}


def test_the_workpiece_feels_the_opposite_force_and_the_same_torque(path):
    tool, part = read_forces(path), read_forces(path, on="workpiece")
    for name in tool.column_names:
        sign = -1.0 if name in ("fx_n", "fy_n", "fz_n") else 1.0
        np.testing.assert_array_equal(part[name], sign * np.asarray(tool[name]))
    assert part.schema.metadata == {b"force_on": b"workpiece"}


@pytest.mark.parametrize("batch_rows", [1, 7, 1 << 18])
@pytest.mark.parametrize("on", ["tool", "workpiece"])
@pytest.mark.parametrize("suffix", [".csv", ".parquet", ".CSV"])
def test_files_hold_the_table(path, tmp_path, monkeypatch, suffix, on, batch_rows):
    monkeypatch.setattr(force_table, "BATCH_ROWS", batch_rows)
    out = tmp_path / f"new/forces{suffix}"
    assert export_forces(path, out, on=on) == 55
    got = (csv.read_csv if suffix.lower() == ".csv" else parquet.read_table)(out)
    wanted = read_forces(path, on=on)
    for name in wanted.column_names:
        np.testing.assert_array_equal(got[name], wanted[name])
    assert [p.name for p in out.parent.iterdir()] == [out.name]


def test_parquet_says_which_body_feels_the_forces(path, tmp_path):
    export_forces(path, tmp_path / "f.parquet", on="workpiece")
    assert parquet.read_schema(tmp_path / "f.parquet").metadata[b"force_on"] == b"workpiece"


def test_csv_begins_with_its_names(path, tmp_path):
    export_forces(path, tmp_path / "f.csv")
    lines = (tmp_path / "f.csv").read_text().splitlines()
    assert lines[0] == HEADER
    assert lines[1].startswith("0,0,") or lines[1].startswith("0,-0,")


def test_no_force_is_no_minus_zero():
    arrays = force_table.force_arrays([], on="workpiece")
    assert {len(a) for a in arrays.values()} == {0}
    assert str(0.0 - 0.0) == "0.0"


def test_a_run_without_forces_is_an_empty_table(run_records, write, tmp_path):
    path = write(run_records[:3])
    assert read_forces(path).num_rows == 0
    assert export_forces(path, tmp_path / "f.csv") == 0
    assert (tmp_path / "f.csv").read_text() == HEADER + "\n"


def test_an_unknown_suffix_names_the_known_ones(path, tmp_path):
    with pytest.raises(ArchiveError, match=r"forces.xlsx: suffix '.xlsx' is not known, expected .csv or .parquet$"):
        export_forces(path, tmp_path / "forces.xlsx")


def test_another_body_is_refused(path, tmp_path):
    with pytest.raises(ArchiveError, match=r"^forces on 'table' are not known, expected 'tool' or 'workpiece'$"):
        export_forces(path, tmp_path / "f.csv", on="table")
    with pytest.raises(ArchiveError, match=r"^forces on 'table' are not known"):
        read_forces(path, on="table")


def test_a_file_that_is_there_is_kept_without_force(path, tmp_path):
    (out := tmp_path / "f.csv").write_text("mine")
    with pytest.raises(ArchiveError, match=r"f.csv: already exists; replace it with --force$"):
        export_forces(path, out)
    assert out.read_text() == "mine"
    assert export_forces(path, out, force=True) == 55
    assert out.read_text().startswith(HEADER)


def test_a_damaged_run_leaves_no_export_and_keeps_the_old_one(run_records, write, tmp_path, monkeypatch):
    monkeypatch.setattr(force_table, "BATCH_ROWS", 1)
    monkeypatch.setattr("twin.archive.run_writer.CHUNK_BYTES", 2000)
    path = write(run_records)
    data = bytearray(path.read_bytes())
    data[data.rindex(b"zstd", 0, data.index(b"twin.summary")) + 30] ^= 0xFF
    path.write_bytes(data)
    (out := tmp_path / "f.csv").write_text("mine")
    with pytest.raises(ArchiveError, match=r"damaged at byte \d+: a chunk whose checksum is wrong$"):
        export_forces(path, out, force=True)
    assert out.read_text() == "mine"
    assert sorted(p.name for p in tmp_path.iterdir()) == ["f.csv", "run.mcap"]


def test_a_place_that_cannot_be_written_is_one_error(path, tmp_path):
    (tmp_path / "file").write_text("")
    with pytest.raises(ArchiveError, match=r"file/f.csv: cannot be written: (not a directory|file exists)$"):
        export_forces(path, tmp_path / "file" / "f.csv")
    (tmp_path / "folder.csv").mkdir()
    with pytest.raises(ArchiveError, match=r"folder.csv: cannot be written: is a directory$"):
        export_forces(path, tmp_path / "folder.csv", force=True)


def test_archive_and_records_give_the_same_table(path, run_records):
    steps = [record for record in run_records if isinstance(record, Step)]
    assert pa.Table.equals(read_forces(path), force_table.force_table(steps).combine_chunks())


def test_the_door_opens_without_arrow_and_viewer():
    code = "import sys, twin.archive, twin.sinks.mcap_sink; print({'pyarrow', 'rerun', 'numba'} & set(sys.modules))"
    root = Path(__file__).parents[3]
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True, cwd=root)
    assert done.stdout == "set()\n"
