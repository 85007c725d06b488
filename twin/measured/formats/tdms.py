"""TDMS files of LabVIEW and of National Instruments' loggers."""

from __future__ import annotations

import logging
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from twin.arrays import FloatArray
from twin.errors import MeasuredError
from twin.measured.formats.arrays_in import columns_table
from twin.measured.formats.one_clock import Named
from twin.measured.formats.tdms_parts import Part, parts_of, times_of
from twin.measured.table import Table
from twin.measured.units import LOGICAL

_LONGEST_NOTE = 120
#: LabVIEW writes the beginning of its own time where no start is known.
_NO_START = np.datetime64("1970-01-01T00:00:00", "us")
_UNIT_KEYS = ("unit_string", "NI_UnitDescription", "Unit", "unit", "NI_UnitSymbol")


def read_tdms(path: Path, group: str | None = None) -> Table:
    """Channels of all groups, or of one; the sampling rate is the waveforms' increment.

    Raises:
        MeasuredError: no TDMS file, or channels sampled at several rates.
    """
    from nptdms import TdmsFile

    try:
        with _warnings() as notes:
            file = TdmsFile.read(path)
            parts = parts_of(path)
    except Exception as error:  # npTDMS raises many kinds on damaged files
        raise MeasuredError(f"{path}: no TDMS file that can be read: {error}") from error
    arrays: list[Named] = []
    starts: dict[str, tuple[Any, float]] = {}
    times: dict[str, FloatArray | None] = {}
    refused: list[str] = []
    for part in file.groups():
        for channel in part.channels():
            values = _numbers(channel)
            if values is None:
                refused.extend([f"{part.name}/{channel.name} (no numbers)"] if len(channel) > 1 else [])
                continue
            name, properties = f"{part.name}/{channel.name}", channel.properties
            step = float(properties.get("wf_increment", 0.0))
            arrays.append(Named(name, _unit(channel), values, 1.0 / step if step > 0.0 else None))
            starts[name] = _start(properties, parts.get(channel.path, []))
            if step > 0.0:
                times[name] = times_of(path, name, parts.get(channel.path, []), len(values), step)
    arrays += _time_arrays(path, arrays, times, starts)
    read = columns_table(path, "TDMS", _started(arrays, starts), {}, group, refused)
    return replace(read, notes=(*read.notes, *notes))


@contextmanager
def _warnings() -> Iterator[list[str]]:
    """The warnings that npTDMS would print: on data cut short, and the like."""
    from nptdms.log import log_manager

    texts: list[str] = []

    class _Notes(logging.Handler):
        def emit(self, record: logging.LogRecord) -> None:
            text = record.getMessage()
            texts.append(f"damaged: {text[:_LONGEST_NOTE]}{'...' if text[_LONGEST_NOTE:] else ''}")

    handler, level = _Notes(), log_manager.console_handler.level
    log_manager.console_handler.setLevel(logging.CRITICAL)
    for logger in log_manager.loggers.values():
        logger.addHandler(handler)
    try:
        yield texts
    finally:
        log_manager.console_handler.setLevel(level)
        for logger in log_manager.loggers.values():
            logger.removeHandler(handler)


def _started(arrays: list[Named], starts: dict[str, tuple[Any, float]]) -> list[Named]:
    """The channels with the time of their first sample: start time of the waveform and offset from it.

    A file without start times, or with one for all, counts from it.
    """
    moments = {n: np.datetime64(t).astype("datetime64[us]") for n, (t, _) in starts.items() if t is not None}
    moments = {n: t for n, t in moments.items() if t > _NO_START}
    first = min(moments.values(), default=_NO_START)
    made = []
    for array in arrays:
        moment, offset = moments.get(array.name), starts[array.name][1]
        known = moment is not None or not moments
        seconds = 0.0 if moment is None else float((moment - first) / np.timedelta64(1, "s"))
        made.append(replace(array, start_s=seconds + offset if known else None))
    return made


def _start(properties: Mapping[str, Any], parts: Sequence[Part]) -> tuple[Any, float]:
    """Start time of a waveform and the offset from it; of its first part where there are several."""
    if len(parts) > 1 and parts[0].first == 0:
        return np.datetime64(round(1e6 * parts[0].start_s), "us"), 0.0
    return properties.get("wf_start_time"), float(properties.get("wf_start_offset", 0.0))


def _time_arrays(
    path: Path, arrays: Sequence[Named], times: Mapping[str, FloatArray | None], starts: dict[str, tuple[Any, float]]
) -> Iterator[Named]:
    """A column of time for each group whose channels were written in parts with gaps between them.

    Raises:
        MeasuredError: channels of a group with gaps of different places.
    """
    for group in dict.fromkeys(a.name.rpartition("/")[0] for a in arrays if times.get(a.name) is not None):
        own = [a for a in arrays if a.rate_hz and a.name.rpartition("/")[0] == group]
        first = next(a for a in own if times[a.name] is not None)
        t_s = times[first.name]
        if t_s is None or any((t := times[a.name]) is None or not np.array_equal(t, t_s) for a in own):
            names = ", ".join(a.name for a in own)
            raise MeasuredError(f"{path}: {names} have gaps at different samples; expected forces recorded together")
        name = f"{group}/Time of the parts"
        starts[name] = starts[first.name]
        yield Named(name, "s", t_s, first.rate_hz)


def _unit(channel: Any) -> str:
    if channel.dtype.kind == "b":
        return LOGICAL
    return next((str(channel.properties[k]) for k in _UNIT_KEYS if channel.properties.get(k)), "")


def _numbers(channel: Any) -> np.ndarray[Any, np.dtype[np.float64]] | None:
    """A channel's values; moments become seconds from the first one."""
    values = np.asarray(channel[:])
    if values.dtype.kind == "M":
        return (values - values[0]) / np.timedelta64(1, "s") if len(values) else None
    return values.astype(np.float64) if values.dtype.kind in "fiub" and len(values) > 1 else None
