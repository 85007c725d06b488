"""MATLAB files of versions 4 to 7.2, read with every length checked: a damaged file is an error, never more.

Layout: MathWorks, "MAT-File Format". Elements have a tag with type and length; a variable is a matrix element, perhaps
compressed, that holds elements for flags, dimensions, name, and data.
"""

from __future__ import annotations

import math
import struct
import zlib
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from twin.arrays import FloatArray
from twin.measured.formats.matlab_values import COMPLEX, Cell, Channel, Opaque, StructArray, Value
from twin.measured.units import LOGICAL

_HEADER_BYTES = 128
_MATRIX, _COMPRESSED = 14, 15
_DTYPES = {1: "i1", 2: "u1", 3: "i2", 4: "u2", 5: "i4", 6: "u4", 7: "f4", 9: "f8", 12: "i8", 13: "u8"}
_TEXT_CODES = {16: "utf-8", 17: "utf-16", 18: "utf-32"}
#: Classes of arrays: 1 cells, 2 structs, 3 objects of the former kind, 4 characters, 6 to 15 numbers.
_OBJECT, _OPAQUE = 3, 17
_OTHER_CLASSES = {5: "sparse matrix", 16: "function handle"}
#: Flags of an array whose numbers have an imaginary part, or are true and false.
_IMAGINARY, _TRUE_FALSE = 0x800, 0x200
_NUMERIC = range(6, 16)
#: Values nested deeper than this are not a log.
_MOST_LEVELS = 24
_V4_DTYPES = {0: "f8", 1: "f4", 2: "i4", 3: "i2", 4: "u2", 5: "u1"}
_V4_HEAD = 20
_EMPTY = np.zeros(0)


class DamagedError(ValueError):
    """Bytes that are not what they claim to be."""


@dataclass(slots=True)
class _Bytes:
    """Elements one after the other; ``order`` is ``<`` or ``>``."""

    data: memoryview
    order: str
    at: int = 0

    def element(self) -> tuple[int, memoryview]:
        """Type and data of the next element."""
        if len(self.data) - self.at < 8:
            raise DamagedError("an element is cut short")
        first, count = struct.unpack_from(f"{self.order}II", self.data, self.at)
        if first >> 16:
            kind, count, begin, used = first & 0xFFFF, first >> 16, self.at + 4, 8
            if count > 4:
                raise DamagedError("a small element is longer than 4 bytes")
        else:
            kind, begin = first, self.at + 8
            used = 8 + count + (-count % 8 if kind != _COMPRESSED else 0)
        if begin + count > len(self.data):
            raise DamagedError(f"an element claims {count} bytes, {len(self.data) - begin} are there")
        self.at += used
        return kind, self.data[begin : begin + count]

    @property
    def done(self) -> bool:
        return self.at >= len(self.data)


def variables(data: bytes, most_bytes: int) -> Iterator[tuple[str, Value]]:
    """Names and values of a file's variables.

    Args:
        most_bytes: that the compressed variables may unpack to together.

    Raises:
        DamagedError: not a MATLAB file of these versions, damaged, or too large when unpacked.
    """
    mark = data[126:128]
    if mark not in (b"IM", b"MI"):
        yield from _version4(data)
        return
    order = "<" if mark == b"IM" else ">"
    left = most_bytes
    elements = _Bytes(memoryview(data)[_HEADER_BYTES:], order)
    while not elements.done:
        kind, body = elements.element()
        if kind == _COMPRESSED:
            unpacked = _unpacked(body, left)
            left -= len(unpacked)
            kind, body = _Bytes(memoryview(unpacked), order).element()
        if kind != _MATRIX:
            raise DamagedError(f"an element of type {kind} where a variable is expected")
        name, value = _matrix(body, order, 0)
        if name and value is not None:
            yield name, value


def _unpacked(body: memoryview, most: int) -> bytes:
    unpacker = zlib.decompressobj()
    try:
        made = unpacker.decompress(body, max(most, 1))
        if unpacker.unconsumed_tail:
            raise DamagedError(f"a variable unpacks to more than the {most / 1e9:.3g} GB expected of this file")
        return made
    except zlib.error as error:
        raise DamagedError(f"a variable cannot be unpacked ({error})") from None


def _matrix(body: memoryview, order: str, level: int) -> tuple[str, Value | None]:
    """Name and value of a matrix element; None for an empty one."""
    if level > _MOST_LEVELS:
        raise DamagedError(f"values nested more than {_MOST_LEVELS} deep")
    if not len(body):
        return "", None
    parts = _Bytes(body, order)
    flags = _integers(parts, order)
    flag = int(flags[0]) if len(flags) else 0
    kind = flag & 0xFF
    if kind == _OPAQUE:
        name, _, class_name = (_text(parts) for _ in range(3))
        return name, Opaque(class_name)
    shape = tuple(map(int, _integers(parts, order)))
    if not shape or min(shape) < 0:
        raise DamagedError(f"dimensions {shape}")
    name, value = _text(parts), _value(parts, order, shape, kind, level)
    if flag & _IMAGINARY and kind in _NUMERIC and np.any(_numbers(parts, order, shape)):
        return name, Opaque(COMPLEX)
    return name, Channel(value, LOGICAL) if flag & _TRUE_FALSE and isinstance(value, np.ndarray) else value


