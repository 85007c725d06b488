"""Tools of a job made ready: their bodies, cutting edges and force models."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal, TypeAlias

import numpy as np

from twin.arrays import FloatArray, frozen
from twin.cutting.coefficients import CuttingCoefficients
from twin.cutting.engagement import Engager
from twin.cutting.forces import ForceModel
from twin.job import Cutting, Simulation, Tool
from twin.motion.sweep import Body
from twin.record import ToolRecord
from twin.tolerance import Tolerance
from twin.tools.edges import cutting_edges
from twin.tools.shape import ToolShape, tool_shape

#: Length of a shank that the job does not give, mm.
_ENDLESS_MM = 10_000.0
#: Name, diameter and length of a cylinder of a tool, mm.
_Piece: TypeAlias = tuple[Literal["shank", "holder"], float, float]


@dataclass(frozen=True, slots=True, eq=False)
class ToolSetup:
    """One tool, ready to cut.

    Attributes:
        cutter: the circumscribed cutting part, the body that removes material.
        guard: the cutting part less the clearance, which must meet no material where the tool must not cut.
        rigid: bodies that must not touch the stock, less the clearance, with their names.
        shank_assumed: whether the job gives neither shank nor holder, so that the largest diameter of the cutting part
            is taken to go on above the flutes.
        engager: finds the engaged part of its edges.
        forces: its force model, None where the job gives no coefficients.
        record: the tool for viewers and archives.
    """

    number: int
    description: str
    cutter: Body
    guard: Body
    rigid: tuple[tuple[Literal["shank", "holder"], Body], ...]
    shank_assumed: bool
    engager: Engager
    forces: ForceModel | None
    teeth: int
    record: ToolRecord


def tool_setup(tool: Tool, cutting: Cutting | None, fineness: Simulation, tolerance: Tolerance) -> ToolSetup:
    """Build a tool's bodies, edges and force model.

    Args:
        cutting: its coefficients, None for a replay without its forces.
        fineness: steps along the edges and of the spindle angle, and the rule of engagement.

    Raises:
        ToolError: a shape that cannot be built.
    """
    rows = round(360.0 / fineness.angle_step_deg)
    shape = tool_shape(
        tool.kind, tool.diameter_mm, tool.flute_length_mm, tool.corner_radius_mm or 0.0, tool.taper_deg or 0.0
    )
    edges = cutting_edges(
        shape,
        teeth=tool.teeth,
        helix_deg=tool.helix_deg,
        axial_step_mm=fineness.axial_step_mm,
        pitch_deg=tuple(tool.pitch_deg) if tool.pitch_deg else None,
        runout_mm=tool.runout_mm,
        runout_angle_deg=tool.runout_angle_deg,
    )
    cutter = Body.of(shape, chord_mm=tolerance.chord_mm)
    profile_mm = frozen(_profile(tool, shape), "profile_mm", (None, 2))
    return ToolSetup(
        number=tool.number,
        description=describe(tool),
        cutter=cutter,
        guard=_guard(shape, cutter, tolerance),
        rigid=_rigid_bodies(_pieces(tool) or _assumed_shank(shape), shape, tolerance),
        shank_assumed=not _pieces(tool),
        engager=Engager(shape, edges, rows, fineness.engagement, tolerance),
        forces=ForceModel(edges, _coefficients(cutting), rows, tolerance) if cutting else None,
        teeth=tool.teeth,
        record=ToolRecord(number=tool.number, description=describe(tool), profile_mm=profile_mm),
    )


def describe(tool: Tool) -> str:
    """A tool in a few words, e.g. ``bull D16 rc3 z2``."""
    corner = f" rc{tool.corner_radius_mm:g}" if tool.corner_radius_mm else ""
    taper = f" {tool.taper_deg:g}deg" if tool.taper_deg else ""
    return f"{tool.kind} D{tool.diameter_mm:g}{corner}{taper} z{tool.teeth}"


def _coefficients(c: Cutting) -> CuttingCoefficients:
    return CuttingCoefficients(
        Ktc=c.Ktc,
        Kte=c.Kte,
        Krc=c.Krc,
        Kre=c.Kre,
        Kac=c.Kac,
        Kae=c.Kae,
        mt=c.mt or 0.0,
        mr=c.mr or 0.0,
        ma=c.ma or 0.0,
        source=c.source or "not stated",
        convention=c.convention,
    )


def _pieces(tool: Tool) -> list[_Piece]:
    """Shank and holder as (name, diameter, length), upwards from the flutes."""
    pieces: list[_Piece] = []
    if tool.shank is not None:
        pieces.append(("shank", tool.shank.diameter_mm, tool.shank.length_mm))
    pieces.extend(("holder", h.diameter_mm, h.length_mm) for h in tool.holder or ())
    return pieces


def _guard(shape: ToolShape, cutter: Body, tolerance: Tolerance) -> Body:
    """The cutting part less the clearance; all of it where the tool is smaller than that."""
    inner = shape.inscribed(tolerance.clearance_mm)
    return cutter if inner is None else Body.of(inner, above_tip_mm=tolerance.clearance_mm)


def _assumed_shank(shape: ToolShape) -> list[_Piece]:
    return [("shank", 2.0 * shape.max_radius_mm, _ENDLESS_MM)]


def _rigid_bodies(
    pieces: Sequence[_Piece], shape: ToolShape, tolerance: Tolerance
) -> tuple[tuple[Literal["shank", "holder"], Body], ...]:
    bodies = []
    bottom = shape.height_mm
    for name, diameter, length in pieces:
        radius = 0.5 * diameter - tolerance.clearance_mm
        if radius > 0.0:
            cylinder = ToolShape(disc_mm=radius, corner_radius_mm=0.0, height_mm=length)
            bodies.append((name, Body.of(cylinder, above_tip_mm=bottom + tolerance.clearance_mm)))
        bottom += length
    return tuple(bodies)


def _profile(tool: Tool, shape: ToolShape) -> FloatArray:
    points = list(shape.profile_mm())
    z = shape.height_mm
    for _, diameter, length in _pieces(tool):
        points += [np.array([0.5 * diameter, z]), np.array([0.5 * diameter, z + length])]
        z += length
    points.append(np.array([0.0, z]))
    return np.array(points)
