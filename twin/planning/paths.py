"""Flow B on one page: part -> slices -> inflated sections -> passes -> links -> arcs -> tool path.

part = prepare(settings, "part.stl")
path = plan(settings, part)
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path
from typing import TypeAlias

import numpy as np

from twin.arrays import FloatArray
from twin.cam.passes.clear_moves import ClearOptions, part_obstacle, with_clear_moves
from twin.cam.passes.contour import ContourOptions, OutlineLinkPlanner, contour_passes, level_heights, levels_of
from twin.cam.passes.scan import ACROSS, Rows, ScanOptions, row_positions, scan_passes
from twin.cam.path.arc_fit import FitOptions, Side, fit_path
from twin.cam.path.linking import LinkOptions, LinkPlanner, Pass, link
from twin.cam.path.surface_link_planner import SurfaceLinkPlanner
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
from twin.errors import StockError, ToolPathError
from twin.geometry.polygons.outline import box_area, grown
from twin.geometry.polygons.region import Region
from twin.planning.settings import PathSettings
from twin.tools.shape import ToolShape
from twin.tools.text import parse_tool
from twin.workpiece.solids.from_mesh import Solid, load_mesh
from twin.workpiece.solids.units import TOOL_DIAMETERS, size_doubts

#: Called while work goes on: the current task, and the share of it that is done, 0 to 1.
Progress: TypeAlias = Callable[[str, float], None]
#: Chord error of inflated sections, as a part of the pitch; chords lie inside their arcs.
_CHORD_PITCHES = 0.005
#: Chord error of rows: at most this, mm, or this part of the allowance, whichever is larger.
_CHORD_MM, _CHORD_ALLOWANCE = 0.0005, 0.05
#: Most points of all rows of a scan, and most levels, or layers of a level, of contours.
_MOST_POINTS, _MOST_LEVELS = 1e8, 1e4
#: Rows start with points a slice pitch apart, but no closer than this part of the ball's or corner's radius: the tool's
#: own rounding hides finer detail, and points are added where the chord error is too large.
_POINTS_APART = 0.0125
#: Planes that are inflated between two progress calls.
_PLANES_TOGETHER = 32
#: The default overhang of contours is the tool's radius less this, mm, and a few chords: flush sides of the stock are
#: not machined.
_SHORT_MM = 1e-3
#: Sections are taken this much above each level, so that the tool may stand on a flat face at the level itself.
_LIFT_MM = 1e-6
#: Where the tip is more than this above the stock it is in air, and rows are interrupted there.
_AIR_MM = 0.01
#: Default height of rapids above the stock.
SAFE_ABOVE_MM = 5.0


@dataclass(frozen=True, kw_only=True, eq=False)
class PlanSetup:
    """A part made ready for planning.

    Attributes:
        tool: the tool's shape.
        part: the sliced part.
        sections: the sections that the path is made from, closer together where the part is steep along them.
        region_mm: boundary of the tool tip, lower and upper corner, shape (2, 2).
        overhang_mm: how far the tip may go beyond the boundary.
        stock_mm: the stock's box, lower and upper corner, shape (2, 3).
        floor_mm: lowest height of the tip.
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

    @cached_property
    def surface(self) -> Surface:
        """The part's surface, without vertices that only triangles without area used."""
        mesh = self.part.mesh
        used = mesh.used
        return surface_of_mesh(mesh.vertices_mm[used], (np.cumsum(used) - 1)[mesh.triangles])


def silent(task: str, share: float) -> None:
    """No progress display."""


