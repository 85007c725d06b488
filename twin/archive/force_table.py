"""Forces of a run as Arrow tables: one row per spindle-angle step."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from typing import TYPE_CHECKING, Any

import numpy as np

from twin.record import Record, Step
from twin.settings.force_on import ForceOn

if TYPE_CHECKING:
    import pyarrow as pa

#: Columns in their order.
COLUMNS = ("t_s", "spindle_angle_rad", "fx_n", "fy_n", "fz_n", "torque_nm", "power_w", "nc_line", "tool")
_INTEGER = ("nc_line", "tool")
#: Least number of rows of a table in a stream, except for the last one.
BATCH_ROWS = 1 << 18


def force_arrays(steps: Iterable[Step], on: ForceOn = "tool") -> dict[str, np.ndarray[Any, Any]]:
    """Samples of many steps, joined.

    Args:
        on: the body on which the force acts; on the workpiece it has the opposite sign, torque and power have not.

    Returns:
        an array of shape (n,) for each of `COLUMNS`.
    """
    steps = [s for s in steps if len(s.samples.t_s)]
    counts = [len(s.samples.t_s) for s in steps]
    force = np.concatenate([np.empty((0, 3)), *(s.samples.force_n for s in steps)])
    force = 0.0 - force if on == "workpiece" else force
    columns = {name: _join([getattr(s.samples, name) for s in steps]) for name in ("t_s", "spindle_angle_rad")}
    columns |= {name: force[:, axis] for axis, name in enumerate(("fx_n", "fy_n", "fz_n"))}
    columns |= {name: _join([getattr(s.samples, name) for s in steps]) for name in ("torque_nm", "power_w")}
    return columns | {n: np.repeat(np.array([getattr(s, n) for s in steps], np.int32), counts) for n in _INTEGER}


def force_schema(on: ForceOn = "tool") -> pa.Schema:
    """Types of `COLUMNS`; the metadata ``force_on`` names the body on which the forces act."""
    import pyarrow as pa

    fields = [pa.field(c, pa.int32() if c in _INTEGER else pa.float64(), nullable=False) for c in COLUMNS]
    return pa.schema(fields, metadata={"force_on": on})


def force_table(steps: Iterable[Step], on: ForceOn = "tool") -> pa.Table:
    """Samples of many steps as one table; see `force_arrays`."""
    import pyarrow as pa

    return pa.Table.from_pydict(force_arrays(steps, on), schema=force_schema(on))


def force_tables(records: Iterable[Record], on: ForceOn = "tool") -> Iterator[pa.Table]:
    """Tables of about `BATCH_ROWS` rows; at least one, which may be empty."""
    return (force_table(steps, on) for steps in _batches(records))


def joined_arrays(records: Iterable[Record]) -> dict[str, np.ndarray[Any, Any]]:
    """All force samples among records, as `force_arrays`, with little more memory than the arrays themselves."""
    batches = list(array_batches(records))
    return {name: np.concatenate([batch.pop(name) for batch in batches]) for name in COLUMNS}


def array_batches(records: Iterable[Record]) -> Iterator[dict[str, np.ndarray[Any, Any]]]:
    """Force samples among records as `force_arrays`, about `BATCH_ROWS` of them together; at least one batch."""
    return (force_arrays(steps) for steps in _batches(records))


def _batches(records: Iterable[Record]) -> Iterator[list[Step]]:
    """Steps with samples, about `BATCH_ROWS` of them together; at least one batch, which may be empty."""
    steps: list[Step] = []
    rows = 0
    sent = False
    for record in records:
        if isinstance(record, Step) and len(record.samples.t_s):
            steps.append(record)
            rows += len(record.samples.t_s)
        if rows >= BATCH_ROWS:
            yield steps
            steps, rows, sent = [], 0, True
    if steps or not sent:
        yield steps


def _join(arrays: list[np.ndarray[Any, Any]]) -> np.ndarray[Any, Any]:
    return np.concatenate([np.empty(0), *arrays])
