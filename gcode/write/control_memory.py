"""The modal memory of the control that will read the program: it determines which words must be written."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field

from gcode.events import Event, MotionState, Point
from gcode.write.errors import WriteError
from gcode.write.numbers import Counts, Grid
from gcode.write.options import WriteOptions


@dataclass(frozen=True, slots=True)
class LengthOffset:
    """An active tool length offset: number (None where it has none), length, offsets in x and y, mm."""

    number: int | None = None
    length_mm: float = 0.0
    xy_mm: tuple[float, float] = (0.0, 0.0)

    @property
    def vector_mm(self) -> Point:
        """The gauge point less the controlled point."""
        return (*self.xy_mm, self.length_mm)


@dataclass(slots=True)
class ControlMemory:
    """The state that the words written so far have set.

    Attributes:
        options: how the program is written.
        grid: the points that it can name.
        index: number of the event that is being written.
        words: last word of each modal group and of F and S.
        at: where the controlled point is, None before the first motion.
        at_mm: the same as the events give it, machine coordinates.
        tool: tool in the spindle.
        direction: how the spindle turns, as in `MotionState`.
        mist: coolant.
        flood: coolant.
        length: length offset.
        state: the last motion's, where all of it is written; None after an event that changes it.
        unsure: True where the machine may be elsewhere, so that the next motion names all axes in G90.
        ended: the program's end has been written.
    """

    options: WriteOptions
    grid: Grid
    tool: int
    index: int | None = None
    words: dict[str, str] = field(default_factory=dict)
    at: Counts | None = None
    at_mm: Point | None = None
    direction: int = 0
    mist: bool = False
    flood: bool = False
    length: LengthOffset = LengthOffset()
    state: MotionState | None = None
    unsure: bool = True
    ended: bool = False
    _number: int = 0

    def modal(self, group: str, word: str) -> list[str]:
        """A modal word, where the control does not hold it already or every word is to be written."""
        if self.options.modal and self.words.get(group) == word:
            return []
        self.words[group] = word
        return [word]

    def line(self, *words: str) -> str:
        """A block of words, with the next block number."""
        step, most = self.options.number_step, self.options.rules.most_block_number
        if step is None:
            return " ".join(words)
        self._number = self._number + step if self._number + step <= most else step
        return " ".join((f"N{self._number}", *words))

    def error(self, event: Event, code: str, problem: str, expected: str) -> WriteError:
        """The refusal of an event."""
        return WriteError(self.index, event.place, code, problem, expected)


@dataclass(slots=True)
class EventStream:
    """Events with their numbers, the next of which can be looked at.

    Args:
        events: numbered events.
    """

    events: Iterator[tuple[int, Event]]
    _ahead: list[tuple[int, Event]] = field(default_factory=list)

    def take(self) -> tuple[int, Event] | None:
        """The next event, None after the last."""
        return self._ahead.pop() if self._ahead else next(self.events, None)

    def put_back(self, *events: tuple[int, Event]) -> None:
        """Events to take again, in their order."""
        self._ahead.extend(reversed(events))
