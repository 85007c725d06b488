"""The text of a program file with random access: lines, programs in it (O words), labels (N words), O-word lines.

The text is kept as bytes and lines are decoded as they are executed; labels and subprograms are found by regular
expressions when they are first used.
"""

from __future__ import annotations

import errno
import os
import re
from bisect import bisect_left, bisect_right
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import NamedTuple

from gcode.errors import GcodeError, Place
from gcode.language.block_parser import MAX_LINE

#: Largest file that is read; no control takes a tenth of it.
MAX_BYTES = 1 << 30
#: Length of the part that the kind of control is recognised from.
HEAD_BYTES = 1 << 15

_LABEL = re.compile(rb"^[ \t]*(?:/\d?[ \t]*)?N[ \t]*(\d{1,40}+)(?![\d.])", re.IGNORECASE | re.MULTILINE)
_NUMBERED = re.compile(
    rb"^[ \t]*(?:/\d?[ \t]*)?[O:][ \t]*(\d{1,40}+)[ \t]*(?=[\r\n;(%/]|\Z|[A-NP-Za-np-z])", re.IGNORECASE | re.MULTILINE
)
_O_LINE = re.compile(
    rb"^[ \t]*(?:/\d?[ \t]*)?(?:N[ \t]*\d+[ \t]*)?O[ \t]*(<[^>\r\n]{0,4096}>|\d{1,4096}+)[ \t]*"
    rb"(endsub|endif|endwhile|endrepeat|elseif|else|sub|call|return|if|while|do|break|continue|repeat)(?![A-Za-z])",
    re.IGNORECASE | re.MULTILINE,
)
_LOOP = re.compile(
    rb"^[ \t]*(?:/\d?[ \t]*)?(?:N[ \t]*\d+[ \t]*)?(?:WH(?:ILE|IL|I)?[ \t]*\[.*\][ \t]*)?(DO|END?)[ \t]*(\d)",
    re.IGNORECASE | re.MULTILINE,
)
_PERCENT = re.compile(rb"^[ \t]*%", re.MULTILINE)


#: Characters of a serial line that frame a program or fill pauses: NUL, DC1 to DC4 (which also stop and start the
#: line), DEL; at the beginning also STX, at the end ETX, EOT and SUB.
_FILLERS = b"\x00\x11\x12\x13\x14\x7f"
_FRAMING = re.compile(
    rb"\A[\x00\x02\x11-\x14\x7f\s]+|[\x00\x03\x04\x11-\x14\x1a\x7f\s]+\Z"
    rb"|(?<=%)[\x00\x11-\x14\x7f]+(?=\s)|(?<=\n)[\x00\x11-\x14\x7f]+"
)
#: FANUC punches the end of a block as LF CR CR.
_PUNCHED_ENDS = re.compile(rb"\n\r+(?![\r\n])")


class Spot(NamedTuple):
    """A line in a text: its byte offset, and its number counted from 1."""

    offset: int
    line: int


#: The first line.
BEGINNING = Spot(0, 1)


@dataclass(frozen=True, slots=True)
class OLine:
    """A line with an O-word: its position, label and keyword."""

    spot: Spot
    label: str
    keyword: str


