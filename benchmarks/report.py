"""Facts that every benchmark prints next to its own figures: machine, memory, and the measured commit."""

from __future__ import annotations

import json
import os
import platform
import resource
import subprocess
from pathlib import Path


def commit() -> str:
    """Short name of the commit, with a + where files differ from it; unknown outside a repository."""
    here = Path(__file__).parent
    answers = [
        subprocess.run(["git", *words], cwd=here, capture_output=True, text=True, check=False).stdout.strip()
        for words in (("rev-parse", "--short", "HEAD"), ("status", "--porcelain", "--untracked-files=no"))
    ]
    return (answers[0] or "unknown") + ("+" if answers[1] else "")


def report(benchmark: str, **figures: object) -> None:
    """Print one JSON object. Peak memory is that of the whole process up to here."""
    facts = {
        "peak_memory_mib": round(resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024),
        "machine": f"{platform.machine()} {platform.system()}, {os.cpu_count()} cores, "
        f"Python {platform.python_version()}",
        "commit": commit(),
    }
    print(json.dumps({"benchmark": benchmark} | figures | facts, indent=1))
