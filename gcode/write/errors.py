"""The error of the writer: which event of the stream cannot be said, and why."""

from __future__ import annotations

from gcode.errors import GcodeError, Place


class WriteError(GcodeError):
    """A stream of events that is refused.

    Attributes:
        index: number of the event in the stream, counted from 0; None where no event is at fault, but the file.
    """

    def __init__(self, index: int | None, place: Place, code: str, problem: str, expected: str = "") -> None:
        self.index = index
        super().__init__(place, code, problem, expected)

    def __str__(self) -> str:
        return super().__str__() if self.index is None else f"event {self.index}, from {super().__str__()}"
