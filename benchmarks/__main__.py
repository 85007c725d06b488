"""Run every benchmark with its defaults, one after the other, each in a process of its own.

python -m benchmarks
"""

import subprocess
import sys

STAGES = (
    "real",
    "speed",
    "surface",
    "replay",
    "removal",
    "retraced",
    "archive",
    "gcode",
    "gcode_commands",
    "offset",
    "paths",
    "drop_cutter",
    "dexel",
    "tour",
    "mold_chain",
)

if __name__ == "__main__":
    for stage in STAGES:
        subprocess.run([sys.executable, "-m", f"benchmarks.{stage}"], check=True)
