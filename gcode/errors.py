"""The root of the package's errors; position and text are fields, not only parts of the message."""

from __future__ import annotations

from dataclasses import dataclass

from gcode.underline import harmless, underlined


@dataclass(frozen=True, slots=True, kw_only=True)
class Call:
    """One level of the call stack.

    Attributes:
        program: the program that was called, e.g. ``O1000`` or ``o<pocket>``.
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
    """A position in the text of an NC program or of another file.

    Attributes:
        file: name of the file, as the user gave it.
        line: line in the file, counted from 1; 0 for the file as a whole.
        column: column in the line, counted from 1; 1 for a whole block.
        text: the block as written, without its line end.
        calls: the calls that led here, the outermost first; empty in the main program.
    """

    file: str
    line: int
    column: int = 1
    text: str = ""
    calls: tuple[Call, ...] = ()

    def __str__(self) -> str:
        return f"{self.file}:{self.line}:{self.column}" if self.line else self.file


class GcodeError(Exception):
    """An NC program, or another file, that is refused: the position, the problem, and what was expected.

    Attributes:
        place: position of the offending word.
        code: short stable name of the kind of error, e.g. ``missing-feed``.
        problem: the problem, naming the word and its value.
        expected: a correct alternative; empty where there is none.
    """

    def __init__(self, place: Place, code: str, problem: str, expected: str = "") -> None:
        self.place = place
        self.code = code
        self.problem = problem
        self.expected = expected
        self.hint = ""
        super().__init__(str(self))

    def __str__(self) -> str:
        tail = f"; expected {self.expected}" if self.expected else ""
        return f"{self.place}: {self.problem}{tail} [{self.code}]"

    def underlined(self) -> str:
        """The message with the block below it, a caret under the word, and the calls that led there."""
        calls = "".join(f"\n    in {call}" for call in reversed(self.place.calls))
        hint = f"\n{harmless(self.hint)}" if self.hint else ""
        return underlined(str(self), self.place.text, self.place.column) + harmless(calls) + hint
