"""MATLAB files of version 7.3: HDF5 files in which structs are groups, and cells are references."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np

from twin.measured.formats.bounds import check_size
from twin.measured.formats.hdf5 import attribute_text, unit_of
from twin.measured.formats.hdf5_chunks import check_chunks
from twin.measured.formats.matlab_values import COMPLEX, Cell, Channel, Opaque, StructArray, Value
from twin.measured.units import LOGICAL

#: Values nested deeper than this are not a log; references may form a ring.
_MOST_LEVELS = 24
#: Most references that are followed.
_MOST_REFERENCES = 100_000
_OWN = "#"
_NUMERIC = "fiub"


def variables(path: Path, file: Any) -> Iterator[tuple[str, Value]]:
    """Names and values of an open file's variables.

    Raises:
        MeasuredError: larger than such a file may be when unpacked.
        ValueError: damaged.
    """
    reader = _Reader(path, file)
    for name, node in file.items():
        if not name.startswith(_OWN) and (value := reader.value(node, 0)) is not None:
            yield name, value


class _Reader:
    def __init__(self, path: Path, file: Any) -> None:
        self._path, self._file = path, file
        self._bytes = self._followed = 0

    def value(self, node: Any, level: int) -> Value | None:
        """The value of a group or data set, None for an empty one."""
        import h5py

        if level > _MOST_LEVELS:
            raise ValueError(f"values nested more than {_MOST_LEVELS} deep")
        class_name = attribute_text(node.attrs, "MATLAB_class")
        if "MATLAB_sparse" in node.attrs:
            return Opaque("sparse matrix")
        if "MATLAB_object_decode" in node.attrs or class_name == "function_handle":
            return Opaque(class_name or "object")
        if isinstance(node, h5py.Group):
            return self._struct(node, level) if class_name in ("", "struct") else Opaque(class_name)
        if "MATLAB_empty" in node.attrs:
            return None
        if h5py.check_ref_dtype(node.dtype) is not None:
            values = self._referenced(node, level)
            return Cell(tuple(reversed(node.shape)), values)
        if node.dtype.names == ("real", "imag"):
            return self._complex(node, class_name)
        if node.dtype.kind not in _NUMERIC:
            return Opaque(class_name or str(node.dtype))
        if class_name not in ("", "char", "logical", "single", "double") and not class_name.lstrip("u").startswith(
            "int"
        ):
            return Opaque(class_name)
        return self._array(node, class_name)

    def _complex(self, node: Any, class_name: str) -> Value:
        """The real part, where the imaginary one is zero throughout."""
        real = self._array(node, class_name, "real")
        return Opaque(COMPLEX) if np.any(node[()]["imag"]) else real

    def _array(self, node: Any, class_name: str, part: str = "") -> Value:
        self._bytes += 8 * int(node.size)
        check_size(self._path, self._bytes, "its variables")
        check_chunks(self._path, node)
        if class_name == "char":
            return "".join(chr(c) for c in np.ravel(node[()]).tolist() if 0 < c < 0xD800)
        stored = node[()]
        values = np.asarray(stored[part] if part else stored, np.float64).T
        unit = LOGICAL if class_name == "logical" else unit_of(node.attrs)
        return Channel(values, unit) if unit else values

    def _struct(self, group: Any, level: int) -> Value:
        """A struct, or an array of them: then every field is a data set of references without a class."""
        import h5py

        fields = {name: node for name, node in group.items() if not name.startswith(_OWN)}
        arrays = [
            isinstance(n, h5py.Dataset)
            and h5py.check_ref_dtype(n.dtype) is not None
            and not attribute_text(n.attrs, "MATLAB_class")
            for n in fields.values()
        ]
        if fields and all(arrays):
            columns = {name: self._referenced(node, level) for name, node in fields.items()}
            count = min(map(len, columns.values()))
            return StructArray([{name: values[i] for name, values in columns.items()} for i in range(count)])
        found = {name: self.value(node, level + 1) for name, node in fields.items()}
        return {name: value for name, value in found.items() if value is not None}

    def _referenced(self, node: Any, level: int) -> list[Value]:
        """The values that a data set of references refers to, in MATLAB's order."""
        self._followed += int(node.size)
        if self._followed > _MOST_REFERENCES:
            raise ValueError(f"more than {_MOST_REFERENCES} references")
        check_chunks(self._path, node)
        found = []
        for reference in np.ravel(np.asarray(node[()])).tolist():
            value = self.value(self._file[reference], level + 1) if reference else None
            found.append(np.zeros(0) if value is None else value)
        return found
