"""MATLAB files: v5 to v7.2 by scipy, v7.3 as the HDF5 files that they are."""

from __future__ import annotations

from pathlib import Path

from twin.errors import MeasuredError
from twin.measured.formats.arrays_in import columns_table, flatten
from twin.measured.formats.hdf5 import read_hdf5
from twin.measured.formats.one_clock import Named
from twin.measured.table import Table

_HDF5_MAGIC = b"\x89HDF\r\n\x1a\n"


def read_matlab(path: Path, group: str | None = None) -> Table:
    """Variables, and fields of structs, as columns; a matrix is one column after the other.

    Raises:
        MeasuredError: no MATLAB file, or nothing in it that is a log.
    """
    if is_hdf5(path):
        return read_hdf5(path, group, format_name="MATLAB v7.3")
    from scipy.io import loadmat

    try:
        data = loadmat(path, simplify_cells=True)
    except Exception as error:  # scipy raises many kinds on damaged files
        raise MeasuredError(f"{path}: no MATLAB file that can be read: {error}") from error
    arrays: list[Named] = []
    scalars: dict[str, float] = {}
    flatten({k: v for k, v in data.items() if not k.startswith("__")}, "", arrays, scalars)
    return columns_table(path, "MATLAB v5", arrays, scalars, group)


def is_hdf5(path: Path) -> bool:
    """Whether the file is HDF5; MATLAB puts 512 bytes of text in front."""
    with path.open("rb") as file:
        begin = file.read(520)
    return begin.startswith(_HDF5_MAGIC) or begin[512:520] == _HDF5_MAGIC
