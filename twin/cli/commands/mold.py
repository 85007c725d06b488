"""``twin mold``."""

from __future__ import annotations

import json
from enum import StrEnum
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

if TYPE_CHECKING:
    from twin.moldmaking import MoldPlan, Stage
    from twin.moldmaking.figures import Times


class StageName(StrEnum):
    """Stages that can be asked for alone."""

    ROUGH = "rough"
    SEMI = "semi"
    FINISH = "finish"


def mold(
    job_file: Annotated[Path, typer.Argument(metavar="JOB", help="Mold job (TOML).", show_default=False)],
    stage: Annotated[
        StageName | None, typer.Option(help="One stage only; all if not given.", show_default=False)
    ] = None,
    plot: Annotated[
        Path | None,
        typer.Option(metavar="DIR", help="Draw paths and what each stage leaves here.", show_default=False),
    ] = None,
    rrd: Annotated[
        Path | None, typer.Option(metavar="FILE", help="Write paths and part as a rerun recording.", show_default=False)
    ] = None,
    force: Annotated[bool, typer.Option("--force", help="Replace output files that are there.")] = False,
    as_json: Annotated[bool, typer.Option("--json", help="Print the table as one JSON object.")] = False,
    quiet: Annotated[
        bool, typer.Option("--quiet", "-q", help="No progress and no table; warnings and errors are still said.")
    ] = False,
) -> None:
    """Machine a mold from its STL: roughing, semi-finishing of what is left, finishing; a program a stage.

    Every stage starts from what the one before leaves, so those before are computed for --stage as well.
    """
    from twin.cli.console import warn
    from twin.cli.show.progress import working
    from twin.moldmaking import STAGES, MoldPlan, load_mold
    from twin.moldmaking.programs import check_paths, program_paths, write_programs

    job = load_mold(job_file)
    stages: tuple[Stage, ...] = STAGES if stage is None else (stage.value,)
    with working(quiet=quiet or as_json, even=True) as report:
        plan = MoldPlan(job, report)
        wanted = [*program_paths(plan, stages).values(), *([rrd] if rrd is not None else [])]
        check_paths(wanted, force=force)
        files = write_programs(plan, stages, force=force)
        found = _figures(plan, stages)
        if plot is not None:
            files |= _plotted(plan, stages, plot)
        if rrd is not None:
            files |= _recorded(plan, stages, rrd, force=force)
        warnings = plan.warnings(stages)
    if as_json:
        typer.echo(
            json.dumps({**found, "files": {k: str(v) for k, v in files.items()}, "warnings": warnings}, indent=1)
        )
    elif not quiet:
        _print(found, files)
    for warning in warnings:
        warn(warning)


def _figures(plan: MoldPlan, stages: tuple[Stage, ...]) -> dict[str, Any]:
    """All numbers that are said."""
    from dataclasses import asdict

    from twin.moldmaking import STAGES
    from twin.moldmaking.figures import rest_table, saved, times_table

    figures: dict[str, Any] = {
        "triangles": len(plan.part.triangles),
        "read_s": plan.read_s,
        "stages": {s: _stage_figures(plan, s) for s in stages},
    }
    if stages == STAGES:
        lines = times_table(plan)
        figures["times_min"] = {line.name: _minutes(line) for line in lines}
        figures["saved"] = saved(lines)
        figures["rest"] = {name: asdict(rest) for name, rest in rest_table(plan).items()}
    return figures


def _stage_figures(plan: MoldPlan, stage: Stage) -> dict[str, Any]:
    result = plan.stage(stage)
    return {
        "time_s": result.time.total_s,
        "cutting_s": result.time.cutting_s,
        "length_mm": {str(kind): length for kind, length in result.path.lengths_mm().items()},
        "moves": len(result.path.moves),
        "points": result.path.points,
        "computed_s": result.computed_s,
    }


def _minutes(line: Times) -> dict[str, float]:
    return {
        "rough": line.rough_s / 60.0,
        "semi": line.semi_s / 60.0,
        "finish": line.finish_s / 60.0,
        "total": line.total_s / 60.0,
    }


def _plotted(plan: MoldPlan, stages: tuple[Stage, ...], folder: Path) -> dict[str, Path]:
    from twin.moldmaking.pictures import draw

    return {f"picture {path.stem}": path for path in draw(plan, stages, folder)}


def _recorded(plan: MoldPlan, stages: tuple[Stage, ...], file: Path, *, force: bool) -> dict[str, Path]:
    from twin.cli.show.stills import paths_still
    from twin.sinks.rerun.still import write_still

    write_still(file, paths_still({str(s): plan.stage(s).path for s in stages}, plan.part), force=force)
    return {"recording": file}


def _print(figures: dict[str, Any], files: dict[str, Path]) -> None:
    from rich.table import Table

    from twin.cli.console import results

    console = results()
    table = Table(box=None, pad_edge=False)
    for name in ("stage", "min", "cutting, min", "moves", "computed in, s"):
        table.add_column(name, justify="left" if name == "stage" else "right")
    for stage, one in figures["stages"].items():
        cells = (one["time_s"] / 60.0, one["cutting_s"] / 60.0)
        table.add_row(stage, *(f"{c:.2f}" for c in cells), str(one["moves"]), f"{one['computed_s']:.1f}")
    console.print(table)
    if "times_min" in figures:
        console.print()
        console.print(_times_table(figures))
    if figures.get("saved") is not None:
        console.print(f"{100.0 * figures['saved']:.1f} % less than the raster baseline")
    console.print()
    for name, path in files.items():
        console.print(f"{name:12} {path}", markup=False, soft_wrap=True)


def _times_table(figures: dict[str, Any]) -> Any:
    from rich.table import Table

    table = Table(title="Machining time, min", title_justify="left", box=None, pad_edge=False)
    for name in ("", "rough", "semi", "finish", "total"):
        table.add_column(name, justify="left" if not name else "right")
    for name, line in figures["times_min"].items():
        table.add_row(name, *(f"{line[k]:.2f}" for k in ("rough", "semi", "finish", "total")))
    return table
