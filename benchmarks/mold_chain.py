"""The stages of the example's mold: computing times, and machining times next to those of the raster baseline.

python -m benchmarks.mold_chain --triangles 195000 460000
"""

from __future__ import annotations

import argparse
import tempfile
import tomllib
from pathlib import Path

from benchmarks.mold import write_mold
from benchmarks.report import report
from twin.moldmaking import STAGES, MoldPlan, mold_from_dict
from twin.moldmaking.figures import saved, times_table

_JOB = Path(__file__).parents[1] / "examples" / "mold" / "job.toml"


def chain(triangles: int) -> dict[str, object]:
    with tempfile.TemporaryDirectory() as folder:
        write_mold(Path(folder) / "mold.stl", triangles)
        made = MoldPlan(mold_from_dict(tomllib.loads(_JOB.read_text()), folder))
    lines = times_table(made)
    return {
        "triangles": len(made.part.triangles),
        "read_s": made.read_s,
        "computed_s": {stage: made.stage(stage).computed_s for stage in STAGES},
        "machining_min": {line.name: round(line.total_s / 60.0, 2) for line in lines},
        "semi_min": {line.name: round(line.semi_s / 60.0, 2) for line in lines},
        "saved": saved(lines),
    }


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--triangles", type=int, nargs="+", default=[195_000, 460_000])
    counts = parser.parse_args().triangles
    chain(5_000)  # compiles
    report("mold_chain", molds=[chain(n) for n in counts])


if __name__ == "__main__":
    main()
