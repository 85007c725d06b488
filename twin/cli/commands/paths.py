"""``twin paths``."""

from __future__ import annotations

from enum import StrEnum
from pathlib import Path
from typing import Annotated, Any

import typer


class Strategy(StrEnum):
    """Kinds of tool paths."""

    CONTOUR = "contour"
    SCAN = "scan"


class Axis(StrEnum):
    """Feed directions of rows."""

    X = "x"
    Y = "y"


class Control(StrEnum):
    """Controls."""

    FANUC = "fanuc"
    HAAS = "haas"
    LINUXCNC = "linuxcnc"
    GRBL = "grbl"


class EntryWay(StrEnum):
    """Ways into material."""

    PLUNGE = "plunge"
    RAMP = "ramp"
    HELIX = "helix"


def _option(text: str, *names: str, metavar: str | None = None) -> Any:
    """An option that is left to the settings' file or to its default where it is not given."""
    return typer.Option(*names, help=text, metavar=metavar, show_default=False)


def paths(
    strategy: Annotated[Strategy, typer.Argument(help="Levels of equal height, or parallel rows.", show_default=False)],
    part: Annotated[Path, typer.Argument(metavar="PART.stl", help="The part, a closed solid, mm.", show_default=False)],
    out: Annotated[Path, typer.Option("--out", "-o", metavar="FILE", help="NC program to write.", show_default=False)],
    tool: Annotated[str | None, _option("Tool: 'ball 8', 'flat 10', 'bull 12 r2'.", metavar="TOOL")] = None,
    settings: Annotated[Path | None, _option("TOML file with any of the settings.", metavar="FILE")] = None,
    pitch: Annotated[float | None, _option("Distance of the part's slices, mm (0.1).")] = None,
    tolerance: Annotated[float | None, _option("Accuracy wanted, mm (0.02).")] = None,
    exact: Annotated[
        bool | None, _option("scan: rows from the triangles, not from slices.", "--exact/--slices")
    ] = None,
    stepover: Annotated[float | None, _option("scan: distance of the rows, mm (0.5).")] = None,
    allowance: Annotated[float | None, _option("Material to leave on the part, mm (0).")] = None,
    layers: Annotated[int | None, _option("Layers (1); contour: 0 for as many as clear the stock.")] = None,
    axial_depth: Annotated[
        float | None, _option("scan: depth of a layer; contour: distance of the levels, mm (1).")
    ] = None,
    radial_depth: Annotated[float | None, _option("contour: distance of the layers, mm (0.4 of the diameter).")] = None,
    direction: Annotated[Axis | None, _option("scan: axis that rows run along (x).")] = None,
    zigzag: Annotated[
        bool | None, _option("scan: rows to and fro, or all one way (zigzag).", "--zigzag/--one-way")
    ] = None,
    climb: Annotated[bool | None, _option("Climb or conventional (climb).", "--climb/--conventional")] = None,
    region: Annotated[
        tuple[float, float, float, float] | None,
        _option("Where the tip may be: X0 Y0 X1 Y1 (the box of part or stock)."),
    ] = None,
    overhang: Annotated[float | None, _option("How far beyond it, mm (scan 0, contour the tool's radius).")] = None,
    floor_z: Annotated[float | None, _option("Lowest tip, mm (the part's lowest point).")] = None,
    stock: Annotated[
        tuple[float, float, float, float, float, float] | None, _option("Stock: X0 Y0 Z0 X1 Y1 Z1 (the part's box).")
    ] = None,
    remaining: Annotated[float | None, _option("Material left on the part before, mm (all of the stock).")] = None,
    arcs: Annotated[float | None, _option("Fit arcs within this tolerance, mm (none).")] = None,
    feed: Annotated[float | None, _option("Feed of cuts, mm/min (600).")] = None,
    plunge_feed: Annotated[float | None, _option("Feed down, mm/min (200).")] = None,
    spindle: Annotated[float | None, _option("Spindle speed, rpm (3600).")] = None,
    safe_z: Annotated[float | None, _option("Height of rapids, mm (5 above the stock).")] = None,
    clearance: Annotated[float | None, _option("Above material, where rapids end, mm (1).")] = None,
    entry: Annotated[EntryWay | None, _option("Way into material (ramp).")] = None,
    lead: Annotated[float | None, _option("Radius of leads, mm (0, none).")] = None,
    tool_number: Annotated[int | None, _option("T and H word (1).")] = None,
    dialect: Annotated[Control | None, _option("Control (fanuc).")] = None,
    job_file: Annotated[
        Path | None, _option("Job file that replays the program (beside it, .toml).", "--job-file", metavar="FILE")
    ] = None,
    plot: Annotated[Path | None, _option("Picture of the path, .png, .svg or .pdf.", metavar="FILE")] = None,
    rrd: Annotated[Path | None, _option("Path and part as a rerun recording.", metavar="FILE")] = None,
    force: Annotated[bool, typer.Option("--force", help="Replace files that are there.")] = False,
    as_json: Annotated[bool, typer.Option("--json", help="Print the summary as one JSON object.")] = False,
    quiet: Annotated[bool, typer.Option("--quiet", "-q", help="No progress and no summary.")] = False,
) -> None:
    """Make an NC program from a part's STL file, and a job file that replays it.

    Feed, speeds, steps and all else have defaults; a TOML file gives them under the same names with units
    (docs/paths.md), and options go before it. Nothing is written when the tool can cut nothing.
    """
    from twin.cli.commands.planning import check_outputs, finish, planned

    given = {
        "tool": tool,
        "pitch_mm": pitch,
        "tolerance_mm": tolerance,
        "exact": exact,
        "stepover_mm": stepover,
        "allowance_mm": allowance,
        "layers": layers,
        "axial_depth_mm": axial_depth,
        "radial_depth_mm": radial_depth,
        "direction": direction,
        "zigzag": zigzag,
        "climb": climb,
        "region_mm": region,
        "overhang_mm": overhang,
        "floor_z_mm": floor_z,
        "stock_mm": stock,
        "remaining_mm": remaining,
        "arcs_mm": arcs,
        "feed_mm_min": feed,
        "plunge_mm_min": plunge_feed,
        "spindle_rpm": spindle,
        "safe_z_mm": safe_z,
        "clearance_mm": clearance,
        "entry": entry,
        "lead_mm": lead,
        "tool_number": tool_number,
        "dialect": dialect,
    }
    job = job_file if job_file is not None else out.with_suffix(".toml")
    files = {"program": out, "job": job, "picture": plot, "recording": rrd}
    check_outputs(files, force=force)
    values = {key: str(v) if isinstance(v, StrEnum) else v for key, v in given.items() if v is not None}
    made = planned(strategy.value, part, settings, values, quiet=quiet or as_json)
    finish(made, files, force=force, as_json=as_json, quiet=quiet)
