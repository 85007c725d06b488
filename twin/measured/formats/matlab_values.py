"""Values of MATLAB variables, and the columns that are among them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import TypeAlias

import numpy as np

from twin.arrays import FloatArray
from twin.measured.formats.one_clock import Named

#: Fields of a struct that names a channel, hold its samples, its unit, its times; in lower case.
_LABELS = ("name", "label", "channel", "channelname", "signalname", "title")
_SAMPLES = ("data", "values", "value", "samples", "y", "signal")
_UNITS = ("unit", "units", "yunit")
_TIMES = ("time", "t", "x", "times")
_STARTS = ("t0", "start", "starttime", "start_time", "wf_start_offset")
_STEPS = ("dt", "delta", "increment", "xinc", "wf_increment")
#: Largest deviation of a channel's steps from their median, as a part of it, for even times.
_EVEN = 1e-3
#: Class name of arrays of complex numbers.
COMPLEX = "complex array"
#: How to save what cannot be read.
_SAVE = {
    COMPLEX: "{0} = real({0}), or abs({0})",
    "table": "writetable({0}, 'log.csv')",
    "timetable": "writetimetable({0}, 'log.csv')",
    "timeseries": "t = {0}.Time; F = {0}.Data; save('log.mat', 't', 'F')",
    "datetime": "t = seconds({0} - {0}(1))",
    "duration": "t = seconds({0})",
    "dataset": "export({0}, 'File', 'log.csv', 'Delimiter', ',')",
}


@dataclass(frozen=True, slots=True)
class Cell:
    """A cell array: shape, and its values in MATLAB's order, columns first."""

    shape: tuple[int, ...]
    values: list[Value]


@dataclass(frozen=True, slots=True)
class StructArray:
    """Structs with the same fields, other than one alone."""

    elements: list[dict[str, Value]]


@dataclass(frozen=True, slots=True)
class Opaque:
    """A value of a class whose contents MATLAB alone can read."""

    class_name: str


Value: TypeAlias = "FloatArray | str | dict[str, Value] | Cell | StructArray | Opaque | Channel"


@dataclass(frozen=True, slots=True)
class Channel:
    """An array with a unit of its own."""

    values: FloatArray
    unit: str


@dataclass(slots=True)
class Columns:
    """Arrays, single numbers by path, and the values that cannot be read, with how to save them."""

    arrays: list[Named] = field(default_factory=list)
    scalars: dict[str, float] = field(default_factory=dict)
    refused: list[str] = field(default_factory=list)

    def add(self, path: str, value: Value) -> None:
        """Take a value and all that it holds."""
        match value:
            case np.ndarray():
                self._array(path, value, "")
            case Channel():
                self._array(path, value.values, value.unit)
            case dict():
                self._struct(path, value)
            case StructArray():
                self._structs(path, value.elements)
            case Cell():
                self._cell(path, value)
            case Opaque():
                name = path.rpartition("/")[2]
                how = _SAVE.get(value.class_name, "save its numbers as arrays").format(name)
                why = "which is not one force" if value.class_name == COMPLEX else "which only MATLAB can read"
                self.refused.append(f"{path} (a MATLAB {value.class_name}, {why}; save it by: {how})")

    def _array(self, path: str, values: FloatArray, unit: str) -> None:
        if values.size == 1:
            self.scalars[path] = float(values.reshape(()))
        elif values.size:
            self.arrays.append(Named(path, unit, values))

    def _struct(self, path: str, fields: Mapping[str, Value]) -> None:
        channel = _channel(path, fields)
        if channel is not None:
            self.arrays.append(channel)
            return
        for key, value in fields.items():
            self.add(f"{path}/{key}" if path else key, value)

    def _structs(self, path: str, elements: Sequence[dict[str, Value]]) -> None:
        """Channels; or fields of one number each, columns over the elements; else each is a struct of its own."""
        channels = [_channel(f"{path}({index})", fields) for index, fields in enumerate(elements, 1)]
        if channels and None not in channels:
            self.arrays += [c for c in channels if c is not None]
            return
        for key in dict.fromkeys(key for fields in elements for key in fields):
            values = [fields.get(key) for fields in elements]
            numbers = [float(v.reshape(())) for v in values if isinstance(v, np.ndarray) and v.size == 1]
            if len(numbers) == len(elements) > 1:
                self.arrays.append(Named(f"{path}/{key}", "", np.array(numbers)))
                elements = [{k: v for k, v in fields.items() if k != key} for fields in elements]
        for index, fields in enumerate(elements, 1):
            self._struct(f"{path}({index})", fields)

    def _cell(self, path: str, cell: Cell) -> None:
        rows = cell.shape[0] if len(cell.shape) == 2 else 0
        numbers = [float(v.reshape(())) for v in cell.values if isinstance(v, np.ndarray) and v.size == 1]
        if len(numbers) == len(cell.values) > 1:
            self.arrays.append(Named(path, "", np.array(numbers).reshape(cell.shape, order="F")))
            return
        columns = [cell.values[i : i + rows] for i in range(0, len(cell.values), rows)] if rows > 1 else []
        if columns and all(isinstance(c[0], str) for c in columns):
            for column in columns:
                below = Cell((rows - 1, 1), column[1:])
                self.add(f"{path}/{column[0]}", column[1] if rows == 2 else below)
            return
        for index, value in enumerate(cell.values, 1):
            self.add(f"{path}{{{index}}}", value)


def _channel(path: str, fields: Mapping[str, Value]) -> Named | None:
    """A struct that names a channel and holds its samples, as a column of that name."""
    lower = {key.lower(): value for key, value in fields.items()}
    label = next((v for k in _LABELS if isinstance(v := lower.get(k), str) and v), None)
    samples = next((v for k in _SAMPLES if isinstance(v := lower.get(k), np.ndarray) and v.size > 1), None)
    if label is None or samples is None:
        return None
    unit = next((v for k in _UNITS if isinstance(v := lower.get(k), str)), "")
    parent = path.rpartition("/")[0] if path.endswith(")") else path
    rate, start = _clock(next((v for k in _TIMES if isinstance(v := lower.get(k), np.ndarray)), None), samples.size)
    step, given = _one(lower, _STEPS), _one(lower, _STARTS)
    if rate is None and step is not None and step > 0.0:
        rate = 1.0 / step
    start = given if start is None else start
    return Named(f"{parent}/{label}" if parent else label, unit, samples, rate, start)


def _one(fields: Mapping[str, Value], names: Sequence[str]) -> float | None:
    """The first of some fields that is a single number."""
    found = (fields.get(name) for name in names)
    return next((float(v.reshape(())) for v in found if isinstance(v, np.ndarray) and v.size == 1), None)


def _clock(times: FloatArray | None, count: int) -> tuple[float | None, float | None]:
    """Rate and start of even times, one for each sample."""
    if times is None or times.size != count or count < 3:
        return None, None
    steps = np.diff(times.reshape(-1))
    usual = float(np.median(steps))
    even = usual > 0.0 and float(np.abs(steps - usual).max()) <= _EVEN * usual
    return (1.0 / float(steps.mean()), float(times.reshape(-1)[0])) if even else (None, None)
