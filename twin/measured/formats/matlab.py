"""MATLAB files: versions 4 to 7.2, and 7.3 as the HDF5 files that they are."""

from __future__ import annotations

from pathlib import Path

from twin.errors import MeasuredError
from twin.measured.formats.arrays_in import columns_table
from twin.measured.formats.bounds import most_bytes
from twin.measured.formats.matlab_values import Columns
from twin.measured.table import Table

_HDF5_MAGIC = b"\x89HDF\r\n\x1a\n"


def read_matlab(path: Path, group: str | None = None) -> Table:
    """Variables, fields of structs and elements of cells as columns; a matrix is one column after the other.

    Raises:
        MeasuredError: no MATLAB file, or nothing in it that is a log; objects are named, with a form that can be read.
    """
    found = Columns()
    if is_hdf5(path):
        _read_v73(path, found)
        return columns_table(path, "MATLAB v7.3", found.arrays, found.scalars, group, found.refused)
    from twin.measured.formats.matlab_v5 import DamagedError, variables

    try:
        for name, value in variables(path.read_bytes(), most_bytes(path)):
            found.add(name, value)
    except (DamagedError, RecursionError) as error:
        raise MeasuredError(f"{path}: no MATLAB file that can be read: {error}") from None
    return columns_table(path, "MATLAB v5", found.arrays, found.scalars, group, found.refused)


def _read_v73(path: Path, found: Columns) -> None:
    import h5py

    from twin.measured.formats.matlab_v73 import variables

    try:
        with h5py.File(path, "r") as file:
            for name, value in variables(path, file):
                found.add(name, value)
    except MeasuredError:
        raise
    except Exception as error:  # h5py raises many kinds on damaged files
        raise MeasuredError(f"{path}: no MATLAB file that can be read: {error}") from error


def is_hdf5(path: Path) -> bool:
    """Whether the file is HDF5; MATLAB puts 512 bytes of text in front."""
    with path.open("rb") as file:
        begin = file.read(520)
    return begin.startswith(_HDF5_MAGIC) or begin[512:520] == _HDF5_MAGIC
