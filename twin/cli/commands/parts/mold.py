"""``twin mold``."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Literal

import typer

from twin.cli.common import Force, Json, Quiet, Recording
from twin.workpiece.solids.units import Unit

if TYPE_CHECKING:
    from twin.moldmaking.result import Mold


def mold(
    job_file: Annotated[Path, typer.Argument(metavar="JOB", help="Mold job (TOML).", show_default=False)],
    out: Annotated[
        Path | None,
        typer.Option(
            "--out", "-o", metavar="DIR", help="Folder of the programs.", show_default="output.folder of the job"
        ),
    ] = None,
    stage: Annotated[
        Literal["rough", "semi", "finish"] | None,
        typer.Option(help="Write this stage only; those before it are planned as well.", show_default="all"),
    ] = None,
    plot: Annotated[
        Path | None, typer.Option(metavar="DIR", help="Draw paths and rest material of each stage here.")
    ] = None,
    rrd: Recording = None,
    unit: Annotated[
        Unit | None,
        typer.Option(help="Unit of the STL file; auto: a plausible one.", show_default="part.unit of the job"),
    ] = None,
    force: Force = False,
    as_json: Json = False,
    quiet: Quiet = False,
) -> None:
    """Machine a mold from its STL file: roughing, semi-finishing of rest material, finishing; one program per stage.

    All parameters are keys of the mold job file (docs/mold.md). Options cannot set them, except part.unit and
    output.folder, since stages and tools are tables.
    """
    from twin.cli.console import say_json, warn
    from twin.cli.show.mold_tables import mold_json, print_mold
    from twin.cli.show.progress import working
    from twin.moldmaking import STAGES, load_mold
    from twin.moldmaking.programs import program_paths
    from twin.moldmaking.result import mold as planned
    from twin.planning.output_files import check_outputs, refuse_existing

    job = load_mold(job_file)
    job = job.with_folder(out) if out is not None else job
    job = job.with_unit(unit) if unit is not None else job
    check_outputs({"recording": rrd}, force=force)
    refuse_existing(program_paths(job, STAGES if stage is None else (stage,)).values(), force=force)
    with working(quiet=quiet or as_json, even=True) as progress:
        found = planned(job, stage=stage, progress=progress)
    for warning in found.warnings:
        warn(warning)
    files = found.write(force=force) | _drawn(found, plot, rrd, force=force)
    if as_json:
        say_json(mold_json(found, files))
    elif not quiet:
        print_mold(found, files)


def _drawn(found: Mold, plot: Path | None, rrd: Path | None, *, force: bool) -> dict[str, Path]:
    """Write the picture and recording that are requested."""
    files: dict[str, Path] = {}
    if plot is not None:
        from twin.moldmaking.pictures import draw

        files |= {f"picture {path.stem}": path for path in draw(found.plan, tuple(found.stages), plot)}
    if rrd is not None:
        from twin.cli.show.stills import paths_still
        from twin.sinks.rerun.still import write_still

        paths = {str(stage): result.path for stage, result in found.stages.items()}
        write_still(rrd, paths_still(paths, found.plan.part), force=force)
        files["recording"] = rrd
    return files
