"""Report of ``twin mold``: human-readable tables, or one JSON object."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import asdict
from pathlib import Path
from typing import Any

from rich.table import Table

from twin.cli.console import results
from twin.moldmaking.figures import Times
from twin.moldmaking.result import Mold
from twin.moldmaking.stages import StageResult


def print_mold(found: Mold, files: Mapping[str, Path]) -> None:
    """Print tables of stages and machining times, then the files."""
    console = results()
    console.print(_stages_table(found))
    if found.times:
        console.print()
        console.print(_times_table(found.times))
    if found.saved is not None:
        console.print(f"{100.0 * found.saved:.1f} % less than the raster baseline")
    console.print()
    for kind, path in files.items():
        console.print(f"{kind:12} {path}", markup=False, soft_wrap=True)


def _stages_table(found: Mold) -> Table:
    table = Table(box=None, pad_edge=False)
    for name in ("stage", "min", "cutting, min", "moves", "computed in, s"):
        table.add_column(name, justify="left" if name == "stage" else "right")
    for stage, result in found.stages.items():
        times = (result.time.total_s / 60.0, result.time.cutting_s / 60.0)
        table.add_row(stage, *(f"{t:.2f}" for t in times), str(len(result.path.moves)), f"{result.computed_s:.1f}")
    return table


def _times_table(times: tuple[Times, ...]) -> Table:
    table = Table(title="Machining time, min", title_justify="left", box=None, pad_edge=False)
    for name in ("", "rough", "semi", "finish", "total"):
        table.add_column(name, justify="right" if name else "left")
    for line in times:
        table.add_row(line.name, *(f"{minutes:.2f}" for minutes in _minutes(line).values()))
    return table


def mold_json(found: Mold, files: Mapping[str, Path]) -> str:
    """The object of ``--json``."""
    values: dict[str, Any] = {
        "triangles": len(found.plan.part.triangles),
        "read_s": found.plan.read_s,
        "stages": {stage: _stage_values(result) for stage, result in found.stages.items()},
    }
    if found.times:
        values["times_min"] = {line.name: _minutes(line) for line in found.times}
        values["saved"] = found.saved
        values["rest"] = {stage: asdict(rest) for stage, rest in found.rest.items()}
    values |= {"files": {kind: str(path) for kind, path in files.items()}, "warnings": found.warnings}
    return json.dumps(values, indent=1)


def _stage_values(result: StageResult) -> dict[str, Any]:
    return {
        "time_s": result.time.total_s,
        "cutting_s": result.time.cutting_s,
        "length_mm": {str(kind): length for kind, length in result.path.lengths_mm().items()},
        "moves": len(result.path.moves),
        "points": result.path.points,
        "computed_s": result.computed_s,
    }


def _minutes(line: Times) -> dict[str, float]:
    seconds = {"rough": line.rough_s, "semi": line.semi_s, "finish": line.finish_s, "total": line.total_s}
    return {stage: s / 60.0 for stage, s in seconds.items()}
