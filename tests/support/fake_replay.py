"""A replay that cuts nothing: the records of `SlotRun`, with something done in their middle."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import replace

import numpy as np

from support.slot_run import SlotRun
from twin.job import Job
from twin.record import Record, RunSummary, Step
from twin.workpiece.to_mesh import SurfaceMesh

#: A tetrahedron, as the part.
PART = SurfaceMesh(
    np.array([[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]),
    np.array([[-1.0, -1.0, -1.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]])
    / np.sqrt([[3.0], [1.0], [1.0], [1.0]]),
    np.array([[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]]),
)


class FakeReplay:
    """Stands in for `twin.simulation.replay.Replay`.

    Args:
        at_step: called with the index of each step before it is given out.
        changes: fields of the run's summary.
    """

    def __init__(
        self, *, collision: bool = True, at_step: Callable[[int], None] = lambda _index: None, **changes: object
    ) -> None:
        self._slot = SlotRun(step_mm=2.0, per_turn=8, collision=collision)
        self._at_step = at_step
        self._changes: dict[str, object] = {"samples": 1000, "collisions": int(collision), **changes}
        self.job: Job | None = None
        self.closed = False

    def open(self, job: Job, threads: int | None = None, _report: object = None) -> FakeReplay:
        """What `twin.cli.commands.runs.replay_work.open_replay` does."""
        self.job = job
        return self

    def __iter__(self) -> Iterator[Record]:
        for record in self._slot.records():
            if isinstance(record, Step):
                self._at_step(record.index)
            yield self.summary(complete=True) if isinstance(record, RunSummary) else record

    def summary(self, *, complete: bool = False) -> RunSummary:
        changes = {"complete": complete, **self._changes}
        return replace(self._slot.summary(7.6, 38), **changes)  # type: ignore[arg-type]

    def mesh(self) -> SurfaceMesh:
        return PART

    def close(self) -> None:
        self.closed = True
