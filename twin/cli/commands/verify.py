"""``twin verify``."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from twin.cli import exit_codes

if TYPE_CHECKING:
    from twin.record import Collision
    from twin.verification.deviation import Deviation


def verify(
    job_file: Annotated[Path, typer.Argument(metavar="JOB", help="Job file (TOML).", show_default=False)],
    part: Annotated[
        Path,
        typer.Argument(metavar="PART.stl", help="The design, in the stock's coordinates, mm.", show_default=False),
    ],
    tolerance: Annotated[float, typer.Option(help="Gouge that is still right, mm.")] = 0.02,
    excess: Annotated[
        float | None,
        typer.Option(help="Excess that is right: allowance and scallops, mm; the tolerance.", show_default=False),
    ] = None,
    region: Annotated[
        tuple[float, float, float, float] | None,
        typer.Option(help="Judge only X0 Y0 X1 Y1; the design's box if not given.", show_default=False),
    ] = None,
    pitch: Annotated[
        float | None, typer.Option(help="Slice pitch, mm; the job's if not given.", show_default=False)
    ] = None,
    plot: Annotated[
        Path | None, typer.Option(metavar="FILE", help="Picture, .png, .svg or .pdf.", show_default=False)
    ] = None,
    rrd: Annotated[
        Path | None, typer.Option(metavar="FILE", help="Deviations as a rerun recording.", show_default=False)
    ] = None,
    force: Annotated[bool, typer.Option("--force", help="Replace files that are there.")] = False,
    as_json: Annotated[bool, typer.Option("--json", help="Print one JSON object.")] = False,
    quiet: Annotated[bool, typer.Option("--quiet", "-q", help="No progress and no tables.")] = False,
) -> None:
    """Replay a job and compare the machined surface with the design: gouges, excess, and where.

    Ends with exit code 4 when a gouge is deeper than the tolerance, or more is left than is right.
    """
    from twin.cli.commands.planning import check_outputs
    from twin.cli.show.progress import progress
    from twin.errors import ToolPathError
    from twin.job import load_job
    from twin.verification.deviation import Limits, deviation
    from twin.verification.machining import machined
    from twin.workpiece.from_mesh import load_mesh

    check_outputs({"picture": plot, "recording": rrd}, force=force)
    if not tolerance > 0.0 or (excess is not None and not excess > 0.0):
        told = f"tolerance {tolerance:g} mm" + ("" if excess is None else f", excess {excess:g} mm")
        raise ToolPathError(f"{told}: expected numbers above 0")
    job, design = load_job(job_file), load_mesh(part)
    if pitch is not None:
        job = job.with_pitch(pitch)
    with progress(quiet=quiet or as_json) as line:
        store, collisions = machined(job, begin=line.start, at=line.at)
    found = deviation(store, design, tolerance_mm=tolerance, excess_mm=excess, limits=Limits.of(design, region))
    if plot is not None:
        from twin.verification.plot import plot_deviation

        plot_deviation(found, plot, title=f"{job_file.name} against {part.name}")
    if rrd is not None:
        from twin.cli.show.stills import deviation_still
        from twin.sinks.rerun.still import write_still

        write_still(rrd, deviation_still(found, design, f"{job_file.name} against {part.name}"), force=force)
    if as_json:
        _print_json(found, collisions, {"job": job_file, "part": part, "picture": plot, "recording": rrd})
    elif not quiet:
        from twin.cli.show.verify_tables import print_deviation

        print_deviation(found, collisions)
    raise typer.Exit(exit_codes.OK if found.gouge_ok and found.excess_ok else exit_codes.OUT_OF_TOLERANCE)


def _print_json(found: Deviation, collisions: tuple[Collision, ...], files: dict[str, Path | None]) -> None:
    import json

    from twin.cli.show.verify_tables import deviation_object

    names: dict[str, Any] = {key: None if path is None else str(path) for key, path in files.items()}
    typer.echo(json.dumps(deviation_object(found, collisions) | names, indent=2, ensure_ascii=False))
