"""The error of the writer: the event that cannot be written, and the reason."""

from __future__ import annotations

from gcode.errors import GcodeError, Place


class WriteError(GcodeError):
    """An event that the program cannot express.

    Attributes:
        index: number of the event in the stream, counted from 0; None for an error of the file.
    """

    def __init__(self, index: int | None, place: Place, code: str, problem: str, expected: str = "") -> None:
        self.index = index
        super().__init__(place, code, problem, expected)

    def __str__(self) -> str:
        return super().__str__() if self.index is None else f"{super().__str__()} (event {self.index})"
