"""``twin mesh``."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from twin.cli import exit_codes

if TYPE_CHECKING:
    from twin.workpiece.to_mesh import SurfaceMesh

_ARCHIVE = ".mcap"


def mesh(
    source: Annotated[
        Path, typer.Argument(metavar="RUN.mcap|JOB", help="Archive of a run, or a job to replay.", show_default=False)
    ],
    out: Annotated[Path, typer.Argument(metavar="OUT.stl|.3mf", help="Mesh to write, in mm.", show_default=False)],
    force: Annotated[bool, typer.Option("--force", help="Replace a file that exists.")] = False,
) -> None:
    """Write the machined part as a triangle mesh.

    From an archive: the last surface recorded. From a job: the job is replayed, and the mesh is made from the slices.
    """
    from twin.cli.console import results
    from twin.workpiece.solids.mesh_file import check_mesh_path, write_mesh

    check_mesh_path(out, force=force)
    made = _from_run(source) if source.suffix.lower() == _ARCHIVE else _from_job(source)
    write_mesh(out, made, force=force)
    results().print(f"{len(made.triangles)} triangles written to {out}", markup=False, soft_wrap=True)


def _from_run(run: Path) -> SurfaceMesh:
    from twin.cli.early_end import warn_of_early_end
    from twin.run.run import Run

    warn_of_early_end(run)
    return Run(run).mesh()


def _from_job(job_file: Path) -> SurfaceMesh:
    from twin.cli.commands.runs.replay_work import replay_job
    from twin.cli.show.progress import progress
    from twin.job import load_job

    job = load_job(job_file).without_forces()
    with progress(quiet=False) as line:
        outcome = replay_job(job, line, at_end=lambda run: run.mesh())
    if outcome.signal_number is not None or outcome.at_end is None:
        raise typer.Exit(exit_codes.SIGNAL + (outcome.signal_number or 0))
    return outcome.at_end
