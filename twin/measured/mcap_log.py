"""MCAP files: a run of this program, or force messages of another one."""

from __future__ import annotations

from pathlib import Path

from twin.archive.foreign import is_run, read_numbers
from twin.errors import ArchiveError, MeasuredError
from twin.measured.table import Table, table


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
        topic, columns = read_numbers(path, group)
    except ArchiveError as error:
        raise MeasuredError(str(error)) from error
    rows = [(name, "", values) for name, values in columns.items()]
    return table(path, f"MCAP, topic {topic}", rows, row_word="message")


def _run(path: Path) -> Table:
    from twin.archive import read_forces

    forces = read_forces(path)
    names = ("t_s", "fx_n", "fy_n", "fz_n", "spindle_angle_rad")
    columns = [(name, "", forces.column(name).to_numpy()) for name in names]
    return table(path, "MCAP, a run of this program", columns, notes=["forces on the tool"])
