"""Mutations of bytes and of text; each takes a source of random numbers, so that an input can be made again."""

from __future__ import annotations

import random
import struct
from collections.abc import Callable, Sequence
from functools import partial

from support.fuzz_gcode import (
    change_number,
    delete,
    duplicate,
    flip_bit,
    insert_unicode,
    swap,
)

Mutation = Callable[[random.Random, bytes], bytes]

_NUMBERS = (0, 1, 2, 7, 0x7F, 0x80, 0xFF, 0x7FFF, 0xFFFF, 0x7FFFFFFF, 0x80000000, 0xFFFFFFFF, 1 << 40, (1 << 63) - 1)
_DOUBLES = (0.0, -0.0, 1e308, -1e308, 5e-324, float("inf"), float("nan"), 1e-6, 1e6)
#: Pieces of TOML.
TOML = (
    *("=", "[", "]", "[[", "]]", "{", "}", '"', "'", "'''", "#", "\n", ",", ".", "inf", "nan", "-inf", "1e400", "-1"),
    *(
        "true",
        "false",
        "0x10",
        "1_000",
        "2020-01-01",
        "[[tools]]\n",
        "[stock]\n",
        "{ a = 1 }",
        "\\u0000",
        "\\U0010FFFF",
    ),
    *("1e18", "1e-18", "0", '""', "[]", "[[[[", "\x00", "\x1b[31m", "\u202e", "ß", "\ufeff", "999999999999999999999"),
)
#: Pieces of tables as text.
TABLE = (
    *(",", ";", "\t", " ", '"', "'", "\n", "\r\n", "\r", "-", "NaN", "inf", "1e999", "1,5", "1.234,5", "1'000", "--"),
    *(
        "12:00:00",
        "23:59:59.9",
        "2020-01-01",
        "1/2/2020",
        "PM",
        "Fx",
        "Time",
        "s",
        "kN",
        "#",
        "***End_of_Header***",
        "X_Columns\tMulti\n",
        "1,010",
        "1.010,5",
        "",
    ),
    *("\x00", "\x1b[31m", "\u202e", "\ufeff", "ß", "0x1F", "true", "1e-320", "9" * 400, "\u2009", "\xa0"),
)
#: Pieces of tool libraries: JSON, and sizes as text.
LIBRARY = (
    *("{", "}", "[", "]", ",", ":", '"', "null", "true", "NaN", "Infinity", "-Infinity", "1e999", "-1", "0", "1e-320"),
    *('"unit": "inches",', '"type": "drill",', '"TA": 0.08,', '"DC": "1/0",', '"geometry": [],', '"number": "x",'),
    *('1/4\\"', "30,0 mm", "1.234,5", " in", "°", ";", "\n", "T1", "x", "+", "\\ud800", "\\u0000", "\\u202e"),
    *("\x00", "\ufeff", "9" * 5000, "[" * 2000, "../../", "H1 U2 L3;", "25374.6", "1e18"),
)
#: Pieces of ASCII STL.
STL = (
    *("facet", "normal", "outer", "loop", "vertex", "endloop", "endfacet", "solid", "endsolid", "end solid", "\n", " "),
    *("1e400", "nan", "-", "1,5", "\x00", "\ufeff", "0", "1e-30", "1e30", "COLOR=", "vertex 0 0 0\n"),
)
_MOST = 400_000


def bit(source: random.Random, data: bytes) -> bytes:
    """With one bit flipped."""
    at = source.randrange(len(data))
    return data[:at] + bytes([data[at] ^ 1 << source.randrange(8)]) + data[at + 1 :]


def byte(source: random.Random, data: bytes) -> bytes:
    """With one byte replaced."""
    at = source.randrange(len(data))
    return data[:at] + bytes([source.choice((0, 1, 0x7F, 0x80, 0xFF, source.randrange(256)))]) + data[at + 1 :]


def number(source: random.Random, data: bytes) -> bytes:
    """With a binary number replaced by an extreme one."""
    kind = source.choice(["<B", "<H", ">H", "<I", ">I", "<Q", ">Q", "<d", ">d", "<f"])
    if kind[1] in "df":
        value = source.choice(_DOUBLES)
        packed = struct.pack(kind, value) if kind[1] == "d" or abs(value) < 1e38 or value != value else b"\0\0\x80\x7f"
    else:
        size = struct.calcsize(kind)
        packed = struct.pack(kind, source.choice(_NUMBERS) & (1 << 8 * size) - 1)
    at = source.randrange(len(data))
    return data[:at] + packed + data[at + len(packed) :]


def cut(source: random.Random, data: bytes) -> bytes:
    """Without its end."""
    return data[: source.randrange(len(data))]


def without(source: random.Random, data: bytes) -> bytes:
    """Without a span."""
    begin, end = _span(source, data)
    return data[:begin] + data[end:]


def zeroed(source: random.Random, data: bytes) -> bytes:
    """With a span of zeros."""
    begin, end = _span(source, data)
    return data[:begin] + bytes(end - begin) + data[end:]


def repeated(source: random.Random, data: bytes) -> bytes:
    """With a span twice or more."""
    begin, end = _span(source, data)
    return data[:begin] + data[begin:end] * source.choice((2, 2, 3, 30)) + data[end:]


def moved(source: random.Random, data: bytes) -> bytes:
    """With a span copied elsewhere."""
    (begin, end), at = _span(source, data), source.randrange(len(data))
    return data[:at] + data[begin:end] + data[at + end - begin :]


def _span(source: random.Random, data: bytes) -> tuple[int, int]:
    begin = source.randrange(len(data))
    return begin, min(len(data), begin + source.choice((1, 2, 4, 8, 16, 64, 512, 4096)))


BINARY: tuple[Mutation, ...] = (bit, bit, byte, number, number, cut, without, zeroed, repeated, moved)


def insert(source: random.Random, text: str, pieces: Sequence[str]) -> str:
    """With a piece of the language put in."""
    at = source.randrange(len(text) + 1)
    return text[:at] + source.choice(pieces) + text[at:]


def text_mutated(source: random.Random, data: bytes, pieces: Sequence[str]) -> bytes:
    """One mutation of a text."""
    put_in = partial(insert, pieces=pieces)
    do = source.choice(
        (delete, duplicate, swap, put_in, put_in, insert_unicode, change_number, change_number, flip_bit)
    )
    return do(source, data.decode("utf-8", "surrogateescape")).encode("utf-8", "surrogatepass")


def binary_mutated(source: random.Random, data: bytes) -> bytes:
    """One mutation of bytes."""
    return source.choice(BINARY)(source, data)


def mutated(source: random.Random, data: bytes, once: Mutation, most: int = 4) -> bytes:
    """The data after one to ``most`` mutations."""
    for _ in range(source.randint(1, most)):
        data = once(source, data)[:_MOST] if data else source.randbytes(8)
    return data
