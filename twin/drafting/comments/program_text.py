"""The text of a program as posts write it: comments, tool words and units, each with its line."""

from __future__ import annotations

import re
from bisect import bisect_right
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property
from typing import Literal, TypeAlias

from gcode.language.program import Program

Unit: TypeAlias = Literal["mm", "inch"]

#: A comment in parentheses, one that is not closed, or one after a semicolon.
_COMMENT = re.compile(r"\(([^()]*(?:\([^()]*\)[^()]*)*)\)|\((.*)$|;(.*)$")
_TOOL = re.compile(r"T\s*(?:(\d+)|(?=[#\[]))", re.IGNORECASE)
_MOTION = re.compile(r"(?:^|[^A-Z])[XYZ]\s*[-+.\d\[#]", re.IGNORECASE)
_UNITS = re.compile(r"G\s*0*(20|21|70|71)(?![\d.])", re.IGNORECASE)
_COMMENTED_CHANGE = re.compile(r"^M0?6\s*T(\d+)|^T(\d+)\s*M0?6\b", re.IGNORECASE)
_MACHINE = re.compile(r"G\s*0*53(?![\d.])", re.IGNORECASE)
_SET_OFFSET = re.compile(r"G\s*0*10(?![\d.]).*L\s*0*20?(?![\d.])", re.IGNORECASE)
_TAPE = re.compile(r"^\s*(?:%|[O:]\s*\d+\s*$)")


@dataclass(frozen=True, slots=True, kw_only=True)
class Comment:
    """A comment of a program.

    Attributes:
        line: its line, counted from 1.
        text: the text between its marks, without blanks at its ends.
    """

    line: int
    text: str


@dataclass(frozen=True, slots=True, kw_only=True)
class ToolWord:
    """A T word.

    Attributes:
        line: its line, counted from 1.
        number: the tool's number, None where an expression gives it.
    """

    line: int
    number: int | None


class ProgramText:
    """A program's comments and words, read without running it."""

    def __init__(self, program: Program) -> None:
        self.file = program.file
        comments, tools, motions, units = [], [], [], []
        self._machine = self._sets_offsets = False
        for line, text in enumerate(program, start=1):
            comments += [Comment(line=line, text=found) for found in _comments(text)]
            words = _COMMENT.sub(" ", text)
            tools += [ToolWord(line=line, number=int(n) if n else None) for n in _TOOL.findall(words)]
            units += [int(n) for n in _UNITS.findall(words)]
            self._machine = self._machine or bool(_MACHINE.search(words))
            self._sets_offsets = self._sets_offsets or bool(_SET_OFFSET.search(words))
            if _MOTION.search(words):
                motions.append(line)
        self.comments = tuple(comments)
        self.tool_words = tuple(tools)
        self._motions = tuple(motions)
        self._units = units

    @cached_property
    def unit(self) -> Unit:
        """Unit of the program's lengths: that of its first G20 or G21, mm without one."""
        return "inch" if self._units and self._units[0] in (20, 70) else "mm"

    @property
    def states_unit(self) -> bool:
        """Whether a G20 or G21 is in the program."""
        return bool(self._units)

    @property
    def moves_in_machine_coordinates(self) -> bool:
        """Whether a G53 is in the program."""
        return self._machine

    @property
    def sets_offsets(self) -> bool:
        """Whether the program sets work offsets itself (G10 L2, L20)."""
        return self._sets_offsets

    @property
    def commented_tool(self) -> int | None:
        """Tool of a tool change that a post wrote as a comment, for controls without a changer: ``( M6 T3 )``."""
        found = (_COMMENTED_CHANGE.search(comment.text) for comment in self.comments)
        return next((int(match[1] or match[2]) for match in found if match is not None), None)

    def tool_at(self, line: int) -> ToolWord | None:
        """The T word that a comment on a line belongs to.

        A comment on the line of a T word, or after one and before the first motion, belongs to it; others to the next
        T word, the last ones to the last.
        """
        before = [word for word in self.tool_words if word.line <= line]
        after = [word for word in self.tool_words if word.line > line]
        if before and (not after or before[-1].line == line or not self._moved(before[-1].line, line)):
            return before[-1]
        return after[0] if after else None

    def _moved(self, first: int, last: int) -> bool:
        after = bisect_right(self._motions, first)
        return after < len(self._motions) and self._motions[after] < last


def _comments(text: str) -> Iterator[str]:
    if "(" not in text and ";" not in text:
        return
    for closed, opened, after in _COMMENT.findall(text):
        found = (closed or opened or after).strip()
        if found and not _TAPE.match(found):
            yield found