def _value(parts: _Bytes, order: str, shape: tuple[int, ...], kind: int, level: int) -> Value:
    """The value below flags, dimensions and name."""
    if kind in _NUMERIC:
        return _numbers(parts, order, shape)
    if kind in _OTHER_CLASSES:
        return Opaque(_OTHER_CLASSES[kind])
    match kind:
        case 4:
            return _characters(parts, order)
        case 2 | 3:
            return _structs(parts, order, shape, kind, level)
        case 1:
            inner = (_matrix(_expected(parts), order, level + 1)[1] for _ in range(math.prod(shape)))
            return Cell(shape, [_EMPTY if value is None else value for value in inner])
        case _:
            raise DamagedError(f"an array of class {kind}")


def _expected(parts: _Bytes) -> memoryview:
    kind, body = parts.element()
    if kind != _MATRIX:
        raise DamagedError(f"an element of type {kind} where an array is expected")
    return body


def _numbers(parts: _Bytes, order: str, shape: tuple[int, ...]) -> FloatArray:
    kind, body = parts.element()
    values = _array(kind, body, order)
    if values.size != math.prod(shape):
        raise DamagedError(f"{values.size} numbers, expected {' x '.join(map(str, shape))}")
    return values.astype(np.float64).reshape(shape, order="F")


def _characters(parts: _Bytes, order: str) -> str:
    if parts.done:
        return ""
    kind, body = parts.element()
    if kind in _TEXT_CODES:
        code = _TEXT_CODES[kind] + {"<": "-le", ">": "-be"}[order] * (kind != 16)
        return bytes(body).decode(code, errors="replace")
    return "".join(chr(c) for c in _array(kind, body, order).tolist() if 0 < c < 0xD800)


def _structs(parts: _Bytes, order: str, shape: tuple[int, ...], kind: int, level: int) -> Value:
    """A struct, or an object of the former kind with its fields."""
    class_name = _text(parts) if kind == _OBJECT else ""
    lengths = _integers(parts, order)
    length = int(lengths[0]) if len(lengths) == 1 else 0
    names_body = bytes(parts.element()[1])
    if length <= 0 or len(names_body) % length:
        raise DamagedError("names of a struct's fields")
    names = [names_body[i : i + length].split(b"\0")[0].decode("latin-1") for i in range(0, len(names_body), length)]
    count = math.prod(shape)
    if names and count > len(parts.data) // 8:
        raise DamagedError(f"a struct of {count} elements in {len(parts.data)} bytes")
    elements = []
    for _ in range(count if names else 0):
        found = {name: _matrix(_expected(parts), order, level + 1)[1] for name in names}
        elements.append({name: value for name, value in found.items() if value is not None})
    if class_name in ("inline", "function_handle"):
        return Opaque(class_name)
    return elements[0] if len(elements) == 1 else StructArray(elements)


def _integers(parts: _Bytes, order: str) -> FloatArray:
    kind, body = parts.element()
    if kind not in (5, 6):
        raise DamagedError(f"an element of type {kind} where whole numbers are expected")
    return _array(kind, body, order)


def _text(parts: _Bytes) -> str:
    _, body = parts.element()
    return bytes(body).split(b"\0")[0].decode("utf-8", errors="replace")


def _array(kind: int, body: memoryview, order: str) -> FloatArray:
    if kind not in _DTYPES:
        raise DamagedError(f"numbers of type {kind}")
    dtype = np.dtype(f"{order}{_DTYPES[kind]}")
    if len(body) % dtype.itemsize:
        raise DamagedError(f"{len(body)} bytes of numbers of {dtype.itemsize} bytes")
    return np.frombuffer(body, dtype)


def _version4(data: bytes) -> Iterator[tuple[str, Value]]:
    """Variables of a file of version 4: full matrices only."""
    at = 0
    while at < len(data):
        if len(data) - at < _V4_HEAD:
            raise DamagedError("a variable is cut short")
        order = "<" if struct.unpack_from("<I", data, at)[0] < 10_000 else ">"
        mopt, rows, columns, imaginary, length = struct.unpack_from(f"{order}5I", data, at)
        made, kind, layout = mopt // 1000, mopt // 10 % 10, mopt % 10
        if made not in (0, 1) or mopt // 100 % 10 or kind not in _V4_DTYPES or layout > 2 or not 0 < length < 1000:
            raise DamagedError("no header of MATLAB")
        dtype = np.dtype(f"{order}{_V4_DTYPES[kind]}")
        begin = at + _V4_HEAD + length
        size = rows * columns * dtype.itemsize
        end = begin + size * (2 if imaginary else 1)
        if end > len(data):
            raise DamagedError(f"a variable claims {end - begin} bytes, {max(len(data) - begin, 0)} are there")
        name = data[at + _V4_HEAD : begin].split(b"\0")[0].decode("latin-1")
        if layout == 0 and imaginary and np.any(np.frombuffer(data, dtype, rows * columns, begin + size)):
            yield name, Opaque(COMPLEX)
        elif layout == 0:
            values = np.frombuffer(data, dtype, rows * columns, begin)
            yield name, values.astype(np.float64).reshape((rows, columns), order="F")
        elif layout == 2:
            yield name, Opaque("sparse matrix")
        at = end
