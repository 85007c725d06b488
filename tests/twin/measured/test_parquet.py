"""Parquet logs: names in any bytes, times of day, sizes that a log cannot have."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pyarrow as pa
import pytest
from pyarrow import parquet

from twin.errors import MeasuredError
from twin.measured.forces import read_forces
from twin.measured.read import read_log

F = np.arange(8.0)


def test_a_name_that_is_not_utf8_is_refused(tmp_path: Path) -> None:
    parquet.write_table(pa.table({"t": F / 1000.0, "Fxyz": F}), tmp_path / "a.parquet", store_schema=False)
    data = (tmp_path / "a.parquet").read_bytes()
    (tmp_path / "a.parquet").write_bytes(data.replace(b"Fxyz", b"F\x80yz"))
    with pytest.raises(MeasuredError, match=r"a.parquet: no Parquet file that can be read: a name that is not UTF-8"):
        read_log(tmp_path / "a.parquet")


@pytest.mark.parametrize("unit", ["ms", "us", "ns"])
def test_times_of_day_over_midnight(unit: str, tmp_path: Path) -> None:
    per_s = {"ms": 10**3, "us": 10**6, "ns": 10**9}[unit]
    ticks = (86_399_996 + np.arange(8)) % 86_400_000 * (per_s // 1000)
    kind, whole = (pa.time32("ms"), pa.int32()) if unit == "ms" else (pa.time64(unit), pa.int64())
    columns = {"time": pa.array(ticks, whole).cast(kind), "Fx": F, "Fy": F, "Fz": F, "note": ["a"] * 8}
    parquet.write_table(pa.table(columns), tmp_path / "a.parquet")
    log = read_forces(tmp_path / "a.parquet")
    np.testing.assert_allclose(log.t_s - log.t_s[0], np.arange(8) / 1000.0, atol=1e-9)


def test_a_table_larger_than_its_file_may_be(tmp_path: Path) -> None:
    parquet.write_table(pa.table({"Fx": np.zeros(40_000_000, np.int8)}), tmp_path / "a.parquet")
    with pytest.raises(MeasuredError, match=r"a.parquet: its columns would unpack to 0.32 GB, from a file of"):
        read_log(tmp_path / "a.parquet")


def test_names_that_occur_twice_stay_apart(tmp_path: Path) -> None:
    columns = [pa.array(F / 1000.0), pa.array(F), pa.array(2.0 * F), pa.array(["a"] * 8)]
    parquet.write_table(pa.table(columns, names=["t", "Fx", "Fx", "note"]), tmp_path / "a.parquet")
    log = read_log(tmp_path / "a.parquet")
    assert list(log.columns) == ["Fx", "Fx (2)"]
    assert log.not_read == ("note (string)",)
