"""One door for all formats of measured logs."""

from __future__ import annotations

from collections.abc import Sequence
from os import PathLike
from pathlib import Path

from twin.errors import MeasuredError
from twin.measured.log import RawLog
from twin.measured.timing import raw_log


def read_log(
    path: str | PathLike[str],
    *,
    rate_hz: float | None = None,
    columns: Sequence[str] | None = None,
    delimiter: str | None = None,
    decimal: str | None = None,
) -> RawLog:
    """Read a measured log of any known format.

    Args:
        rate_hz: sampling rate where the file does not say it, or to overrule it.
        columns: names of all columns of a text file, with units (``t_s,Fx_N,Fy_N,Fz_N``), in place of its header.
        delimiter: of a text file, ``""`` for white space; found if not given.
        decimal: decimal mark of a text file, ``.`` or ``,``; found if not given.

    Raises:
        MeasuredError: not readable; the message names file, line or column, and what was expected.
    """
    path = Path(path)
    if not path.is_file():
        why = "is a folder" if path.is_dir() else "does not exist"
        raise MeasuredError(f"{path}: {why}, expected a measured log")
    from twin.measured.text import read_text

    table = read_text(path, columns=columns, delimiter=delimiter, decimal=decimal)
    return raw_log(path, table, rate_hz)
