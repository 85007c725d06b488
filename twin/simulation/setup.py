"""What a job sets up before the first motion: stock, tools with their bodies and force models, the machine."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np

from gcode.settings import MachineSettings, ToolOffset
from twin.arrays import FloatArray, frozen
from twin.cutting.coefficients import CuttingCoefficients
from twin.cutting.engagement import Engager
from twin.cutting.forces import ForceModel
from twin.errors import JobError, ToolError
from twin.job import Cutting, Job, Tool
from twin.motion.sweep import Body
from twin.record import ToolRecord
from twin.tolerance import Tolerance
from twin.tools.edges import cutting_edges
from twin.tools.shape import ToolShape, tool_shape
from twin.workpiece.from_mesh import load_mesh, mesh_slices
from twin.workpiece.stock import SliceSet, box_slices, cylinder_slices
from twin.workpiece.trislice import CellSlices, PolygonSlices, TriSlices

#: How far above the highest point of stock and longest tool the gauge point's reference position is, mm.
HOME_CLEARANCE_MM = 100.0


@dataclass(frozen=True, slots=True, eq=False)
class ToolSetup:
    """One tool, ready to cut.

    Attributes:
        cutter: the circumscribed cutting part, the body that removes material.
        rigid: bodies that must not touch the stock, with their names.
        forces: None where the job gives no coefficients.
    """

    number: int
    description: str
    cutter: Body
    rigid: tuple[tuple[Literal["shank", "holder"], Body], ...]
    engager: Engager
    forces: ForceModel | None
    teeth: int
    record: ToolRecord


def tool_setup(job: Job, tool: Tool, tolerance: Tolerance) -> ToolSetup:
    """Build a tool's bodies, edges and force model.

    Raises:
        JobError: a shape that cannot be, naming the tool.
    """
    rows = round(360.0 / job.simulation.angle_step_deg)
    try:
        shape = tool_shape(
            tool.kind, tool.diameter_mm, tool.flute_length_mm, tool.corner_radius_mm or 0.0, tool.taper_deg or 0.0
        )
        edges = cutting_edges(
            shape,
            teeth=tool.teeth,
            helix_deg=tool.helix_deg,
            axial_step_mm=job.simulation.axial_step_mm,
            pitch_deg=tuple(tool.pitch_deg) if tool.pitch_deg else None,
            runout_mm=tool.runout_mm,
            runout_angle_deg=tool.runout_angle_deg,
        )
    except ToolError as error:
        raise JobError(str(job.path), [f"tools number {tool.number}: {error}"]) from error
    coefficients = job.coefficients(tool)
    return ToolSetup(
        number=tool.number,
        description=describe(tool),
        cutter=Body.of(shape, chord_mm=tolerance.chord_mm),
        rigid=_rigid_bodies(tool, shape, tolerance),
        engager=Engager(shape, edges, rows, job.simulation.engagement, tolerance),
        forces=ForceModel(edges, _coefficients(coefficients), rows, tolerance) if coefficients else None,
        teeth=tool.teeth,
        record=ToolRecord(
            number=tool.number, description=describe(tool), profile_mm=frozen(_profile(tool, shape), "", (None, 2))
        ),
    )


def describe(tool: Tool) -> str:
    """A tool in a few words, e.g. ``bull D16 rc3 z2``."""
    corner = f" rc{tool.corner_radius_mm:g}" if tool.corner_radius_mm else ""
    taper = f" {tool.taper_deg:g}deg" if tool.taper_deg else ""
    return f"{tool.kind} D{tool.diameter_mm:g}{corner}{taper} z{tool.teeth}"


def _coefficients(c: Cutting) -> CuttingCoefficients:
    return CuttingCoefficients(
        Ktc=c.Ktc, Kte=c.Kte, Krc=c.Krc, Kre=c.Kre, Kac=c.Kac, Kae=c.Kae, source=c.source, convention=c.convention
    )


def _pieces(tool: Tool) -> list[tuple[Literal["shank", "holder"], float, float]]:
    """Shank and holder as (name, diameter, length), upwards from the flutes."""
    pieces: list[tuple[Literal["shank", "holder"], float, float]] = []
    if tool.shank is not None:
        pieces.append(("shank", tool.shank.diameter_mm, tool.shank.length_mm))
    pieces.extend(("holder", h.diameter_mm, h.length_mm) for h in tool.holder or ())
    return pieces


def _rigid_bodies(
    tool: Tool, shape: ToolShape, tolerance: Tolerance
) -> tuple[tuple[Literal["shank", "holder"], Body], ...]:
    bodies = []
    bottom = shape.height_mm
    for name, diameter, length in _pieces(tool):
        radius = 0.5 * diameter - tolerance.clearance_mm
        if radius > 0.0:
            cylinder = ToolShape(disc_mm=radius, corner_mm=0.0, height_mm=length)
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


def stock_slices(job: Job) -> SliceSet:
    """Slice the job's stock in three directions."""
    stock, pitch = job.stock, job.simulation.slice_pitch_mm
    if stock.box_mm is not None:
        return box_slices(np.array(stock.box_mm.min), np.array(stock.box_mm.max), pitch)
    if stock.cylinder_mm is not None:
        c = stock.cylinder_mm
        return cylinder_slices(
            centre_mm=c.centre, diameter_mm=c.diameter, axis=c.axis, low_mm=c.min, high_mm=c.max, pitch_mm=pitch
        )
    assert stock.stl is not None
    return mesh_slices(load_mesh(stock.stl, scale=stock.stl_scale, offset_mm=stock.offset_mm), pitch)


def workpiece(job: Job, slices: SliceSet) -> TriSlices:
    """The store of slices that the job asks for."""
    return PolygonSlices(slices) if job.simulation.store == "reference" else CellSlices(slices)


def machine_settings(job: Job, slices: SliceSet) -> MachineSettings:
    """The machine as the interpreter needs it.

    Without a home position in the job it is over the middle of the stock, above it and the longest tool.
    """
    machine = job.machine
    tools = {t.number: ToolOffset(length_mm=t.length_mm, radius_mm=t.diameter_mm / 2.0) for t in job.tools}
    origin = np.array(machine.offsets[job.stock.wcs])
    middle = origin + 0.5 * (slices.low_mm + slices.high_mm)
    top = (
        float(origin[2] + slices.high_mm[2])
        + max((tool.length_mm for tool in tools.values()), default=0.0)
        + HOME_CLEARANCE_MM
    )
    home = machine.home_mm or (float(middle[0]), float(middle[1]), top)
    return MachineSettings(
        offsets={str(name): place for name, place in machine.offsets.items()},
        home_mm=home,
        start_mm=machine.start_mm or home,
        tools=tools,
        tool=job.program.tool,
        arc_centres=job.program.arc_centres,
        block_delete=job.program.block_delete,
        units=job.program.units,
        search_path=tuple(job.program.search_path),
        decimal_point=job.program.decimal_point,
        compensation_startup=job.program.compensation_startup,
    )
