"""``twin reach``."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

if TYPE_CHECKING:
    from twin.cam.reach.reach import Reach
    from twin.cam.slices.sections import SlicedPart
    from twin.tools.shape import ToolShape

#: Without a pitch asked for, the part's longest side has this many slices.
_SLICES_ALONG = 600


def reach(
    part: Annotated[Path, typer.Argument(metavar="PART.stl", help="The part to be made, in mm.", show_default=False)],
    tool: Annotated[
        list[str] | None, typer.Option("--tool", metavar="TOOL", help='"ball 8", "flat 10", "bull 12 r2"; may repeat.')
    ] = None,
    pitch: Annotated[
        float | None, typer.Option(help="Largest distance of the slices, mm.", show_default="longest side / 600")
    ] = None,
    thin: Annotated[
        float | None, typer.Option(help="Least thickness that counts, mm.", show_default="what slices can tell")
    ] = None,
    above: Annotated[bool, typer.Option("--above", help="Balls come from above too, not from any side.")] = False,
    largest: Annotated[bool, typer.Option("--largest", help="Find the largest ball that finishes the part.")] = False,
    as_json: Annotated[bool, typer.Option("--json", help="Print one JSON object.")] = False,
    rrd: Annotated[Path | None, typer.Option(metavar="FILE", help="Write a rerun recording.")] = None,
    mesh: Annotated[Path | None, typer.Option(metavar="DIR", help="Write what stays as STL files.")] = None,
    plot: Annotated[Path | None, typer.Option(metavar="FILE.png", help="Draw what stays.")] = None,
    force: Annotated[bool, typer.Option("--force", help="Replace files that are there.")] = False,
    threads: Annotated[int | None, typer.Option(min=1, help="Threads to work with.", show_default="all cores")] = None,
) -> None:
    """Tell what tools cannot reach on a part: where, how much, how thick."""
    from twin.cam.reach.largest_ball import largest_ball_mm
    from twin.cam.slices.sections import slice_part
    from twin.cli.show import reach_outputs as outputs
    from twin.cli.show.reach_report import json_text, print_report
    from twin.errors import ToolError
    from twin.tools.text import parse_tool

    tools = {text: parse_tool(text) for text in tool or ()}
    if not tools and not largest:
        raise ToolError('no tool; expected --tool "ball 8", or --largest')
    outputs.check(rrd, mesh, plot, list(tools), force=force)
    sliced = slice_part(part, pitch if pitch is not None else _own_pitch(part))
    with outputs.progress_line() as tell:
        reaches = {}
        for text, shape in tools.items():
            tell(f"{part.name}: {text}")
            reaches[text] = _reach(sliced, shape, above=above, thin=thin, threads=threads)
        tell(f"{part.name}: largest ball")
        ball = largest_ball_mm(sliced, thin_mm=thin, threads=threads) if largest else None
    _warn_if_coarse(reaches, thin)
    outputs.write(sliced, reaches, rrd, mesh, plot, force=force)
    if as_json:
        typer.echo(json_text(part, sliced, reaches, searched=largest, ball_mm=ball))
    else:
        print_report(part, sliced, reaches, searched=largest, ball_mm=ball)


def _own_pitch(part: Path) -> float:
    from twin.workpiece.from_mesh import load_mesh

    solid = load_mesh(part)
    return float((solid.vertices_mm.max(axis=0) - solid.vertices_mm.min(axis=0)).max()) / _SLICES_ALONG


def _reach(sliced: SlicedPart, shape: ToolShape, *, above: bool, thin: float | None, threads: int | None) -> Reach:
    from twin.cam.reach.reach import tool_reach
    from twin.cam.slices.structuring_element import StructuringElement

    any_side = shape.disc_mm == 0.0 and shape.taper_rad == 0.0 and not above
    element = StructuringElement.ball(shape.corner_mm) if any_side else StructuringElement.tool(shape)
    return tool_reach(sliced, element, thin_mm=thin, threads=threads)


def _warn_if_coarse(reaches: dict[str, Reach], thin: float | None) -> None:
    """A thickness asked for that slices at this pitch cannot tell."""
    from twin.cam.reach.reach import thin_bound_mm
    from twin.cli.console import warn

    for text, reach in reaches.items():
        bound = thin_bound_mm(reach.element, reach.pitch_mm)
        if thin is not None and thin < bound:
            warn(
                f"{text}: slices {reach.pitch_mm:.4g} mm apart may show leftovers up to {bound:.3g} mm thick that are "
                f"none; for {thin:g} mm expected a pitch of at most {thin:.3g} mm"
            )
