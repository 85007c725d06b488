"""One entry for all formats of measured logs."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from os import PathLike
from pathlib import Path

from twin.errors import MeasuredError
from twin.measured.formats.isolated import isolated
from twin.measured.log import RawLog
from twin.measured.settings import AS_IN_FILE, LogReading
from twin.measured.table import Table, few
from twin.measured.time_column import raw_log

_MCAP_MAGIC = b"\x89MCAP"
_PARQUET_MAGIC = b"PAR1"
_TDMS_MAGIC = b"TDSm"
_MATLAB_MAGIC = b"MATLAB "
_ZIP_MAGIC = b"PK\x03\x04"
#: A table with more columns is not a log of forces.
_MOST_COLUMNS = 5000


def read_log(path: str | PathLike[str], reading: LogReading = AS_IN_FILE) -> RawLog:
    """Read a measured log of any known format; the format is determined by the content, not by the suffix.

    Args:
        reading: what the file does not state, or states wrongly: sampling rate, names, delimiter, decimal mark, group.

    Raises:
        MeasuredError: not readable; the message names file, line or column, and what was expected.
    """
    path = Path(path)
    if not path.is_file():
        why = "is a folder" if path.is_dir() else "does not exist"
        raise MeasuredError(f"{path}: {why}, expected a measured log")
    try:
        table = _read(path, reading)
    except OSError as error:
        raise MeasuredError(f"{path}: cannot be read: {(error.strerror or str(error)).lower()}") from error
    if len(table.names) > _MOST_COLUMNS:
        raise MeasuredError(f"{path}: {len(table.names)} columns, expected at most {_MOST_COLUMNS}")
    return raw_log(path, table, reading)


def _read(path: Path, reading: LogReading) -> Table:
    """The file's table, by the reader of its format."""
    columns = reading.columns
    binary = _binary(path, reading.group)
    if binary is not None:
        return binary if columns is None else _renamed(path, binary, columns)
    from twin.measured.text import dynoware, lvm, reader

    if lvm.is_lvm(path):
        read = lvm.read_lvm(path)
        return read if columns is None else _renamed(path, read, columns)
    read_text = dynoware.read_dynoware if dynoware.is_dynoware(path) else reader.read_text
    return read_text(path, columns=columns, delimiter=reading.delimiter, decimal=reading.decimal)


def _binary(path: Path, group: str | None) -> Table | None:
    """The table of a binary format, None for text."""
    with path.open("rb") as file:
        begin = file.read(16)
    from twin.measured.formats import hdf5, matlab, mcap_log, parquet, tdms

    if begin.startswith(_MCAP_MAGIC):
        return mcap_log.read_mcap(path, group)
    if begin.startswith(_PARQUET_MAGIC):
        return isolated(path, lambda: parquet.read_parquet(path), "pyarrow.parquet")
    if begin.startswith(_TDMS_MAGIC):
        return tdms.read_tdms(path, group)
    if matlab.is_hdf5(path):
        matlab_own = begin.startswith(_MATLAB_MAGIC) or path.suffix.lower() == ".mat"
        read = matlab.read_matlab if matlab_own else hdf5.read_hdf5
        return isolated(path, lambda: read(path, group), "h5py")
    if begin.startswith(_MATLAB_MAGIC) or path.suffix.lower() == ".mat":
        return matlab.read_matlab(path, group)
    if begin.startswith(_ZIP_MAGIC):
        raise MeasuredError(f"{path}: a packed file (xlsx, zip); expected a log: save it as CSV or unpack it first")
    return None


def _renamed(path: Path, read: Table, columns: Sequence[str]) -> Table:
    """The table with the user's names."""
    if len(columns) != len(read.names):
        raise MeasuredError(
            f"{path}: {len(read.names)} columns ({few(read.names)}), --columns gives {len(columns)} names"
        )
    return replace(read, names=tuple(columns))
