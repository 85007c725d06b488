"""The complete workflow with SYNTHETIC logs: test cuts, coefficients, a replay with them, its comparison with a log.

python examples/test_cuts/run.py        results go to examples/test_cuts/results
"""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path

HERE = Path(__file__).parent
RESULTS = HERE / "results"


def twin(*arguments: object) -> str:
    """Show a command of twin and run it."""
    words = [str(a) for a in arguments]
    print("\n$ twin " + " ".join(words), flush=True)
    command = [sys.executable, "-m", "twin", *words]
    return subprocess.run(command, check=True, text=True, stdout=subprocess.PIPE).stdout


def write_job() -> Path:
    """The validation job with the identified coefficients and runout."""
    found = json.loads((RESULTS / "identified.json").read_text())["runout"]
    runout = f"runout_mm = {found['runout_mm']:.6f}\nrunout_angle_deg = {found['runout_angle_deg']:.2f}\n"
    head, output = (HERE / "validation.toml").read_text().split("[output]")
    cutting = (RESULTS / "coefficients.toml").read_text()
    job = RESULTS / "job.toml"
    job.write_text(f"{head.rstrip()}\n{runout}\n[output]{output}\n{cutting}")
    return job


def main() -> None:
    subprocess.run([sys.executable, str(HERE / "make_logs.py")], check=True)
    RESULTS.mkdir(exist_ok=True)
    coefficients = RESULTS / "coefficients.toml"
    found = twin("identify", HERE / "cuts.toml", "-o", coefficients, "--force", "--json")
    (RESULTS / "identified.json").write_text(found)
    print(coefficients.read_text())
    print(twin("replay", write_job(), "--force", "--quiet"), end="")
    windows = ["--window", "4.00:4.02", "--window", "8.00:8.02"]
    axes = ["--map", "x=-Fy,y=Fx,z=Fz", "--force-on", "workpiece"]
    corrections = ["--offset", "air", "--drift", "--phase"]
    log = HERE / "logs" / "synthetic_validation.csv"
    report = ["--report", RESULTS / "report"]
    print(twin("compare", RESULTS / "validation.mcap", log, *windows, *axes, *corrections, *report))


if __name__ == "__main__":
    main()