def prepare(settings: PathSettings, part: Path | str | SlicedPart, progress: Progress = silent) -> PlanSetup:
    """Read and slice the part, and determine everything that depends on its box.

    Raises:
        MeshError, StockError, ToolError: the mesh is not a closed solid, an impossible pitch, an invalid tool text.
        ToolPathError: a stepover or depth too large for the tool, or a safe height below the stock's top.
    """
    tool = parse_tool(settings.tool)
    _check_tool(settings, tool)
    progress("slicing", 0.0)
    sliced = part if isinstance(part, SlicedPart) else _sliced(_mesh(settings, part, tool), settings.pitch_mm, tool)
    box = np.array([sliced.slices.low_mm, sliced.slices.high_mm])
    stock = np.reshape(settings.stock_mm, (2, 3)) if settings.stock_mm else box
    scan = settings.strategy == "scan"
    region = np.reshape(settings.region_mm, (2, 2)) if settings.region_mm else (box if scan else stock)[:, :2]
    default = 0.0 if scan else tool.max_radius_mm - _SHORT_MM - 4.0 * _CHORD_PITCHES * settings.pitch_mm
    overhang = default if settings.overhang_mm is None else settings.overhang_mm
    top = float(stock[1, 2])
    safe = top + max(SAFE_ABOVE_MM, settings.clearance_mm) if settings.safe_z_mm is None else settings.safe_z_mm
    if safe < top + settings.clearance_mm:
        raise ToolPathError(
            f"safe_z_mm = {safe:g}: expected at least {top + settings.clearance_mm:g}, stock top plus clearance"
        )
    made = PlanSetup(
        tool=tool,
        part=sliced,
        sections=_sections(settings, sliced, tool),
        region_mm=region,
        overhang_mm=overhang,
        stock_mm=stock,
        floor_mm=float(box[0, 2]) if settings.floor_z_mm is None else settings.floor_z_mm,
        safe_mm=safe,
    )
    _check_size(settings, made)
    return made


def _check_size(settings: PathSettings, setup: PlanSetup) -> None:
    """Refuses paths of more points or levels than fit in memory."""
    width, length = np.ptp(setup.region_mm, axis=0) + 2.0 * setup.overhang_mm
    step = max(settings.pitch_mm, _POINTS_APART * setup.tool.corner_radius_mm)
    if settings.strategy == "scan":
        points = settings.layers * width * length / (settings.stepover_mm * step)
        if points > _MOST_POINTS:
            raise ToolPathError(
                f"{settings.layers} x {width:g} x {length:g} mm at stepover_mm = {settings.stepover_mm:g} and pitch_mm "
                f"= {settings.pitch_mm:g} make {points:.3g} points of rows; expected at most {_MOST_POINTS:g}"
            )
        return
    levels = (float(setup.stock_mm[1, 2]) - setup.floor_mm) / settings.axial_depth_mm
    if max(levels, settings.layers) > _MOST_LEVELS:
        raise ToolPathError(
            f"axial_depth_mm = {settings.axial_depth_mm:g} and layers = {settings.layers} make {levels:.3g} levels of "
            f"{settings.layers} layers; expected at most {_MOST_LEVELS:g} of either"
        )


def _sliced(mesh: Solid, pitch_mm: float, tool: ToolShape) -> SlicedPart:
    """The part's slices; where they do not fit in memory, the message has the doubts about the part's unit."""
    try:
        return slice_part(mesh, pitch_mm)
    except StockError as error:
        doubts = size_doubts(mesh.name, mesh.box_mm, tool_mm=2.0 * tool.nominal_radius_mm)
        raise StockError("; ".join((str(error), *doubts))) from error


def _mesh(settings: PathSettings, part: Path | str, tool: ToolShape) -> Solid:
    """The part from its file; unit auto is the one in which it is most like the stock, or a typical part."""
    like = TOOL_DIAMETERS * 2.0 * tool.nominal_radius_mm
    if settings.stock_mm is not None:
        like = float(np.ptp(np.reshape(settings.stock_mm, (2, 3)), axis=0).max())
    return load_mesh(part, unit=settings.unit, like_mm=like)


def _sections(settings: PathSettings, part: SlicedPart, tool: ToolShape) -> Sections:
    """Sections across the rows, or level sections; closer together where the part is steep along them."""
    axis = ACROSS[settings.direction] if settings.strategy == "scan" else 2
    level = settings.strategy == "contour" and tool.corner_radius_mm + settings.allowance_mm == 0.0
    return part.sections(axis) if settings.exact or level else with_steep_sections(part, axis)


