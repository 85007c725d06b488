"""A run kept in memory."""

from __future__ import annotations

import numpy as np

from twin.record import Step
from twin.sinks.base import Sink
from twin.sinks.memory import MemorySink


def test_records_stay_as_they_are(run_records):
    with MemorySink() as sink:
        door: Sink = sink
        assert (sink.header, sink.summary, sink.steps, len(sink.forces()["t_s"])) == (None, None, [], 0)
        for record in run_records:
            door.write(record)
    assert sink.closed
    assert all(kept is given for kept, given in zip(sink.records, run_records, strict=True))
    assert sink.header is run_records[0]
    assert sink.summary is run_records[-1]
    assert len(sink.steps) == 12


def test_forces_on_tool_and_workpiece(run_records):
    sink = MemorySink()
    for record in run_records:
        sink.write(record)
    steps = [r for r in run_records if isinstance(r, Step)]
    tool, part = sink.forces(), sink.forces(on="workpiece")
    force = np.concatenate([s.samples.force_n for s in steps])
    for axis, name in enumerate(("fx_n", "fy_n", "fz_n")):
        np.testing.assert_array_equal(tool[name], force[:, axis])
        np.testing.assert_array_equal(part[name], -force[:, axis])
    np.testing.assert_array_equal(tool["nc_line"], [s.nc_line for s in steps for _ in s.samples.t_s])
    np.testing.assert_array_equal(tool["power_w"], part["power_w"])


def test_table_and_arrays_agree(run_records):
    sink = MemorySink()
    for record in run_records:
        sink.write(record)
    table, arrays = sink.force_table(on="workpiece"), sink.forces(on="workpiece")
    assert table.column_names == list(arrays)
    for name, array in arrays.items():
        np.testing.assert_array_equal(table[name], array)
