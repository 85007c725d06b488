"""Put the figures of the benchmarks into performance.md, between its markers.

python -m benchmarks.speed --out docs/pictures > speed.json
python -m benchmarks.surface > surface.json
python tools/fill_performance.py speed.json surface.json
"""

from __future__ import annotations

import datetime
import json
import re
import sys
from pathlib import Path
from typing import Any

PAGE = Path(__file__).parents[1] / "docs" / "performance.md"


def table(speed: dict[str, Any]) -> str:
    """Real-time factors."""
    rows = ["| | one thread | two threads |", "| --- | --- | --- |"]
    for name, case in speed["real_time_factors"].items():
        rows.append(f"| {name} | {case['1 threads']['median']:.1f} | {case['2 threads']['median']:.1f} |")
    command = speed["whole_command"]["real-time factor"]["median"]
    rows.append(f"| `twin replay`, whole command, with its archive | | {command:.1f} |")
    return "\n".join(rows)


def flat(speed: dict[str, Any]) -> str:
    """Figures that the cost does not depend on."""
    zigzag, block, memory = speed["zigzag"], speed["block_size"], dict(speed["memory"])
    rows = [
        "| | |",
        "| --- | --- |",
        f"| last three passes of the zigzag over passes 2 to 4 | {zigzag['last passes over pass 2 to 4']:.2f} |",
        f"| a slot in a block of 600 mm over one in a block of 60 mm | {block['ratio']:.2f} |",
    ]
    rows += [
        f"| across a scalloped face over a fresh one, {depth} | {case['ratio']:.2f} |"
        for depth, case in speed["across"].items()
    ]
    rows += [
        f"| memory, {name.rpartition(', ')[0]} | {value} {name.split(', ')[-1]} |" for name, value in memory.items()
    ]
    return "\n".join(rows)


def surface(found: dict[str, Any]) -> str:
    """The surface program in one sentence."""
    return (
        f"{found['motions']:,} motions are read in {found['reading_s']:.2f} s and removed in "
        f"{found['removal_s']:.0f} s, "
        f"{found['ms_per_motion']:.2f} ms a motion; peak memory of the process is {found['peak_memory_mib']:,} MiB."
    )


def main() -> None:
    """Read the figures, write the page."""
    speed, found = (json.loads(Path(name).read_text(encoding="utf-8")) for name in sys.argv[1:3])
    both = json.dumps([speed, found], indent=1)
    today = datetime.datetime.now(tz=datetime.UTC).date()
    parts = {
        "table": table(speed),
        "flat": flat(speed),
        "surface": surface(found),
        "json": f"{today}, {speed['machine']}:\n\n```json\n{both}\n```",
    }
    text = PAGE.read_text(encoding="utf-8")
    for name, part in parts.items():
        around = re.compile(rf"(<!-- {name} -->\n).*?(<!-- end -->)", re.DOTALL)
        text = around.sub(lambda m, part=part: f"{m[1]}\n{part}\n\n{m[2]}", text)
    PAGE.write_text(text, encoding="utf-8")


if __name__ == "__main__":
    main()