def _check_tool(settings: PathSettings, tool: ToolShape) -> None:
    """Refuse a taper tool for rows from slices, and steps that leave ridges between passes.

    Raises:
        ToolPathError: one of these: a stepover above the diameter, a radial depth above the radius where an area is
            cleared, a tolerance above the radius.
    """
    if settings.strategy == "scan" and tool.taper_rad > 0.0 and not settings.exact:
        raise ToolPathError(
            f"tool = '{settings.tool}': rows from slices are for ball, flat and bull-nose tools; expected one of "
            "these, or exact = true (--exact)"
        )
    diameter, radial = 2.0 * tool.nominal_radius_mm, settings.radial_depth_mm or 0.0
    if settings.tolerance_mm > 0.5 * diameter:
        raise ToolPathError(
            f"tolerance_mm = {settings.tolerance_mm:g}: expected at most {0.5 * diameter:g}, the radius"
        )
    if settings.strategy == "scan" and settings.stepover_mm > diameter:
        raise ToolPathError(f"stepover_mm = {settings.stepover_mm:g}: expected at most {diameter:g}, the diameter")
    most = 0.5 * diameter if settings.layers == 0 else diameter
    if settings.strategy == "contour" and radial > most:
        why = "the radius, for layers that clear an area" if settings.layers == 0 else "the diameter"
        raise ToolPathError(f"radial_depth_mm = {radial:g}: expected at most {most:g}, {why}")


def plan(settings: PathSettings, setup: PlanSetup, progress: Progress = silent) -> ToolPath:
    """The tool path; without moves where the tool cannot cut anything."""
    passes, planner = (_scan if settings.strategy == "scan" else _contour)(settings, setup, progress)
    progress("linking", 1.0)
    moves = link(passes, _link_options(settings, setup), planner)
    made = ToolPath(moves=moves, tool=setup.tool, name=_name(settings), notes=_notes(settings, setup))
    return _cleared(_fitted(made, settings), settings, setup)


def _cleared(path: ToolPath, settings: PathSettings, setup: PlanSetup) -> ToolPath:
    """The path with rapids above the part and its allowance, and links no deeper in it than the tolerance."""
    clear = ClearOptions(
        safe_z_mm=setup.safe_mm,
        clearance_mm=settings.clearance_mm,
        feed_mm_min=settings.link_mm_min or settings.feed_mm_min,
    )
    part, links = (
        part_obstacle(setup.surface, setup.tool, left)
        for left in (settings.allowance_mm, settings.allowance_mm - settings.tolerance_mm)
    )
    return with_clear_moves(path, clear, part, links=links)


def _scan(settings: PathSettings, setup: PlanSetup, progress: Progress) -> tuple[tuple[Pass, ...], LinkPlanner]:
    """Rows of all layers, from the outermost to the one on the part."""
    along, across = (0, 1) if settings.direction == "x" else (1, 0)
    low, high = setup.region_mm + setup.overhang_mm * np.array([[-1.0], [1.0]])
    at = row_positions(float(low[across]), float(high[across]), settings.stepover_mm)
    progress("profiles", 0.0)
    apart = max(settings.pitch_mm, _POINTS_APART * setup.tool.corner_radius_mm)
    samples = Samples.between(float(low[along]), float(high[along]), apart)
    planner = SurfaceLinkPlanner(
        lambda: setup.surface,
        setup.tool,
        allowance_mm=settings.allowance_mm,
        remaining_mm=settings.remaining_mm,
        floor_mm=setup.floor_mm,
        top_mm=float(setup.stock_mm[1, 2]),
    )
    lines_of = _rows(settings, setup, planner, at, samples)
    passes: list[Pass] = []
    for layer in reversed(range(settings.layers)):
        progress("rows", 1.0 - (layer + 1) / settings.layers)
        left = settings.allowance_mm + layer * settings.axial_depth_mm
        rows = Rows(direction=settings.direction, at_mm=at, lines_mm=lines_of(left))
        options = ScanOptions(
            top_mm=float(setup.stock_mm[1, 2]) + _AIR_MM,
            zigzag=settings.zigzag,
            climb=settings.climb,
            layer=layer,
            approach_mm=_approach(setup, along, float(low[along]), float(high[along]), settings.clearance_mm),
        )
        passes += scan_passes(rows, options)
    if settings.remaining_mm is not None and settings.layers == 1:
        passes = [replace(p, top_mm=planner.clear_z_mm(p.points_mm[0], p.points_mm[0])) for p in passes]
    return tuple(passes), planner


