"""``twin paths``."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Literal

import typer

from twin.cli.common import Force, Json, Part, Picture, Quiet, Recording, SettingsFile
from twin.cli.options import options_from, settings_from_file
from twin.planning.settings import PathSettings

if TYPE_CHECKING:
    from twin.planning.planned_path import PlannedPath


@options_from(PathSettings, "given", omit=("strategy",), panel="Tool path")
def paths(
    strategy: Annotated[
        Literal["contour", "scan"],
        typer.Argument(help="contour: levels of constant Z; scan: parallel rows over the surface.", show_default=False),
    ],
    part: Part,
    out: Annotated[Path, typer.Option("--out", "-o", metavar="FILE", help="NC program to write.", show_default=False)],
    given: Mapping[str, Any],
    settings: SettingsFile = None,
    job_file: Annotated[
        Path | None,
        typer.Option(
            "--job-file", metavar="FILE", help="Job file that replays the program.", show_default="FILE of --out, .toml"
        ),
    ] = None,
    plot: Picture = None,
    rrd: Recording = None,
    force: Force = False,
    as_json: Json = False,
    quiet: Quiet = False,
) -> None:
    """Make an NC program from a part's STL file, and a job file that replays it.

    All parameters of the tool path except the tool have defaults. They can also be given in a TOML file, by their key
    names (docs/paths.md); options override the file. Nothing is written if the tool cannot cut anything.
    """
    from twin.cli.console import say_json, warn
    from twin.cli.show.path_summary import path_json, print_path
    from twin.cli.show.progress import working
    from twin.planning.output_files import check_outputs
    from twin.planning.planned_path import plan_paths

    job = job_file if job_file is not None else out.with_suffix(".toml")
    files = {"program": out, "job": job, "picture": plot, "recording": rrd}
    check_outputs(files, force=force)
    parameters = settings_from_file(PathSettings, {**given, "strategy": strategy}, settings, "twin paths")
    with working(quiet=quiet or as_json) as progress:
        made = plan_paths(part, parameters, progress=progress)
    for warning in made.warnings:
        warn(warning)
    lines = made.write(out, job, force=force)
    _draw(made, plot, rrd, force=force)
    if as_json:
        say_json(path_json(made, lines, files))
    elif not quiet:
        print_path(made, lines, files)


def _draw(made: PlannedPath, plot: Path | None, rrd: Path | None, *, force: bool) -> None:
    if plot is not None:
        made.plot(plot)
    if rrd is not None:
        from twin.cli.show.stills import paths_still
        from twin.sinks.rerun.still import write_still

        write_still(rrd, paths_still({"path": made.path}, made.setup.part.mesh), force=force)
