"""One door for all formats of measured logs."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from os import PathLike
from pathlib import Path

from twin.errors import MeasuredError
from twin.measured.formats.table import Table
from twin.measured.log import RawLog
from twin.measured.timing import raw_log

_MCAP_MAGIC = b"\x89MCAP"
_PARQUET_MAGIC = b"PAR1"
_TDMS_MAGIC = b"TDSm"
_MATLAB_MAGIC = b"MATLAB "
_ZIP_MAGIC = b"PK\x03\x04"


def read_log(
    path: str | PathLike[str],
    *,
    rate_hz: float | None = None,
    columns: Sequence[str] | None = None,
    delimiter: str | None = None,
    decimal: str | None = None,
    group: str | None = None,
    rpm: float | None = None,
) -> RawLog:
    """Read a measured log of any known format; the format is told by what the file holds, not by its suffix.

    Args:
        rate_hz: sampling rate where the file does not say it, or to overrule it.
        columns: names for all columns, with units (``t_s,Fx_N,Fy_N,Fz_N``), in place of those in the file.
        delimiter: of a text file, ``""`` for white space; found if not given.
        decimal: decimal mark of a text file, ``.`` or ``,``; found if not given.
        group: group of a TDMS or HDF5 file, variable of a MATLAB file, topic of an MCAP file; found if not given.
        rpm: spindle speed that makes time of a column of the spindle's angle, where there is none of time.

    Raises:
        MeasuredError: not readable; the message names file, line or column, and what was expected.
    """
    path = Path(path)
    if not path.is_file():
        why = "is a folder" if path.is_dir() else "does not exist"
        raise MeasuredError(f"{path}: {why}, expected a measured log")
    try:
        table = _read(path, columns, delimiter, decimal, group)
    except OSError as error:
        raise MeasuredError(f"{path}: cannot be read: {(error.strerror or str(error)).lower()}") from error
    return raw_log(path, table, rate_hz, rpm)


def _read(
    path: Path, columns: Sequence[str] | None, delimiter: str | None, decimal: str | None, group: str | None
) -> Table:
    """The file's table, by the reader of its format."""
    binary = _binary(path, group)
    if binary is not None:
        return binary if columns is None else _renamed(path, binary, columns)
    from twin.measured.formats import dynoware, lvm, text

    if lvm.is_lvm(path):
        read = lvm.read_lvm(path)
        return read if columns is None else _renamed(path, read, columns)
    if dynoware.is_dynoware(path):
        return dynoware.read_dynoware(path, columns=columns, delimiter=delimiter, decimal=decimal)
    return text.read_text(path, columns=columns, delimiter=delimiter, decimal=decimal)


def _binary(path: Path, group: str | None) -> Table | None:
    """The table of a binary format, None for text."""
    with path.open("rb") as file:
        begin = file.read(16)
    from twin.measured.formats import hdf5, matlab, mcap_log, parquet, tdms

    if begin.startswith(_MCAP_MAGIC):
        return mcap_log.read_mcap(path, group)
    if begin.startswith(_PARQUET_MAGIC):
        return parquet.read_parquet(path)
    if begin.startswith(_TDMS_MAGIC):
        return tdms.read_tdms(path, group)
    if begin.startswith(_MATLAB_MAGIC) or path.suffix.lower() == ".mat":
        return matlab.read_matlab(path, group)
    if matlab.is_hdf5(path):
        return hdf5.read_hdf5(path, group)
    if begin.startswith(_ZIP_MAGIC):
        raise MeasuredError(f"{path}: a packed file (xlsx, zip); expected a log: save it as CSV or unpack it first")
    return None


def _renamed(path: Path, read: Table, columns: Sequence[str]) -> Table:
    """The table with the user's names."""
    if len(columns) != len(read.names):
        raise MeasuredError(
            f"{path}: {len(read.names)} columns ({', '.join(read.names)}), --columns gives {len(columns)} names"
        )
    return replace(read, names=tuple(columns))
