"""Whole MCAP message records of the force topic, encoded and decoded as arrays.

A `twin.CuttingForce` with every field written, zeros too, has a fixed size. So consecutive force messages, record heads
and field tags included, are an array of one packed numpy type, and a million of them need no loop in Python.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from twin.archive import schemas
from twin.arrays import FloatArray
from twin.record import ForceSamples, Step

MESSAGE_OPCODE = 0x05
#: Opcode and length before every MCAP record.
RECORD_HEAD = 9
_WIRE: dict[str, tuple[str, int]] = {"double": ("<f8", 1), "fixed32": ("<u4", 5)}
_FIELDS = schemas.MESSAGES[schemas.FORCE]


def _record_type() -> np.dtype[np.void]:
    """Packed type of one message record: record head, message head, then a tag and a value for each field."""
    head = [("opcode", "u1"), ("length", "<u8"), ("channel", "<u2"), ("sequence", "<u4")]
    head += [("log_time", "<u8"), ("publish_time", "<u8")]
    body = [pair for name, _, kind in _FIELDS for pair in ((f"tag_{name}", "u1"), (name, _WIRE[kind][0]))]
    return np.dtype(head + body)


RECORD: np.dtype[np.void] = _record_type()
#: The doubles of a record follow one another, each after its tag: t_s, angle, fx, fy, fz, torque, power.
_DOUBLES = sum(kind == "double" for _, _, kind in _FIELDS)
_DOUBLE_STRIDE = 9
_FIRST_DOUBLE = RECORD.itemsize - len(_FIELDS) - 8 * _DOUBLES - 4 * (len(_FIELDS) - _DOUBLES) + 1
#: No force messages.
NO_RECORDS: NDArray[np.void] = np.empty(0, RECORD)
_CONSTANT = ("opcode", "length", "channel", *(f"tag_{name}" for name, _, _ in _FIELDS))


def to_ns(t_s: float) -> int:
    """Machine time as the whole nanoseconds of a log time."""
    return round(t_s * 1e9)


@dataclass(frozen=True, slots=True)
class ForceLayout:
    """The force records of one channel.

    Attributes:
        template: shape (), a record with all values that are the same in every one.
        constant: shape (k,), positions of the bytes that never change.
        pattern: shape (k,), those bytes.
    """

    template: NDArray[np.void]
    constant: NDArray[np.intp]
    pattern: NDArray[np.uint8]

    @classmethod
    def of(cls, channel: int) -> ForceLayout:
        """Layout for a channel number."""
        template = np.zeros((), RECORD)
        template["opcode"] = MESSAGE_OPCODE
        template["length"] = RECORD.itemsize - RECORD_HEAD
        template["channel"] = channel
        for name, number, kind in _FIELDS:
            template[f"tag_{name}"] = number << 3 | _WIRE[kind][1]
        spans = (
            [(RECORD.fields[name][1], RECORD.fields[name][0].itemsize) for name in _CONSTANT] if RECORD.fields else []
        )
        constant = np.concatenate([np.arange(start, start + size) for start, size in spans])
        pattern = np.frombuffer(template.tobytes(), np.uint8)[constant]
        return cls(template, constant, pattern)

    def encode(self, steps: Sequence[Step], sequence: int) -> NDArray[np.void]:
        """All samples of some steps as message records, in order.

        Args:
            sequence: number of the first message on the channel.

        Returns:
            shape (n,) of `RECORD`, n the sum of the steps' samples.
        """
        samples = [step.samples for step in steps]
        counts = [len(s.t_s) for s in samples]
        records = np.frombuffer(bytearray(self.template.tobytes() * sum(counts)), RECORD)
        if not len(records):
            return records
        for name, values in _columns(samples).items():
            records[name] = values
        records["log_time"] = records["publish_time"] = np.rint(records["t_s"] * 1e9)
        records["sequence"] = np.arange(sequence, sequence + len(records), dtype=np.uint64).astype(np.uint32)
        records["nc_line"] = np.repeat(np.array([s.nc_line for s in steps], np.uint32), counts)
        records["tool"] = np.repeat(np.array([s.tool for s in steps], np.uint32), counts)
        return records

    def match(self, data: bytes, start: int, limit: int) -> NDArray[np.void]:
        """Consecutive force records in a chunk.

        Args:
            start: position of the first one.
            limit: largest number of records.

        Returns:
            shape (n,) of `RECORD`, a view of ``data``; n is 0 if the record has another layout.
        """
        count = min(limit, (len(data) - start) // RECORD.itemsize)
        raw = np.frombuffer(data, np.uint8, count * RECORD.itemsize, start).reshape(count, RECORD.itemsize)
        fits = (raw[:, self.constant] == self.pattern).all(axis=1)
        n = count if fits.all() else int(np.argmin(fits))
        return np.frombuffer(data, RECORD, n, start)


def _columns(samples: Sequence[ForceSamples]) -> dict[str, FloatArray]:
    """The samples of several steps, joined, by field name."""
    force = np.concatenate([s.force_n for s in samples])
    return {
        "t_s": np.concatenate([s.t_s for s in samples]),
        "spindle_angle_rad": np.concatenate([s.spindle_angle_rad for s in samples]),
        "fx_n": force[:, 0],
        "fy_n": force[:, 1],
        "fz_n": force[:, 2],
        "torque_nm": np.concatenate([s.torque_nm for s in samples]),
        "power_w": np.concatenate([s.power_w for s in samples]),
    }


def row(message: Any) -> NDArray[np.void]:
    """One decoded protobuf message as a record array of length 1, for the payloads of other writers."""
    record = np.zeros(1, RECORD)
    for name, _, _ in _FIELDS:
        record[name] = getattr(message, name)
    return record


def to_samples(blocks: Sequence[NDArray[np.void]]) -> ForceSamples:
    """Force records as the samples of one step; the arrays are copies and read-only."""
    columns = np.concatenate([_doubles(b) for b in blocks] or [np.empty((_DOUBLES, 0))], axis=1)
    force = np.ascontiguousarray(columns[2:5].T)
    columns.flags.writeable = force.flags.writeable = False
    t_s, angle, _, _, _, torque, power = columns
    return ForceSamples(t_s=t_s, spindle_angle_rad=angle, force_n=force, torque_nm=torque, power_w=power)


def _doubles(block: NDArray[np.void]) -> NDArray[np.float64]:
    """View of the doubles of n > 0 records, shape (`_DOUBLES`, n)."""
    strides = (_DOUBLE_STRIDE, RECORD.itemsize)
    return np.ndarray((_DOUBLES, len(block)), "<f8", block.data, _FIRST_DOUBLE, strides)