class Program:
    """The text of a program file, with access by line, label and subprogram.

    Attributes:
        file: its name, for places.
        text: its bytes.
        folder: its folder, None for a text that is not a file.
    """

    def __init__(self, text: bytes, file: str, folder: Path | None = None) -> None:
        self.text = _without_transmission(text.removeprefix(b"\xef\xbb\xbf"))
        self.file = file
        self.folder = folder

    def line_at(self, offset: int) -> tuple[str, int]:
        """The line that begins at `offset`, without its end, and where the next one begins.

        A line longer than a block can be is cut just beyond `MAX_LINE`, so that the parser refuses it.
        """
        end = self.text.find(b"\n", offset)
        stop = len(self.text) if end < 0 else end
        line = self.text[offset : min(stop, offset + 4 * MAX_LINE + 8)]
        return _decoded(line), len(self.text) if end < 0 else end + 1

    def __iter__(self) -> Iterator[str]:
        """The lines, without their ends."""
        offset = 0
        while offset < self.size:
            line, offset = self.line_at(offset)
            yield line

    @property
    def head(self) -> str:
        """The first part of the text, from which the kind of control is recognised."""
        return _decoded(self.text[:HEAD_BYTES])

    @property
    def size(self) -> int:
        """Length in bytes."""
        return len(self.text)

    def spot_of(self, offset: int, known: Spot = BEGINNING) -> Spot:
        """The spot at an offset, counted from an earlier `known` one."""
        if offset < known.offset:
            known = BEGINNING
        return Spot(offset, known.line + self.text.count(b"\n", known.offset, offset))

    @cached_property
    def programs(self) -> dict[int, Spot]:
        """First spot of every numbered program, the line of its O word, by number."""
        found: dict[int, Spot] = {}
        spot = BEGINNING
        for match in _NUMBERED.finditer(self.text):
            spot = self.spot_of(self._line_start(match.start()), spot)
            found.setdefault(int(match[1]), spot)
        return found

    @cached_property
    def _starts(self) -> list[int]:
        """Offsets where numbered programs and what follows a percent sign begin, in order."""
        starts = {spot.offset for spot in self.programs.values()}
        starts.update(self._line_start(match.start()) for match in _PERCENT.finditer(self.text))
        return sorted(starts)

    def section(self, offset: int) -> tuple[int, int]:
        """First and last-but-one offset of the program that holds `offset`."""
        index = bisect_right(self._starts, offset)
        begin = self._starts[index - 1] if index else 0
        end = self._starts[index] if index < len(self._starts) else self.size
        return begin, end

    @cached_property
    def _labels(self) -> dict[int, list[Spot]]:
        found: dict[int, list[Spot]] = {}
        spot = BEGINNING
        for match in _LABEL.finditer(self.text):
            spot = self.spot_of(self._line_start(match.start()), spot)
            found.setdefault(int(match[1]), []).append(spot)
        return found

    def label(self, number: int, offset: int) -> Spot | None:
        """The block N`number` that a jump from `offset` finds: the next one in the same program, else the first."""
        begin, end = self.section(offset)
        spots = [spot for spot in self._labels.get(number, []) if begin <= spot.offset < end]
        return next((spot for spot in spots if spot.offset > offset), spots[0] if spots else None)

    @cached_property
    def _loop_words(self) -> list[tuple[Spot, str, int]]:
        found = []
        spot = BEGINNING
        for match in _LOOP.finditer(self.text):
            spot = self.spot_of(self._line_start(match.start()), spot)
            found.append((spot, match[1].decode().upper(), int(match[2])))
        return found

    @cached_property
    def loops(self) -> dict[int, Spot]:
        """The END of each DO, by the offset of the DO's line; a DO without one is missing."""
        pairs: dict[int, Spot] = {}
        waiting: dict[tuple[int, int], list[int]] = {}
        for spot, word, label in self._loop_words:
            open_loops = waiting.setdefault((self.section(spot.offset)[0], label), [])
            if word == "DO":
                open_loops.append(spot.offset)
            elif open_loops:
                pairs[open_loops.pop()] = spot
        return pairs

    @cached_property
    def o_lines(self) -> list[OLine]:
        """All lines with O-words, in order."""
        found = []
        spot = BEGINNING
        for match in _O_LINE.finditer(self.text):
            spot = self.spot_of(self._line_start(match.start()), spot)
            found.append(OLine(spot, canonical_label(_decoded(match[1])), match[2].decode().lower()))
        return found

    @cached_property
    def _o_offsets(self) -> list[int]:
        return [line.spot.offset for line in self.o_lines]

    def o_lines_after(self, offset: int) -> Iterable[OLine]:
        """The lines with O-words after the one at `offset`, in order."""
        return self.o_lines[bisect_right(self._o_offsets, offset) :]

    def o_lines_before(self, offset: int) -> Iterable[OLine]:
        """The lines with O-words before the one at `offset`, the nearest first."""
        return reversed(self.o_lines[: bisect_left(self._o_offsets, offset)])

    @cached_property
    def subroutines(self) -> dict[str, Spot]:
        """The ``sub`` line of every subroutine by label."""
        found: dict[str, Spot] = {}
        for line in self.o_lines:
            if line.keyword == "sub":
                found.setdefault(line.label, line.spot)
        return found

    def _line_start(self, offset: int) -> int:
        return self.text.rfind(b"\n", 0, offset) + 1


def canonical_label(text: str) -> str:
    """Label of an O-word as it is compared: a name in lower case without blanks, or a number."""
    name = text.strip().removeprefix("<").removesuffix(">")
    name = "".join(name.split()).lower()
    return name.lstrip("0") or "0" if name.isascii() and name.isdigit() else name


def _decoded(line: bytes) -> str:
    try:
        text = line.decode("utf-8")
    except UnicodeDecodeError:
        text = line.decode("latin-1")
    return text.rstrip("\r")


def _without_transmission(text: bytes) -> bytes:
    """The text without the characters of a serial line around it and after its line ends."""
    if b"\n\r" in text:
        text = _PUNCHED_ENDS.sub(b"\n", text)
    removed = _FILLERS + b"\x02\x03\x04\x1a"
    if not any(character in text for character in removed):
        return text
    bare = _FRAMING.sub(lambda match: match[0].translate(None, removed), text)
    return bare if bare.strip() else text


def program_of(source: str | bytes | Iterable[str], file: str) -> Program:
    """A program from its text, or from its lines."""
    if isinstance(source, bytes):
        return Program(source, file)
    if isinstance(source, str):
        return Program(source.encode("utf-8", "surrogatepass"), file)
    lines = (line.removesuffix("\n") for line in source)
    return Program("\n".join(lines).encode("utf-8", "surrogatepass"), file)


def read_program(path: Path | str) -> Program:
    """Reads a program file.

    Raises:
        GcodeError: where the file cannot be read, is not a regular file, or is larger than `MAX_BYTES`.
    """
    path = Path(path)
    try:
        if not path.is_file():
            raise _unreadable(path, _why_no_file(path))
        if path.stat().st_size > MAX_BYTES:
            raise _unreadable(path, f"larger than {MAX_BYTES // 2**20} MiB")
        return Program(path.read_bytes(), str(path), path.parent)
    except OSError as error:
        raise _unreadable(path, (error.strerror or str(error)).lower()) from None


def _why_no_file(path: Path) -> str:
    if not path.exists():
        return os.strerror(errno.ENOENT).lower()
    return os.strerror(errno.EISDIR).lower() if path.is_dir() else "not a regular file"


def _unreadable(path: Path, reason: str) -> GcodeError:
    place = Place(file=str(path), line=0)
    return GcodeError(place, "unreadable-file", f"cannot be read: {reason}", "an NC program")
