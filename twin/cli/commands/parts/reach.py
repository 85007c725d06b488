"""``twin reach``."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from twin.cli.common import Force, Json, Part, Picture, Quiet, Recording, SettingsFile
from twin.cli.options import options_from, settings_from_file
from twin.planning.settings import ReachSettings

if TYPE_CHECKING:
    from twin.planning.part_reach import PartReach


@options_from(ReachSettings, "given", panel="Reach analysis")
def reach(
    part: Part,
    given: Mapping[str, Any],
    settings: SettingsFile = None,
    out: Annotated[
        Path | None,
        typer.Option("--out", "-o", "--mesh", metavar="DIR", help="Write uncut material here, one STL file per tool."),
    ] = None,
    plot: Picture = None,
    rrd: Recording = None,
    force: Force = False,
    as_json: Json = False,
    quiet: Quiet = False,
    threads: Annotated[
        int | None, typer.Option(min=1, max=64, help="Number of threads.", show_default="all cores")
    ] = None,
) -> None:
    """Find the material that tools cannot reach on a part: position, volume, thickness."""
    from twin.cli.console import say_json, warn
    from twin.cli.show.progress import working
    from twin.cli.show.reach_report import print_reach, reach_json
    from twin.planning.output_files import check_outputs
    from twin.planning.part_reach import mesh_files
    from twin.planning.part_reach import reach as part_reach

    check_outputs({"picture": plot, "recording": rrd}, force=force)
    parameters = settings_from_file(ReachSettings, given, settings, "twin reach")
    if out is not None:
        mesh_files(out, parameters, force=force)
    with working(quiet=quiet or as_json) as progress:
        found = part_reach(part, parameters, threads=threads, progress=progress)
    for warning in found.warnings:
        warn(warning)
    if out is not None:
        found.write_meshes(out, force=force)
    _draw(found, plot, rrd, force=force)
    if as_json:
        say_json(reach_json(part, found))
    elif not quiet:
        print_reach(part, found)


def _draw(found: PartReach, plot: Path | None, rrd: Path | None, *, force: bool) -> None:
    if rrd is not None:
        from twin.cli.show.stills import reach_still
        from twin.sinks.rerun.still import write_still

        write_still(rrd, reach_still(found), force=force)
    if plot is not None:
        from twin.cli.show.reach_plot import write_plot

        write_plot(plot, found.part, found.tools)
