"""The door every sink has: records in, nothing computed."""

from __future__ import annotations

from types import TracebackType
from typing import Protocol, Self

from twin.record import Record


class Sink(Protocol):
    """Receives the records of one run in order: `RunHeader` first, `RunSummary` last when the run ended.

    A sink is a context manager. `close` finishes what was written so far into something valid, whether or not the run
    came to its end, and may be called twice. Leaving the context by an exception closes as well.
    """

    def write(self, record: Record) -> None:
        """Take one record. Raises `twin.errors.ArchiveError` when it cannot be kept (disk full)."""

    def close(self) -> None:
        """Finish; valid up to the last record taken."""

    def __enter__(self) -> Self: ...

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None: ...
