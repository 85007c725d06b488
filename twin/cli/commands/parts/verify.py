"""``twin verify``."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from twin.cli import exit_codes
from twin.cli.common import Force, Json, Picture, Quiet, Recording, SettingsFile
from twin.cli.options import options_from, settings_from_file
from twin.verification.settings import VerifySettings

if TYPE_CHECKING:
    from twin.verification.verification import Verification


@options_from(VerifySettings, "given", panel="Tolerances")
def verify(
    job_file: Annotated[Path, typer.Argument(metavar="JOB", help="Job file (TOML).", show_default=False)],
    part: Annotated[
        Path,
        typer.Argument(metavar="PART.stl", help="The design, in the stock's coordinates.", show_default=False),
    ],
    given: Mapping[str, Any],
    settings: SettingsFile = None,
    plot: Picture = None,
    rrd: Recording = None,
    force: Force = False,
    as_json: Json = False,
    quiet: Quiet = False,
) -> None:
    """Replay a job without forces and compare the machined surface with the design: gouges, excess material, positions.

    Ends with exit code 4 if a gouge is deeper than the tolerance or the excess is more than permitted.
    """
    from twin.cli.console import say_json, warn
    from twin.cli.show.progress import progress
    from twin.cli.show.verify_tables import deviation_json, print_deviation
    from twin.planning.output_files import check_outputs
    from twin.verification.verification import verify as verified

    files = {"picture": plot, "recording": rrd}
    check_outputs(files, force=force)
    tolerances = settings_from_file(VerifySettings, given, settings, "twin verify")
    with progress(quiet=quiet or as_json) as line:
        found = verified(job_file, part, tolerances, begin=line.start, at=line.at)
    for warning in found.warnings:
        warn(warning)
    _draw(found, plot, rrd, f"{job_file.name} compared with {part.name}", force=force)
    if as_json:
        say_json(deviation_json(found, {"job": job_file, "part": part, **files}))
    elif not quiet:
        print_deviation(found)
    raise typer.Exit(exit_codes.OK if found.within_tolerance else exit_codes.OUT_OF_TOLERANCE)


def _draw(found: Verification, plot: Path | None, rrd: Path | None, title: str, *, force: bool) -> None:
    if plot is not None:
        from twin.verification.plot import plot_deviation

        plot_deviation(found.deviation, plot, title=title)
    if rrd is not None:
        from twin.cli.show.stills import deviation_still
        from twin.sinks.rerun.still import write_still

        write_still(rrd, deviation_still(found.deviation, found.design, title), force=force)
