"""TDMS files of LabVIEW and of National Instruments' loggers."""

from __future__ import annotations

import logging
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from twin.errors import MeasuredError
from twin.measured.formats.arrays_in import columns_table
from twin.measured.formats.one_clock import Named
from twin.measured.table import Table

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
    except Exception as error:  # npTDMS raises many kinds on damaged files
        raise MeasuredError(f"{path}: no TDMS file that can be read: {error}") from error
    arrays: list[Named] = []
    starts: dict[str, tuple[Any, float]] = {}
    for part in file.groups():
        for channel in part.channels():
            values = _numbers(channel)
            if values is None:
                continue
            name, properties = f"{part.name}/{channel.name}", channel.properties
            step = float(properties.get("wf_increment", 0.0))
            arrays.append(Named(name, _unit(channel), values, 1.0 / step if step > 0.0 else None))
            starts[name] = properties.get("wf_start_time"), float(properties.get("wf_start_offset", 0.0))
    read = columns_table(path, "TDMS", _started(arrays, starts), {}, group)
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


def _unit(channel: Any) -> str:
    return next((str(channel.properties[k]) for k in _UNIT_KEYS if channel.properties.get(k)), "")


def _numbers(channel: Any) -> np.ndarray[Any, np.dtype[np.float64]] | None:
    """A channel's values; moments become seconds from the first one."""
    values = np.asarray(channel[:])
    if values.dtype.kind == "M":
        return (values - values[0]) / np.timedelta64(1, "s") if len(values) else None
    return values.astype(np.float64) if values.dtype.kind in "fiub" and len(values) > 1 else None
