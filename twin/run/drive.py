"""One replay from its first record to its last: into outputs, strict or not, until its end or a stop."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Protocol

from twin.record import Collision, Record, RunSummary


class Replaying(Protocol):
    """The interface of `twin.simulation.replay.Replay` that is used here."""

    def __iter__(self) -> Iterator[Record]: ...

    def summary(self, *, complete: bool = False) -> RunSummary:
        """Sums so far."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Ending:
    """How a replay ended.

    Attributes:
        summary: of what was replayed.
        refused: the collision that ended a strict replay.
    """

    summary: RunSummary
    refused: Collision | None


def drive(
    replay: Replaying,
    write: Callable[[Record], None],
    *,
    strict: bool = False,
    stopped: Callable[[], bool] = lambda: False,
) -> Ending:
    """Write the records of a replay until its end, a stop, or a collision when strict.

    However it ends, the last record written is a `RunSummary`.

    Args:
        replay: the replay.
        write: takes every record.
        strict: end at the first collision, which is still written.
        stopped: whether to end after the current record.

    Raises:
        TwinError, GcodeError: the program cannot be replayed, or an output cannot be written.
    """
    refused: Collision | None = None
    for record in replay:
        write(record)
        if isinstance(record, RunSummary):
            return Ending(summary=record, refused=None)
        if strict and isinstance(record, Collision):
            refused = record
        if refused is not None or stopped():
            break
    summary = replay.summary(complete=False)
    write(summary)
    return Ending(summary=summary, refused=refused)
