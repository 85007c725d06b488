"""Archives a run and feeds a sink of one's own at the same time: the highest force of each NC line."""

from __future__ import annotations

import tempfile
from pathlib import Path
from types import TracebackType
from typing import Self

import numpy as np

from twin.archive import read_forces, run_info
from twin.job import load_job
from twin.record import NcEvent, Record, Step
from twin.simulation.replay import Replay
from twin.sinks.mcap_sink import McapSink

JOB = Path(__file__).parent / "casting" / "job.toml"


class PeakOfEachLine:
    """A sink is anything with `write` and `close` that is a context manager."""

    def __init__(self) -> None:
        self.text: dict[int, str] = {}
        self.peak_n: dict[int, float] = {}

    def write(self, record: Record) -> None:
        """Take one record."""
        if isinstance(record, NcEvent) and record.kind == "block":
            self.text[record.nc_line] = record.text
        elif isinstance(record, Step) and len(record.samples.t_s):
            highest = float(np.linalg.norm(record.samples.force_n, axis=1).max())
            self.peak_n[record.nc_line] = max(highest, self.peak_n.get(record.nc_line, 0.0))

    def close(self) -> None:
        """Nothing to finish."""

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()


def main() -> None:
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "bracket.mcap"
        with McapSink(path) as archive, PeakOfEachLine() as peaks, Replay(load_job(JOB)) as run:
            for record in run:
                archive.write(record)
                peaks.write(record)
        table = read_forces(path)
        print(f"{path.name}: {table.num_rows} samples, complete: {run_info(path).complete}")
    for line, force in sorted(peaks.peak_n.items(), key=lambda item: -item[1])[:5]:
        print(f"  line {line:3d} {peaks.text[line]:30s} {force:7.1f} N")


if __name__ == "__main__":
    main()
