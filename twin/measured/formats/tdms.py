"""TDMS files of LabVIEW and of National Instruments' loggers."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from twin.errors import MeasuredError
from twin.measured.formats.arrays_in import Named, columns_table
from twin.measured.table import Table

_UNIT_KEYS = ("unit_string", "NI_UnitDescription", "Unit", "unit", "NI_UnitSymbol")


def read_tdms(path: Path, group: str | None = None) -> Table:
    """Channels of all groups, or of one; the sampling rate is the waveforms' increment.

    Raises:
        MeasuredError: no TDMS file, or channels sampled at several rates.
    """
    from nptdms import TdmsFile

    try:
        file = TdmsFile.read(path)
    except Exception as error:  # npTDMS raises many kinds on damaged files
        raise MeasuredError(f"{path}: no TDMS file that can be read: {error}") from error
    arrays: list[Named] = []
    increments: dict[str, float] = {}
    starts: list[float] = []
    for part in file.groups():
        for channel in part.channels():
            name = f"{part.name}/{channel.name}"
            values = _numbers(channel)
            if values is None:
                continue
            arrays.append(Named(name, _unit(channel), values))
            if "wf_increment" in channel.properties and (group is None or part.name == group):
                increments[name] = float(channel.properties["wf_increment"])
                starts.append(float(channel.properties.get("wf_start_offset", 0.0)))
    if len({round(i, 12) for i in increments.values()}) > 1:
        listed = ", ".join(f"{name} {1.0 / i:g} Hz" for name, i in increments.items() if i > 0.0)
        raise MeasuredError(f"{path}: channels at several rates: {listed}; choose a group of one rate by --group")
    scalars = {"wf_increment": next(iter(increments.values())), "t0": starts[0]} if increments else {}
    return columns_table(path, "TDMS", arrays, scalars, group)


def _unit(channel: Any) -> str:
    return next((str(channel.properties[k]) for k in _UNIT_KEYS if channel.properties.get(k)), "")


def _numbers(channel: Any) -> np.ndarray[Any, np.dtype[np.float64]] | None:
    """A channel's values; moments become seconds from the first one."""
    values = np.asarray(channel[:])
    if values.dtype.kind == "M":
        return (values - values[0]) / np.timedelta64(1, "s") if len(values) else None
    return values.astype(np.float64) if values.dtype.kind in "fiub" and len(values) > 1 else None
