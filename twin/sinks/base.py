"""The interface of every sink: it takes records and computes nothing."""

from __future__ import annotations

from types import TracebackType
from typing import Protocol, Self

from twin.record import Record


class Sink(Protocol):
    """Takes the records of one run in order: `RunHeader` first, `RunSummary` last if the run ended in order.

    A sink is a context manager. `close` completes the output with what was written so far, whether or not the run came
    to its end, and may be called twice. Leaving the context by an exception closes as well.
    """

    def write(self, record: Record) -> None:
        """Take one record. Raises `twin.errors.ArchiveError` if it cannot be stored (disk full)."""

    def close(self) -> None:
        """Complete the output; it is valid up to the last record taken."""

    def __enter__(self) -> Self: ...

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None: ...
