"""Force samples of records as arrays and as tables."""

from __future__ import annotations

import numpy as np

from twin.archive import force_table as table_module
from twin.archive.force_table import COLUMNS, force_arrays, force_table, force_tables, joined_arrays
from twin.record import Step


def test_forces_on_tool_and_workpiece(run_records):
    steps = [r for r in run_records if isinstance(r, Step)]
    tool, part = force_arrays(steps), force_arrays(steps, on="workpiece")
    force = np.concatenate([s.samples.force_n for s in steps])
    for axis, name in enumerate(("fx_n", "fy_n", "fz_n")):
        np.testing.assert_array_equal(tool[name], force[:, axis])
        np.testing.assert_array_equal(part[name], -force[:, axis])
    np.testing.assert_array_equal(tool["nc_line"], [s.nc_line for s in steps for _ in s.samples.t_s])
    np.testing.assert_array_equal(tool["power_w"], part["power_w"])


def test_table_and_arrays_agree(run_records):
    steps = [r for r in run_records if isinstance(r, Step)]
    table, arrays = force_table(steps, on="workpiece"), force_arrays(steps, on="workpiece")
    assert table.column_names == list(arrays)
    for name, array in arrays.items():
        np.testing.assert_array_equal(table[name], array)


def test_batches_join_to_the_whole(run_records, monkeypatch):
    whole = force_arrays([r for r in run_records if isinstance(r, Step)])
    monkeypatch.setattr(table_module, "BATCH_ROWS", 7)
    assert [t.num_rows for t in force_tables(run_records)][:2] == [10, 10]
    joined = joined_arrays(run_records)
    assert list(joined) == list(COLUMNS)
    for name, array in whole.items():
        assert joined[name].dtype == array.dtype
        np.testing.assert_array_equal(joined[name], array)


def test_records_without_steps_give_empty_arrays(run_records):
    empty = joined_arrays(run_records[:1])
    assert {a.shape for a in empty.values()} == {(0,)}
    assert [t.num_rows for t in force_tables(run_records[:1])] == [0]
