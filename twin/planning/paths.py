"""Flow B on one page: part -> slices -> inflated sections -> passes -> links -> arcs -> tool path.

part = prepare(settings, "part.stl")
path = plan(settings, part)
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from twin.arrays import FloatArray
from twin.cam.passes.contour import ContourOptions, OutlineLinkPlanner, contour_passes, level_heights, levels_of
from twin.cam.passes.scan import ACROSS, Rows, ScanOptions, row_positions, scan_passes
from twin.cam.path.arc_fit import FitOptions, Side, fit_path
from twin.cam.path.linking import LinkOptions, LinkPlanner, Pass, link
from twin.cam.path.surface_links import SurfaceLinkPlanner
from twin.cam.path.to_nc import describe
from twin.cam.path.toolpath import ToolPath
from twin.cam.slices.cl_lines import Profiles, cl_lines
from twin.cam.slices.offset import inflated_planes
from twin.cam.slices.polylines import Samples
from twin.cam.slices.sections import Sections, SlicedPart, cut_sections, slice_part
from twin.cam.slices.steep_sections import with_steep_sections
from twin.cam.slices.structuring_element import StructuringElement
from twin.cam.surface.drop_lines import drop_lines
from twin.cam.surface.surface import Surface, surface_of_mesh
from twin.errors import ToolPathError
from twin.geometry.polygons.outline import box_area, grown
from twin.geometry.polygons.region import Region
from twin.planning.settings import PathSettings
from twin.tools.shape import ToolShape
from twin.tools.text import parse_tool
from twin.workpiece.from_mesh import Solid

#: Told of how far the work has come: what is done, and how much of all.
Report = Callable[[str, float], None]
#: Chords of inflated sections stand this part of the pitch inside their arcs.
_CHORD_PITCHES = 0.005
#: Chords of rows stand no farther off the tip's true line; or this part of the allowance.
_CHORD_MM, _CHORD_ALLOWANCE = 0.0005, 0.05
#: Samples that rows begin with are a slice pitch apart; no closer than this part of the radius of ball or corner arc,
#: for the tool's own round hides what is finer, and places are added where chords would not do.
_PLACES_APART = 0.0125
#: Planes that are inflated between two reports.
_PLANES_TOGETHER = 32
#: What a contour's overhang lacks to the tool's radius, and a few chords: flush sides of the stock are left alone.
_SHORT = 1e-3
#: Levels are asked this much higher, for at the very height of a flat face the tool may stand on it.
_LIFT_MM = 1e-6
#: Tips higher than this above the stock are in air, and rows are broken there.
_AIR_MM = 0.01
#: Rapids are this much above the stock, unless told otherwise.
SAFE_ABOVE_MM = 5.0


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Ground:
    """What a path is planned on.

    Attributes:
        tool: its shape.
        part: the part's slices.
        sections: those that the path is made from, with more of them where that pays.
        region_mm: where the tip may be, lower and upper corner, shape (2, 2).
        overhang_mm: how far it may go beyond that.
        stock_mm: the stock's box, shape (2, 3).
        floor_mm: lowest tip.
        safe_mm: height of rapids.
    """

    tool: ToolShape
    part: SlicedPart
    sections: Sections
    region_mm: FloatArray
    overhang_mm: float
    stock_mm: FloatArray
    floor_mm: float
    safe_mm: float


def _quiet(what: str, share: float) -> None:
    """No reports."""


def prepare(settings: PathSettings, part: Path | str | SlicedPart, report: Report = _quiet) -> Ground:
    """Read and slice the part, and settle what depends on its box.

    Raises:
        MeshError, StockError, ToolError: no solid, a pitch that cannot be, a text that names no tool.
        ToolPathError: a safe height below the stock's top.
    """
    tool = parse_tool(settings.tool)
    _check_tool(settings, tool)
    report("slicing", 0.0)
    sliced = part if isinstance(part, SlicedPart) else slice_part(part, settings.pitch_mm)
    box = np.array([sliced.slices.low_mm, sliced.slices.high_mm])
    stock = np.reshape(settings.stock_mm, (2, 3)) if settings.stock_mm else box
    scan = settings.strategy == "scan"
    region = np.reshape(settings.region_mm, (2, 2)) if settings.region_mm else (box if scan else stock)[:, :2]
    default = 0.0 if scan else tool.max_radius_mm - _SHORT - 4.0 * _CHORD_PITCHES * settings.pitch_mm
    overhang = default if settings.overhang_mm is None else settings.overhang_mm
    top = float(stock[1, 2])
    safe = top + max(SAFE_ABOVE_MM, settings.clearance_mm) if settings.safe_z_mm is None else settings.safe_z_mm
    if safe < top + settings.clearance_mm:
        raise ToolPathError(
            f"safe_z_mm = {safe:g}: expected at least {top + settings.clearance_mm:g}, clearance above the stock's top"
        )
    return Ground(
        tool=tool,
        part=sliced,
        sections=_sections(settings, sliced, tool),
        region_mm=region,
        overhang_mm=overhang,
        stock_mm=stock,
        floor_mm=float(box[0, 2]) if settings.floor_z_mm is None else settings.floor_z_mm,
        safe_mm=safe,
    )


def _sections(settings: PathSettings, part: SlicedPart, tool: ToolShape) -> Sections:
    """Sections across the rows, or levels; more of them where the part runs along them, unless that changes nothing."""
    axis = ACROSS[settings.direction] if settings.strategy == "scan" else 2
    level = settings.strategy == "contour" and tool.corner_mm + settings.allowance_mm == 0.0
    return part.sections(axis) if settings.exact or level else with_steep_sections(part, axis)


def _check_tool(settings: PathSettings, tool: ToolShape) -> None:
    """Refuses a taper tool for rows from slices, and steps that leave walls between passes.

    Raises:
        ToolPathError: one of these: a step-over above the diameter, layers that clear an area farther apart than the
            radius.
    """
    if settings.strategy == "scan" and tool.taper_rad > 0.0 and not settings.exact:
        raise ToolPathError(
            f"tool = '{settings.tool}': rows from slices are for ball, flat and bull-nose tools; expected one of "
            "these, or exact = true (--exact)"
        )
    diameter, radial = 2.0 * tool.nominal_radius_mm, settings.radial_depth_mm or 0.0
    if settings.strategy == "scan" and settings.stepover_mm > diameter:
        raise ToolPathError(f"stepover_mm = {settings.stepover_mm:g}: expected at most {diameter:g}, the diameter")
    most = 0.5 * diameter if settings.layers == 0 else diameter
    if settings.strategy == "contour" and radial > most:
        why = "the radius, for layers that clear an area" if settings.layers == 0 else "the diameter"
        raise ToolPathError(f"radial_depth_mm = {radial:g}: expected at most {most:g}, {why}")


def plan(settings: PathSettings, ground: Ground, report: Report = _quiet) -> ToolPath:
    """The tool path; one without moves where the tool can cut nothing."""
    passes, way = (_scan if settings.strategy == "scan" else _contour)(settings, ground, report)
    report("linking", 1.0)
    moves = link(passes, _link_options(settings, ground), way)
    made = ToolPath(moves=moves, tool=ground.tool, name=_name(settings), notes=_notes(settings, ground))
    return _fitted(made, settings)


def _scan(settings: PathSettings, ground: Ground, report: Report) -> tuple[tuple[Pass, ...], LinkPlanner]:
    """Rows of all layers, from the outermost to the part's own."""
    along, across = (0, 1) if settings.direction == "x" else (1, 0)
    low, high = ground.region_mm + ground.overhang_mm * np.array([[-1.0], [1.0]])
    at = row_positions(float(low[across]), float(high[across]), settings.stepover_mm)
    report("profiles", 0.0)
    apart = max(settings.pitch_mm, _PLACES_APART * ground.tool.corner_mm)
    places = Samples.between(float(low[along]), float(high[along]), apart)
    way = SurfaceLinkPlanner(
        lambda: _surface(ground.part.mesh),
        ground.tool,
        allowance_mm=settings.allowance_mm,
        remaining_mm=settings.remaining_mm,
        floor_mm=ground.floor_mm,
        top_mm=float(ground.stock_mm[1, 2]),
    )
    lines_of = _rows(settings, ground, way, at, places)
    passes: list[Pass] = []
    for layer in reversed(range(settings.layers)):
        report("rows", 1.0 - (layer + 1) / settings.layers)
        left = settings.allowance_mm + layer * settings.axial_depth_mm
        rows = Rows(direction=settings.direction, at_mm=at, lines_mm=lines_of(left))
        options = ScanOptions(
            top_mm=float(ground.stock_mm[1, 2]) + _AIR_MM,
            zigzag=settings.zigzag,
            climb=settings.climb,
            layer=layer,
            approach_mm=_approach(ground, along, float(low[along]), float(high[along]), settings.clearance_mm),
        )
        passes += scan_passes(rows, options)
    if settings.remaining_mm is not None and settings.layers == 1:
        passes = [replace(p, top_mm=way.clear_z_mm(p.points_mm[0], p.points_mm[0])) for p in passes]
    return tuple(passes), way


