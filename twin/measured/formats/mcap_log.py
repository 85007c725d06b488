"""MCAP files: a run of this program, or force messages of another one."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from twin.archive.foreign import is_run, read_numbers
from twin.arrays import FloatArray
from twin.errors import ArchiveError, MeasuredError
from twin.measured.table import Table, few, table


def read_mcap(path: Path, group: str | None = None) -> Table:
    """Forces of a run, or the numbers of one topic's messages.

    Args:
        group: topic to read; found if only one holds forces.

    Raises:
        MeasuredError: no MCAP file, or no topic that can be decided.
    """
    try:
        if group is None and is_run(path):
            return _run(path)
        found = read_numbers(path, group)
    except ArchiveError as error:
        raise MeasuredError(str(error)) from error
    notes = [*found.notes, *([f"fields not read: {few(found.not_read)}"] if found.not_read else [])]
    rows = [(name, "", values) for name, values in found.columns.items()]
    return table(path, f"MCAP, topic {found.topic}", rows, row_word="message", notes=notes, not_read=found.not_read)


def _run(path: Path) -> Table:
    from twin.archive import read_forces

    forces = read_forces(path)
    names = ("t_s", "fx_n", "fy_n", "fz_n", "spindle_angle_rad")
    rows = _air_filled(np.column_stack([forces.column(name).to_numpy() for name in names]))
    columns = [(name, "", rows[:, index]) for index, name in enumerate(names)]
    return table(path, "MCAP, a run of this program", columns, notes=["forces on the tool"])


def _air_filled(rows: FloatArray) -> FloatArray:
    """A run's samples, with those added that it omits where nothing is cut: no force, the angle continued.

    Args:
        rows: shape (n, 5): time, forces, angle.
    """
    steps = np.diff(rows[:, 0])
    if not len(steps) or not (usual := float(np.median(steps))) > 0.0:
        return rows
    empty = ~np.any(rows[:, 1:4], axis=1)
    parts, start = [], 0
    for i in np.flatnonzero((steps > 1.5 * usual) & empty[:-1] & empty[1:]).tolist():
        share = np.arange(1, int(steps[i] / usual))[:, None] * usual / steps[i]
        parts += [rows[start : i + 1], rows[i] + share * (rows[i + 1] - rows[i])]
        start = i + 1
    return np.concatenate([*parts, rows[start:]])