def _rows(
    settings: PathSettings, setup: PlanSetup, planner: SurfaceLinkPlanner, at: FloatArray, samples: Samples
) -> Callable[[float], list[FloatArray]]:
    """A function that makes cutter-location lines for an allowance, from slices or from the triangles."""
    chord = max(_CHORD_MM, _CHORD_ALLOWANCE * settings.allowance_mm)
    if settings.exact:
        along = 0 if settings.direction == "x" else 1
        return lambda left: drop_lines(
            lambda xy: planner.lowest_mm(xy, left), along, at, samples, floor_mm=setup.floor_mm + left, chord_mm=chord
        )
    profiles = Profiles.of(setup.sections)
    element = StructuringElement.tool(setup.tool)
    return lambda left: cl_lines(
        profiles, element, at, samples, setup.floor_mm + left, allowance_mm=left, chord_mm=chord
    )


def _approach(
    setup: PlanSetup, along: int, low: float, high: float, clearance_mm: float
) -> tuple[float | None, float | None]:
    """Positions clear of the stock at both ends of the rows; None where rows end inside the stock."""
    reach = setup.tool.max_radius_mm + clearance_mm
    first, last = setup.stock_mm[:, along]
    return (
        float(min(low, first - reach)) if low <= first + _SHORT_MM else None,
        float(max(high, last + reach)) if high >= last - _SHORT_MM else None,
    )


def _contour(settings: PathSettings, setup: PlanSetup, progress: Progress) -> tuple[tuple[Pass, ...], LinkPlanner]:
    top = float(setup.stock_mm[1, 2])
    heights = level_heights(setup.floor_mm + settings.allowance_mm, top, settings.axial_depth_mm)
    element = StructuringElement.tool(setup.tool).with_allowance(settings.allowance_mm)
    at = heights[::-1] + _LIFT_MM
    regions = _inflated(settings, _sections_with(setup, at), element, at, progress)[::-1]
    levels = levels_of(heights, regions)
    chord = _CHORD_PITCHES * settings.pitch_mm
    window = grown(box_area(*setup.region_mm), setup.overhang_mm, chord)
    stock = grown(box_area(*setup.stock_mm[:, :2]), setup.tool.max_radius_mm - 3.0 * _SHORT_MM, chord)
    options = ContourOptions(
        window=window,
        stock=stock,
        top_mm=top,
        layers=settings.layers or None,
        radial_depth_mm=settings.radial_depth_mm or 0.8 * setup.tool.nominal_radius_mm,
        climb=settings.climb,
        chord_mm=chord,
    )
    return contour_passes(levels, options), OutlineLinkPlanner(levels, window, top)


def _sections_with(setup: PlanSetup, at: FloatArray) -> Sections:
    """The part's level sections and those at the levels themselves, as the flat of a tool touches nothing lower."""
    return setup.sections.joined(cut_sections(setup.part.mesh, 2, at))


def _inflated(
    settings: PathSettings, sections: Sections, element: StructuringElement, at: FloatArray, progress: Progress
) -> Sequence[Region]:
    """Sections of the inflated part on planes, a few at a time."""
    chord = _CHORD_PITCHES * settings.pitch_mm
    made: list[Region] = []
    for first in range(0, len(at), _PLANES_TOGETHER):
        progress("inflating", first / len(at))
        made += inflated_planes(sections, element, at[first : first + _PLANES_TOGETHER], chord_mm=chord)
    return made


def _link_options(settings: PathSettings, setup: PlanSetup) -> LinkOptions:
    radius = setup.tool.nominal_radius_mm
    step = settings.stepover_mm if settings.strategy == "scan" else (settings.radial_depth_mm or 0.8 * radius)
    return LinkOptions(
        safe_z_mm=setup.safe_mm,
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
    """The path with superfluous points removed and arcs fitted."""
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


def _notes(settings: PathSettings, setup: PlanSetup) -> tuple[str, ...]:
    """Part, tool and every setting that is not at its default, for the program's header."""
    notes = [f"part {Path(setup.part.mesh.name).name}, {describe(setup.tool)}"]
    for key, value in settings.model_dump(exclude_defaults=True).items():
        if key not in ("strategy", "tool"):
            notes.append(f"{key} {' '.join(f'{v:g}' for v in value) if isinstance(value, tuple) else value}")
    return tuple(notes)
