"""Whole MCAP message records of messages of a fixed size, encoded and decoded as arrays.

A message with every field written, zeros too, has a fixed size. So consecutive messages of one channel, record heads
and field tags included, are an array of one packed numpy type, and a million of them need no loop in Python.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache

import numpy as np
from numpy.typing import NDArray

from twin.archive import schemas
from twin.archive.container.chunk import MESSAGE_OPCODE, RECORD_HEAD

_WIRE: dict[str, tuple[str, int]] = {"double": ("<f8", 1), "float": ("<f4", 5), "fixed32": ("<u4", 5)}


@cache
def record_type(name: str) -> np.dtype[np.void]:
    """Packed type of the records of a message: record head, message head, then a tag and a value for each field."""
    head = [("opcode", "u1"), ("length", "<u8"), ("channel", "<u2"), ("sequence", "<u4")]
    head += [("log_time", "<u8"), ("publish_time", "<u8")]
    fields = schemas.MESSAGES[name]
    body = [pair for field, _, kind in fields for pair in ((f"tag_{field}", "u1"), (field, _WIRE[kind][0]))]
    return np.dtype(head + body)


@dataclass(frozen=True, slots=True)
class FixedRecords:
    """The records of one channel.

    Attributes:
        template: shape (), a record with all values that are the same in every one.
        constant: shape (k,), positions of the bytes that never change.
        pattern: shape (k,), those bytes.
    """

    template: NDArray[np.void]
    constant: NDArray[np.intp]
    pattern: NDArray[np.uint8]

    @classmethod
    def of(cls, channel: int, name: str) -> FixedRecords:
        """Those of a message, by its full name, on a channel."""
        kind = record_type(name)
        template = np.zeros((), kind)
        template["opcode"] = MESSAGE_OPCODE
        template["length"] = kind.itemsize - RECORD_HEAD
        template["channel"] = channel
        same = ["opcode", "length", "channel"]
        for field, number, wire in schemas.MESSAGES[name]:
            template[f"tag_{field}"] = number << 3 | _WIRE[wire][1]
            same.append(f"tag_{field}")
        spans = [(kind.fields[field][1], kind.fields[field][0].itemsize) for field in same] if kind.fields else []
        constant = np.concatenate([np.arange(start, start + size) for start, size in spans])
        return cls(template, constant, np.frombuffer(template.tobytes(), np.uint8)[constant])

    def empty(self, count: int, sequence: int) -> NDArray[np.void]:
        """Records whose times and fields are still to be set.

        Args:
            sequence: number of the first message on the channel.
        """
        records = np.frombuffer(bytearray(self.template.tobytes() * count), self.template.dtype)
        records["sequence"] = np.arange(sequence, sequence + count, dtype=np.uint64).astype(np.uint32)
        return records

    def match(self, data: bytes, start: int, limit: int) -> NDArray[np.void]:
        """Consecutive records in a chunk.

        Args:
            start: position of the first one.
            limit: largest number of records.

        Returns:
            shape (n,), a view of ``data``; n is 0 if the record has another layout.
        """
        kind = self.template.dtype
        count = min(limit, (len(data) - start) // kind.itemsize)
        raw = np.frombuffer(data, np.uint8, count * kind.itemsize, start).reshape(count, kind.itemsize)
        fits = (raw[:, self.constant] == self.pattern).all(axis=1)
        return np.frombuffer(data, kind, count if fits.all() else int(np.argmin(fits)), start)