def _rows(
    settings: PathSettings, ground: Ground, way: SurfaceLinkPlanner, at: FloatArray, places: Samples
) -> Callable[[float], list[FloatArray]]:
    """Makes the rows' lines from the material to be left: from slices, or from the triangles themselves."""
    chord = max(_CHORD_MM, _CHORD_ALLOWANCE * settings.allowance_mm)
    if settings.exact:
        along = 0 if settings.direction == "x" else 1
        return lambda left: drop_lines(
            lambda xy: way.lowest_mm(xy, left), along, at, places, floor_mm=ground.floor_mm + left, chord_mm=chord
        )
    profiles = Profiles.of(ground.sections)
    element = StructuringElement.tool(ground.tool)
    return lambda left: cl_lines(
        profiles, element, at, places, ground.floor_mm + left, allowance_mm=left, chord_mm=chord
    )


def _surface(mesh: Solid) -> Surface:
    """The part's surface; vertices that only triangles without area had are left out."""
    used = mesh.used
    return surface_of_mesh(mesh.vertices_mm[used], (np.cumsum(used) - 1)[mesh.triangles])


def _approach(
    ground: Ground, along: int, low: float, high: float, clearance_mm: float
) -> tuple[float | None, float | None]:
    """Where the tool is clear of the stock beside the ends of rows; None where rows end inside the stock."""
    reach = ground.tool.max_radius_mm + clearance_mm
    first, last = ground.stock_mm[:, along]
    return (
        float(min(low, first - reach)) if low <= first + _SHORT else None,
        float(max(high, last + reach)) if high >= last - _SHORT else None,
    )


