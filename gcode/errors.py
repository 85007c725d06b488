"""The one error root of the package; place and text are fields, not just words in a message."""

from __future__ import annotations

from dataclasses import dataclass

from gcode.underline import harmless, underlined


@dataclass(frozen=True, slots=True, kw_only=True)
class Call:
    """One level of the call stack.

    Attributes:
        program: what was called, e.g. ``O1000`` or ``o<pocket>``.
        file: file of the calling block.
        line: line of the calling block.
    """

    program: str
    file: str
    line: int

    def __str__(self) -> str:
        return f"{self.program} called at {self.file}:{self.line}"


@dataclass(frozen=True, slots=True, kw_only=True)
class Place:
    """Where in an NC program something stands.

    Attributes:
        file: name of the program file, as the user gave it.
        line: line in the file, counted from 1.
        column: column in the line, counted from 1; 1 where a whole block is meant.
        text: the block as written, without its line end.
        calls: the calls that led here, the outermost first; empty in the main program.
    """

    file: str
    line: int
    column: int = 1
    text: str = ""
    calls: tuple[Call, ...] = ()

    def __str__(self) -> str:
        return f"{self.file}:{self.line}:{self.column}"


class GcodeError(Exception):
    """A refused NC program: what is wrong, where, and what was expected.

    Attributes:
        place: where the offending word stands.
        code: short stable name of the kind of mistake, e.g. ``missing-feed``.
        problem: what is wrong, naming the word and its value.
        expected: what would have been right.
    """

    def __init__(self, place: Place, code: str, problem: str, expected: str = "") -> None:
        self.place = place
        self.code = code
        self.problem = problem
        self.expected = expected
        super().__init__(str(self))

    def __str__(self) -> str:
        tail = f"; expected {self.expected}" if self.expected else ""
        return f"{self.place}: {self.problem}{tail} [{self.code}]"

    def underlined(self) -> str:
        """The message with the block below it, a caret under the word, and the calls that led there."""
        calls = "".join(f"\n    in {call}" for call in reversed(self.place.calls))
        return underlined(str(self), self.place.text, self.place.column) + harmless(calls)
