"""A run kept in memory, for tests, notebooks and small jobs."""

from __future__ import annotations

from types import TracebackType
from typing import TYPE_CHECKING, Any, Self

import numpy as np

from twin.archive.force_table import force_arrays, force_table
from twin.record import Record, RunHeader, RunSummary, Step
from twin.settings.force_on import ForceOn

if TYPE_CHECKING:
    import pyarrow as pa


class MemorySink:
    """Keeps every record.

    Attributes:
        records: what was written, in order.
        closed: whether `close` was called.
    """

    def __init__(self) -> None:
        self.records: list[Record] = []
        self.closed = False

    def write(self, record: Record) -> None:
        """Take one record."""
        self.records.append(record)

    def close(self) -> None:
        """Nothing to finish; the records stay."""
        self.closed = True

    @property
    def header(self) -> RunHeader | None:
        """The run's header, when it has come."""
        return next((r for r in self.records if isinstance(r, RunHeader)), None)

    @property
    def summary(self) -> RunSummary | None:
        """The run's summary, when it has come."""
        return next((r for r in self.records if isinstance(r, RunSummary)), None)

    @property
    def steps(self) -> list[Step]:
        """The steps, in order."""
        return [r for r in self.records if isinstance(r, Step)]

    def forces(self, on: ForceOn = "tool") -> dict[str, np.ndarray[Any, Any]]:
        """All force samples.

        Args:
            on: the body that feels the force; on the workpiece it is opposite in sign.

        Returns:
            arrays of shape (n,): t_s, spindle_angle_rad, fx_n, fy_n, fz_n, torque_nm, power_w, nc_line, tool.
        """
        return force_arrays(self.steps, on)

    def force_table(self, on: ForceOn = "tool") -> pa.Table:
        """All force samples as an Arrow table with the columns of `forces`."""
        return force_table(self.steps, on)

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()
