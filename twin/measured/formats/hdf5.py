"""HDF5 files: data sets as columns, their attributes as units and sampling rate."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from twin.arrays import FloatArray
from twin.errors import MeasuredError
from twin.measured.formats.arrays_in import clock_of, columns_table
from twin.measured.formats.bounds import check_size
from twin.measured.formats.hdf5_chunks import check_chunks
from twin.measured.formats.one_clock import Named
from twin.measured.table import Table
from twin.measured.units import LOGICAL

#: The reason why complex numbers are not read.
_NOT_ONE_FORCE = "complex numbers, which are not one force: store their real part, or abs, as one"
_UNIT_KEYS = ("unit", "units", "unit_string", "engineeringunit", "si_unit", "y_unit")


def read_hdf5(path: Path, group: str | None = None) -> Table:
    """Data sets of numbers anywhere in the file; compound ones and matrices are split into columns.

    Attributes give units, rates and starts; ``scale_factor`` and ``add_offset`` turn stored numbers into values, as in
    the CF conventions.

    Raises:
        MeasuredError: no HDF5 file, or nothing in it that is a log.
    """
    import h5py

    arrays: list[Named] = []
    scalars: dict[str, float] = {}
    refused: list[str] = []
    sizes: list[int] = []

    def visit(name: str, node: Any) -> None:
        for key, value in node.attrs.items():
            _scalar(f"{name}/{key}", value, scalars)
        if isinstance(node, h5py.Dataset):
            sizes.append(8 * int(node.size) * max(len(node.dtype.names or ()), 1))
            check_size(path, sum(sizes), "its data sets")
            check_chunks(path, node)
            reason = _dataset(name, node, arrays, scalars)
            refused.extend([f"{name} ({reason})"] if reason else [])

    try:
        with h5py.File(path, "r") as file:
            for key, value in file.attrs.items():
                _scalar(key, value, scalars)
            file.visititems(visit)
    except MeasuredError:
        raise
    except Exception as error:  # h5py raises many kinds on damaged files
        raise MeasuredError(f"{path}: no HDF5 file that can be read: {error}") from error
    return columns_table(path, "HDF5", arrays, scalars, group, refused)


def _dataset(name: str, node: Any, arrays: list[Named], scalars: dict[str, float]) -> str:
    """Take a data set's columns, each with its unit; the reason where it cannot be read."""
    if node.dtype.names:
        units = _field_units(node.attrs, node.dtype.names)
        reasons = []
        for each in node.dtype.names:
            values, reason = _numbers(node.dtype[each], partial(node.__getitem__, each))
            if values is None:
                reasons.append(f"{each}: {reason}")
            else:
                arrays.append(Named(f"{name}/{each}", _unit(node.dtype[each], units.get(each, "")), values))
        return "; ".join(reasons)
    if node.size == 1:
        _scalar(name, node[()], scalars)
    elif node.size:
        values, reason = _numbers(node.dtype, partial(node.__getitem__, ()))
        if values is None:
            return reason
        scale, offset = (_number(node.attrs, key) for key in ("scale_factor", "add_offset"))
        if scale is not None or offset is not None:
            values = values * (1.0 if scale is None else scale) + (offset or 0.0)
        rate_hz, start_s = clock_of({key: v for key in node.attrs if (v := _number(node.attrs, key)) is not None})
        arrays.append(Named(name, _unit(node.dtype, unit_of(node.attrs)), values, rate_hz, start_s))
    return ""


def _numbers(kind: np.dtype[Any], read: Callable[[], Any]) -> tuple[FloatArray | None, str]:
    """Stored values as numbers, complex ones where the imaginary part is zero throughout; else None and the reason."""
    if kind.kind in "fiub":
        return np.asarray(read(), np.float64), ""
    if kind.kind != "c":
        return None, "no numbers"
    values = np.asarray(read())
    return (None, _NOT_ONE_FORCE) if np.any(values.imag) else (values.real.astype(np.float64), "")


def _unit(kind: np.dtype[Any], stated: str) -> str:
    return LOGICAL if kind.kind == "b" else stated


def _scalar(name: str, value: Any, scalars: dict[str, float]) -> None:
    values = np.asarray(value)
    if values.dtype.kind in "fiu" and values.size == 1:
        scalars[name] = float(values.reshape(()))


def unit_of(attributes: Mapping[str, Any]) -> str:
    """The unit that an attribute states, ``""`` without."""
    for key in attributes:
        if key.lower() in _UNIT_KEYS:
            return _text(attributes[key])
    return ""


def _number(attributes: Mapping[str, Any], key: str) -> float | None:
    found: dict[str, float] = {}
    if key in attributes:
        _scalar(key, attributes[key], found)
    return found.get(key)


def _field_units(attributes: Mapping[str, Any], names: tuple[str, ...]) -> dict[str, str]:
    """Units of the fields of a compound data set: ``Fx_unit``, or a list under ``units``."""
    found = {n: _text(attributes[f"{n}_unit"]) for n in names if f"{n}_unit" in attributes}
    for key in attributes:
        if key.lower() in _UNIT_KEYS and np.size(attributes[key]) == len(names):
            found |= {n: _text(u) for n, u in zip(names, np.ravel(attributes[key]), strict=True)}
    return found


def attribute_text(attributes: Mapping[str, Any], key: str) -> str:
    """An attribute as text, ``""`` without."""
    return _text(attributes[key]) if key in attributes else ""


def _text(value: Any) -> str:
    value = value.reshape(-1)[0] if isinstance(value, np.ndarray) and value.size else value
    return value.decode(errors="replace") if isinstance(value, bytes) else str(value)
