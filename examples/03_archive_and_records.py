"""Archives a run, opens it again, and goes through its records: the NC lines with the highest force."""

from __future__ import annotations

import tempfile
from pathlib import Path

import numpy as np

import twin

JOB = Path(__file__).parent / "casting" / "job.toml"


def peak_by_line(run: twin.Run) -> dict[int, float]:
    """Highest resultant force of each NC line, N; needs little memory however long the program."""
    peaks: dict[int, float] = {}
    for record in run.records():
        if isinstance(record, twin.Step) and len(record.samples.t_s):
            highest = float(np.linalg.norm(record.samples.force_n, axis=1).max())
            peaks[record.nc_line] = max(highest, peaks.get(record.nc_line, 0.0))
    return peaks


def main() -> None:
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "bracket.mcap"
        twin.replay(JOB, mcap=path)
        run = twin.open_run(path)
        print(run)
        text = {e.nc_line: e.text for e in run.events if isinstance(e, twin.NcEvent) and e.kind == "block"}
        for line, force in sorted(peak_by_line(run).items(), key=lambda item: -item[1])[:5]:
            print(f"  line {line:3d} {text[line]:30s} {force:7.1f} N")


if __name__ == "__main__":
    main()