def _contour(settings: PathSettings, ground: Ground, report: Report) -> tuple[tuple[Pass, ...], LinkPlanner]:
    top = float(ground.stock_mm[1, 2])
    heights = level_heights(ground.floor_mm + settings.allowance_mm, top, settings.axial_depth_mm)
    element = StructuringElement.tool(ground.tool).with_allowance(settings.allowance_mm)
    at = heights[::-1] + _LIFT_MM
    regions = _inflated(settings, _sections_with(ground, at), element, at, report)[::-1]
    levels = levels_of(heights, regions)
    chord = _CHORD_PITCHES * settings.pitch_mm
    window = grown(box_area(*ground.region_mm), ground.overhang_mm, chord)
    stock = grown(box_area(*ground.stock_mm[:, :2]), ground.tool.max_radius_mm - 3.0 * _SHORT, chord)
    options = ContourOptions(
        window=window,
        stock=stock,
        top_mm=top,
        layers=settings.layers or None,
        radial_depth_mm=settings.radial_depth_mm or 0.8 * ground.tool.nominal_radius_mm,
        climb=settings.climb,
        chord_mm=chord,
    )
    return contour_passes(levels, options), OutlineLinkPlanner(levels, window, top)


def _sections_with(ground: Ground, at: FloatArray) -> Sections:
    """The part's level sections, and those at the levels themselves: a flat bottom meets nothing lower."""
    return ground.sections.joined(cut_sections(ground.part.mesh, 2, at))


def _inflated(
    settings: PathSettings, sections: Sections, element: StructuringElement, at: FloatArray, report: Report
) -> Sequence[Region]:
    """Sections of the inflated part on planes, some at a time."""
    chord = _CHORD_PITCHES * settings.pitch_mm
    made: list[Region] = []
    for first in range(0, len(at), _PLANES_TOGETHER):
        report("inflating", first / len(at))
        made += inflated_planes(sections, element, at[first : first + _PLANES_TOGETHER], chord_mm=chord)
    return made


def _link_options(settings: PathSettings, ground: Ground) -> LinkOptions:
    radius = ground.tool.nominal_radius_mm
    step = settings.stepover_mm if settings.strategy == "scan" else (settings.radial_depth_mm or 0.8 * radius)
    return LinkOptions(
        safe_z_mm=ground.safe_mm,
        clearance_mm=settings.clearance_mm,
        feed_mm_min=settings.feed_mm_min,
        plunge_mm_min=settings.plunge_mm_min,
        link_mm_min=settings.link_mm_min,
        lead_mm_min=settings.lead_mm_min,
        stay_down_mm=3.0 * step if settings.stay_down_mm is None else settings.stay_down_mm,
        low_links=settings.low_links,
        entry=settings.entry,
        ramp_deg=settings.ramp_deg,
        helix_mm=settings.helix_mm or 0.8 * radius,
        lead_mm=settings.lead_mm,
    )


def _fitted(path: ToolPath, settings: PathSettings) -> ToolPath:
    """Needless points left out, arcs fitted."""
    side: Side = "below" if settings.strategy == "scan" else "right" if settings.climb else "left"
    tolerance = settings.arcs_mm or settings.thin_mm
    if tolerance == 0.0:
        return path
    options = FitOptions(
        tolerance_mm=tolerance,
        gouge_mm=min(settings.gouge_mm, tolerance),
        material=side,
        arcs=settings.arcs_mm is not None,
    )
    return fit_path(path, options)


def _name(settings: PathSettings) -> str:
    step = (
        f"step-over {settings.stepover_mm:g}" if settings.strategy == "scan" else f"levels {settings.axial_depth_mm:g}"
    )
    return f"{settings.strategy} {step} mm, allowance {settings.allowance_mm:g} mm"


def _notes(settings: PathSettings, ground: Ground) -> tuple[str, ...]:
    """Every setting that is not at its default, for the program's header."""
    return tuple(_said(settings, ground))


def _said(settings: PathSettings, ground: Ground) -> Iterator[str]:
    yield f"part {Path(ground.part.mesh.name).name}, {describe(ground.tool)}"
    for key, value in settings.model_dump(exclude_defaults=True).items():
        if key not in ("strategy", "tool"):
            yield f"{key} {' '.join(f'{v:g}' for v in value) if isinstance(value, tuple) else value}"
