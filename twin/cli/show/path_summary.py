"""Summary of ``twin paths``: human-readable, or one JSON object."""

from __future__ import annotations

import json
from collections.abc import Mapping
from pathlib import Path

from twin.cam.path.to_nc import describe
from twin.cam.path.toolpath import MoveKind
from twin.cli.console import results
from twin.number_format import clock, grouped, plural
from twin.planning.planned_path import PlannedPath


def print_path(made: PlannedPath, lines: int, files: Mapping[str, Path | None]) -> None:
    """Print lengths, time and files.

    Args:
        made: the planned path.
        lines: number of lines of its program.
        files: outputs by kind, None for those that are not requested.
    """
    console = results()
    lengths = {kind.value: length for kind, length in made.path.lengths_mm().items()}
    console.print(f"{made.path.name}, {describe(made.path.tool)}", markup=False)
    order = [k.value for k in MoveKind if k.value in lengths]
    console.print("  ".join(f"{k} {grouped(lengths[k])} mm" for k in order), markup=False, soft_wrap=True)
    console.print(f"{clock(made.machine_time_s)} at the programmed feeds, {plural(lines, 'line')}", markup=False)
    for kind, path in files.items():
        if path is not None:
            console.print(f"{kind.capitalize():<10} {path}", markup=False, soft_wrap=True)


def path_json(made: PlannedPath, lines: int, files: Mapping[str, Path | None]) -> str:
    """The object of ``--json``; arguments as for `print_path`."""
    summary = {
        "lengths_mm": {kind.value: length for kind, length in made.path.lengths_mm().items()},
        "machine_time_s": made.machine_time_s,
        "points": made.path.points,
        "arcs": sum(move.arc is not None for move in made.path.moves),
        "lines": lines,
        "wall_time_s": made.computed_s,
        **{kind: None if path is None else str(path) for kind, path in files.items()},
    }
    return json.dumps(summary, indent=2)
