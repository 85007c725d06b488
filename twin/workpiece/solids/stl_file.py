"""STL files: the corners of their triangles, from binary and from text files.

Text files are read by their keywords, whatever the case, the line ends and the spaces between them; a mark of the
encoding at the start, comments and padding at the end are skipped, and normals, which are not used, may be missing or
incomplete. Whatever else is in a file is refused with its line.
"""

from __future__ import annotations

import codecs
import re

import numpy as np

from twin.arrays import FloatArray
from twin.errors import MeshError

_HEADER = 84
_TRIANGLE = 50
_RECORD = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("attribute", "<u2")])

_CORNER = r"vertex\s+(\S++)\s+(\S++)\s+(\S++)\s+"
_FACET = re.compile(
    rf"facet(?:\s+normal(?:\s+(?!outer\b)\S++){{0,3}}+)?\s+outer\s*loop\s+{3 * _CORNER}end\s*loop\s+end\s*facet\b",
    re.IGNORECASE,
)
#: Comments, which the format does not have: a line, or the rest of one after a blank.
_COMMENT = re.compile(r"(?:^|(?<=[ \t]))(?:#|;|//).*$", re.MULTILINE)
_BEGIN = re.compile(r"\s*(?:(?:#|;|//)[^\r\n]*\s+)*+(?:solid|facet)\b", re.IGNORECASE)
#: Lines between facets: the names of solids, and colours, which some CAD systems write.
_BETWEEN = re.compile(r"(?:(?:solid|end[ \t]*solid|color)\b.*)?", re.IGNORECASE)
_FACET_BEGINS = re.compile(r"\bfacet\s+(?:normal|outer)\b", re.IGNORECASE)
#: A facet that has begun and does not end.
_CUT_OFF = re.compile(r"^\s*(facet)\b(?!.*\bend\s*facet)", re.IGNORECASE | re.MULTILINE | re.DOTALL)
#: Marks of the encoding that a text file may begin with.
_MARKS = ((codecs.BOM_UTF8, "utf-8"), (codecs.BOM_UTF16_LE, "utf-16-le"), (codecs.BOM_UTF16_BE, "utf-16-be"))
#: A text file's first keyword lies within this many bytes.
_OPENING = 4096
#: Padding after a file's text: NUL, the end-of-file mark of DOS, and blanks.
_PADDING = "\0\x1a \t\r\n\f\v"


def stl_corners(name: str, data: bytes) -> FloatArray:
    """The corners of an STL file's triangles, shape (m, 3, 3), in the file's unit.

    A file whose length fits the number of triangles in its header is binary, even if the header begins with "solid".

    Args:
        name: of the file, for messages.
        data: its content.

    Raises:
        MeshError: empty, cut off, or not an STL file; the line is named where it is text.
    """
    if not data:
        raise MeshError(f"{name}: is empty; expected an STL file")
    text = None if _binary_length(data) == len(data) else _text(data)
    corners = _binary_corners(name, data) if text is None else _text_corners(name, text)
    if len(corners) == 0:
        raise MeshError(f"{name}: holds no triangles; expected binary or ASCII STL with a closed surface")
    return corners


def _binary_length(data: bytes) -> int:
    """Length of a binary file with the number of triangles that the header states; -1 for a file without a header."""
    if len(data) < _HEADER:
        return -1
    return _HEADER + _TRIANGLE * int.from_bytes(data[_HEADER - 4 : _HEADER], "little")


def _binary_corners(name: str, data: bytes) -> FloatArray:
    """The corners of a binary file; padding with NUL at its end is skipped."""
    wanted = _binary_length(data)
    if wanted < 0:
        raise MeshError(f"{name}: is not an STL file: {len(data)} bytes; expected at least {_HEADER}")
    if len(data) < wanted or data[wanted:].strip(b"\0"):
        count = (wanted - _HEADER) // _TRIANGLE
        raise MeshError(
            f"{name}: is not an STL file: {len(data)} bytes; "
            f"expected {wanted} for {count} triangles, as its header states"
        )
    records = np.frombuffer(data[:wanted], dtype=_RECORD, offset=_HEADER)
    with np.errstate(invalid="ignore"):  # a signalling NaN; it is refused as not finite
        return records["corners"].astype(np.float64)


def _text(data: bytes) -> str | None:
    """The text of a file that begins like an ASCII STL file, line ends as LF; None for other files."""
    encoding = "latin-1"  # names may hold any byte
    for mark, known in _MARKS:
        if data.startswith(mark):
            data, encoding = data[len(mark) :], known
            break
    if encoding == "latin-1" and not _BEGIN.match(data[:_OPENING].decode(encoding)):
        return None
    text = data.decode(encoding, errors="replace").rstrip(_PADDING)
    if not _BEGIN.match(text):
        return None
    if "\0" in text and not _FACET_BEGINS.search(text):
        return None  # a binary file that was cut off
    text = text.replace("\0", " ").replace("\r\n", "\n").replace("\r", "\n")
    return _COMMENT.sub("", text) if any(mark in text for mark in ("#", ";", "//")) else text


def _text_corners(name: str, text: str) -> FloatArray:
    """The corners of a text file."""
    numbers: list[str] = []
    at = 0
    for facet in _FACET.finditer(text):
        _check_between(name, text, at, facet.start())
        numbers += facet.groups()
        at = facet.end()
    rest = _CUT_OFF.search(text, at)
    if rest is not None and numbers:
        raise MeshError(
            f"{name}: is not a complete STL file: {len(numbers) // 9} facets can be read, "
            f"the one in line {_line(text, rest.start(1))} is cut off"
        )
    _check_between(name, text, at, len(text))
    return _values(name, text, numbers)


def _check_between(name: str, text: str, start: int, end: int) -> None:
    """Refuse what lies between two facets and is neither the name of a solid nor a colour."""
    gap = text[start:end]
    if not gap.strip():
        return
    offset = start
    for line in gap.split("\n"):
        if not _BETWEEN.fullmatch(line.strip()):
            raise MeshError(
                f'{name}: line {_line(text, offset)}: "{line.strip()[:60]}"; expected a facet of three vertices: '
                "facet normal, outer loop, vertex X Y Z three times, endloop, endfacet"
            )
        offset += len(line) + 1


def _values(name: str, text: str, numbers: list[str]) -> FloatArray:
    """Numbers of vertices, shape (m, 3, 3); decimal commas and Fortran's exponents are read as well."""
    try:
        values = np.fromiter(map(float, numbers), dtype=np.float64, count=len(numbers))
    except ValueError:
        values = np.array([_number(name, text, k, word) for k, word in enumerate(numbers)])
    return values.reshape(-1, 3, 3)


def _number(name: str, text: str, index: int, word: str) -> float:
    """One number, which may end with a comma, have a decimal comma, or D as the letter of its exponent."""
    plain = word.rstrip(",;")
    if plain.count(",") == 1 and "." not in plain:
        plain = plain.replace(",", ".")
    try:
        return float(re.sub("[dD]", "e", plain))
    except ValueError:
        facet = next(f for k, f in enumerate(_FACET.finditer(text)) if k == index // 9)
        line = _line(text, facet.start(index % 9 + 1))
        raise MeshError(f'{name}: line {line}: "{word[:40]}" is not a number; expected a coordinate') from None


def _line(text: str, offset: int) -> int:
    """Number of the line at an offset, from 1."""
    return text.count("\n", 0, offset) + 1
