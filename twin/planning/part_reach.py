"""Reach of tools on a part: the material that each one leaves uncut, and the largest ball that finishes the part."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from types import MappingProxyType
from typing import Any

from twin.cam.reach.largest_ball import largest_ball_mm
from twin.cam.reach.tool_reach import Reach, thin_bound_mm, tool_reach
from twin.cam.reach.uncut_mesh import uncut_mesh
from twin.cam.slices.sections import SlicedPart, slice_part
from twin.cam.slices.structuring_element import StructuringElement
from twin.errors import MeshError, ToolError
from twin.planning.output_files import refuse_existing
from twin.planning.paths import Progress, silent
from twin.planning.settings import ReachSettings
from twin.settings.check import changed
from twin.tools.shape import ToolShape
from twin.tools.text import parse_tool
from twin.workpiece.solids.from_mesh import load_mesh
from twin.workpiece.solids.mesh_file import write_mesh
from twin.workpiece.solids.units import TOOL_DIAMETERS, TYPICAL_MM, size_doubts

#: The default pitch divides the part's longest side into this many slices.
_SLICES_ALONG = 600
#: Slices across the largest tool where the part is smaller than it, and the most there may be.
_SLICES_ACROSS, _MOST_SLICES_ACROSS = 500, 8000


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class PartReach:
    """Uncut material on a part.

    Attributes:
        settings: the parameters.
        part: the sliced part.
        tools: uncut material by tool, in the order of the settings.
        largest_ball_mm: diameter of the largest ball that finishes the part; None if there is none, or none was
            requested.
    """

    settings: ReachSettings
    part: SlicedPart
    tools: Mapping[str, Reach]
    largest_ball_mm: float | None

    @property
    def warnings(self) -> tuple[str, ...]:
        """Warnings: doubts about the unit, and tools where material as thin as requested cannot be resolved."""
        thin, mesh = self.settings.thin_mm, self.part.mesh
        smallest = min((2.0 * parse_tool(text).nominal_radius_mm for text in self.settings.tools), default=None)
        doubts = (*mesh.notes, *size_doubts(mesh.name, mesh.box_mm, tool_mm=smallest))
        return doubts + tuple(
            f"{text}: slices {found.pitch_mm:.4g} mm apart may show uncut material up to {bound:.3g} mm thick where "
            f"there is none; for {thin:g} mm expected a pitch of at most {thin:.3g} mm"
            for text, found in self.tools.items()
            if thin is not None and thin < (bound := thin_bound_mm(found.element, found.pitch_mm))
        )

    def write_meshes(self, folder: Path | str, *, force: bool = False) -> list[Path]:
        """Write the uncut material of each tool as an STL file; no file for a tool that leaves none.

        Args:
            folder: created if it is missing.
            force: replace files that exist.

        Raises:
            MeshError, ToolPathError: a file exists already, or cannot be written.
        """
        files = mesh_files(Path(folder), self.settings, force=force)
        Path(folder).mkdir(parents=True, exist_ok=True)
        written = []
        for text, file in files.items():
            if self.tools[text].uncut_regions:
                write_mesh(file, uncut_mesh(self.tools[text].uncut_regions), force=force)
                written.append(file)
        return written


def mesh_files(folder: Path, settings: ReachSettings, *, force: bool) -> dict[str, Path]:
    """Names of the STL files by tool, checked before long work.

    Raises:
        MeshError: the folder is a file.
        ToolPathError: a file exists already.
    """
    if folder.exists() and not folder.is_dir():
        raise MeshError(f"{folder}: is a file; expected a folder for meshes")
    files = {text: folder / f"{tool_name(text)}.stl" for text in settings.tools}
    refuse_existing(files.values(), force=force)
    return files


def tool_name(text: str) -> str:
    """A tool's text as a part of file names: ``ball_2p5`` for ``ball 2.5``."""
    return "_".join(text.split()).replace(".", "p")


def reach(
    part: Path | str,
    settings: ReachSettings | None = None,
    *,
    threads: int | None = None,
    progress: Progress = silent,
    **values: Any,
) -> PartReach:
    """Find the material that tools leave uncut on a part: position, volume, thickness.

    Args:
        part: STL file of the part, a closed solid in mm.
        settings: parameters; only those of ``values`` if not given.
        threads: number of threads, None for all cores; results do not depend on it.
        progress: called with the current task and its share that is done, 0 to 1.
        values: parameters by the names of `ReachSettings`, before those of ``settings``.

    Raises:
        SettingsError: wrong parameters; the message has every mistake.
        MeshError, StockError: the mesh is not a closed solid, or an impossible pitch.
        ToolError: no tool, an invalid tool text, or a taper tool.

    Example:
        >>> reach("part.stl", tools=["ball 8", "ball 6"]).tools["ball 8"].volume_mm3
    """
    settings = changed(ReachSettings, settings, values, "reach")
    shapes = {text: parse_tool(text) for text in settings.tools}
    if not shapes and not settings.largest:
        raise ToolError('no tool; expected --tool "ball 8", or --largest')
    progress("slicing", 0.0)
    diameters = [2.0 * shape.nominal_radius_mm for shape in shapes.values()]
    mesh = load_mesh(part, unit=settings.unit, like_mm=TOOL_DIAMETERS * max(diameters) if diameters else TYPICAL_MM)
    longest = float((mesh.vertices_mm.max(axis=0) - mesh.vertices_mm.min(axis=0)).max())
    sliced = slice_part(mesh, slice_pitch_mm(settings, longest, max(diameters, default=0.0)))
    tools: dict[str, Reach] = {}
    tasks = len(shapes) + settings.largest
    for text, shape in shapes.items():
        progress(text, len(tools) / tasks)
        element = _element(shape, settings)
        tools[text] = tool_reach(sliced, element, thin_mm=settings.thin_mm, threads=threads)
    progress("largest ball", len(tools) / tasks)
    radius = largest_ball_mm(sliced, thin_mm=settings.thin_mm, threads=threads) if settings.largest else None
    diameter = None if radius is None else 2.0 * radius
    return PartReach(settings=settings, part=sliced, tools=MappingProxyType(tools), largest_ball_mm=diameter)


def slice_pitch_mm(settings: ReachSettings, longest_mm: float, diameter_mm: float) -> float:
    """The pitch of a part with this longest side; the largest tool spans a bounded number of slices.

    Raises:
        ToolError: a given pitch is too small for the tool.
    """
    if settings.pitch_mm is None:
        return max(longest_mm / _SLICES_ALONG, diameter_mm / _SLICES_ACROSS)
    if settings.pitch_mm * _MOST_SLICES_ACROSS < diameter_mm:
        least = diameter_mm / _MOST_SLICES_ACROSS
        raise ToolError(
            f"pitch_mm = {settings.pitch_mm:g}: expected at least {least:.3g} for a tool of {diameter_mm:g} mm"
        )
    return settings.pitch_mm


def _element(shape: ToolShape, settings: ReachSettings) -> StructuringElement:
    """A ball about its centre, which may come from any side, or a tool about its tip, from above."""
    any_side = shape.disc_mm == 0.0 and shape.taper_rad == 0.0 and not settings.above
    return StructuringElement.ball(shape.corner_radius_mm) if any_side else StructuringElement.tool(shape)
