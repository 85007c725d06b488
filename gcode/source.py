"""Where blocks come from: a file or a text as numbered lines, read one at a time."""

from __future__ import annotations

import io
from collections.abc import Iterable, Iterator
from itertools import chain, islice
from pathlib import Path
from typing import BinaryIO

from gcode.dialects import Dialect
from gcode.errors import GcodeError, Place
from gcode.parse import MAX_LINE, parse_line

#: A percent sign that ends a leader is looked for in so many lines.
LEADER_LINES = 200


def read_program(path: Path | str) -> Iterator[str]:
    """Yields the lines of a program file without their line ends; memory stays flat whatever the file.

    Text is UTF-8, and a line that is not is read byte by byte as Latin-1, which comments may hold. A line longer than
    a block can be is cut just beyond `MAX_LINE`, so that the parser refuses it.

    Raises:
        GcodeError: where the file cannot be read.
    """
    try:
        with Path(path).open("rb") as handle:
            first = True
            while line := _read_line(handle):
                yield _decode(line.removeprefix(b"\xef\xbb\xbf") if first else line)
                first = False
    except OSError as error:
        problem = f"cannot read the program: {error.strerror or error}"
        raise GcodeError(Place(file=str(path), line=1), "unreadable-file", problem, "a readable text file") from None


def _read_line(handle: BinaryIO) -> bytes:
    """One line, cut beyond what a block may hold; the rest of a longer one is passed over."""
    limit = 4 * MAX_LINE + 8
    line = rest = handle.readline(limit)
    while len(rest) == limit and not rest.endswith(b"\n"):
        rest = handle.readline(limit)
    return line


def _decode(line: bytes) -> str:
    try:
        text = line.decode("utf-8")
    except UnicodeDecodeError:
        text = line.decode("latin-1")
    return text.rstrip("\r\n")


def numbered(source: str | Iterable[str], file: str) -> Iterator[Place]:
    """The lines of a program with their places; line ends are taken off."""
    lines = io.StringIO(source, newline="\n") if isinstance(source, str) else source
    for number, text in enumerate(lines, start=1):
        yield Place(file=file, line=number, text=text.rstrip("\r\n"))


def after_leader(places: Iterator[Place], dialect: Dialect) -> tuple[Place | None, Iterator[Place]]:
    """Passes over a leader: text before the first percent sign that is no program.

    A percent sign ends a leader where more text follows it and none of the lines before it, read as a block, holds a
    word; otherwise it is the end of the program and left in place.

    Returns:
        The last line of the leader (None without one), and the places of the program.
    """
    if not dialect.leader:
        return None, places
    head = list(islice(places, LEADER_LINES))
    index = next((i for i, place in enumerate(head) if place.text.lstrip().startswith("%")), 0)
    before, after = head[:index], head[index + 1 :]
    if not any(p.text.strip() for p in before) or not any(p.text.strip() for p in after) or _is_program(before):
        return None, chain(head, places)
    return before[-1], chain(head[index:], places)


def _is_program(places: list[Place]) -> bool:
    """True where one of the lines reads as a block with words, or holds nothing but a comment throughout."""
    empty = True
    for place in places:
        try:
            if parse_line(place).words:
                return True
        except GcodeError:
            empty = False
    return empty
