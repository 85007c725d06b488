"""A job made ready for its replay: program read and checked, stock sliced, tools built."""

from __future__ import annotations

import os
from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np

from twin.errors import JobError, ToolError
from twin.job import Job, Stock
from twin.record import RunHeader
from twin.simulation.contacts import StartCheck
from twin.simulation.header import run_header
from twin.simulation.material import Material
from twin.simulation.preview import Preview
from twin.simulation.program import ProgramMoves, program_moves
from twin.simulation.recorder import Recorder
from twin.simulation.solve import StepSolver
from twin.simulation.tools import ToolSetup, tool_setup
from twin.tolerance import Tolerance
from twin.workpiece.solids.from_mesh import Solid, load_mesh, mesh_slices
from twin.workpiece.stock import SliceSet, box_slices, cylinder_slices
from twin.workpiece.trislice import CellSlices, PolygonSlices

#: Threads that work on slices and steps.
THREADS = min(8, os.cpu_count() or 1)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Setup:
    """Everything that the replay of a job's motions needs.

    Attributes:
        program: name of the NC program, for messages.
        header: first record of the run.
        moves: the program's motions and its other events, in order.
        tools: by number.
        material: the workpiece, and the sweeps that are still to be subtracted from it.
        solver: engagement and forces of steps.
        recorder: machine time, spindle angle, sums, and the records that they make.
        preview: draws the workpiece's surface while it is machined, None for a replay without.
        starts: refuses tools that begin inside the stock.
        step_mm: longest step of a feed motion in the material.
        air_chord_mm: distance of chords from arcs where there is nothing to cut.
        tolerance: of geometry and physics.
    """

    program: str
    header: RunHeader
    moves: ProgramMoves
    tools: Mapping[int, ToolSetup]
    material: Material
    solver: StepSolver
    recorder: Recorder
    preview: Preview | None
    starts: StartCheck
    step_mm: float
    air_chord_mm: float
    tolerance: Tolerance

    def close(self) -> None:
        """End the worker threads."""
        self.material.close()
        self.solver.close()


def prepare(
    job: Job, *, threads: int | None = None, preview: bool = True, report: Callable[[str], None] = lambda _task: None
) -> Setup:
    """Read and check the whole program, slice the stock, build the tools; nothing is cut yet.

    Args:
        threads: how many work on slices and steps, None for all cores; results do not depend on it.
        preview: whether the workpiece's surface is among the records; the others do not depend on it.
        report: called with each task as it begins.

    Raises:
        TwinError, gcode.errors.GcodeError: a job, tool, stock or program that cannot be replayed.
    """
    threads = THREADS if threads is None else threads
    fineness = job.simulation
    tolerance = Tolerance.for_pitch(fineness.slice_pitch_mm)
    report("slicing the stock")
    slices = stock_slices(job.stock, fineness.slice_pitch_mm)
    report("building the tools")
    tools = _tools(job, tolerance)
    origin_mm = np.array(job.machine.offsets[job.stock.wcs])
    moves = program_moves(job.program, job.machine, job.tools, origin_mm, slices)
    report(f"reading {job.program.file.name}")
    plan = moves.checked(job.machine.tool_change_s, float(slices.high_mm[2]))
    report("storing the slices")
    workpiece = PolygonSlices(slices) if fineness.store == "reference" else CellSlices(slices)
    return Setup(
        program=str(job.program.file),
        header=run_header(job, workpiece, [t.record for t in tools.values()], plan, slices.notes),
        moves=moves,
        tools=tools,
        material=Material(workpiece, tolerance, threads),
        solver=StepSolver(workpiece, threads),
        recorder=Recorder(
            tools,
            samples_per_revolution=round(360.0 / fineness.angle_step_deg),
            tool_change_s=job.machine.tool_change_s,
            program=str(job.program.file),
        ),
        preview=Preview(workpiece, tools, plan.time_s, fineness.preview_pitch_mm) if preview else None,
        starts=StartCheck(str(job.program.file)),
        step_mm=fineness.step_mm,
        air_chord_mm=0.5 * fineness.slice_pitch_mm,
        tolerance=tolerance,
    )


def _tools(job: Job, tolerance: Tolerance) -> dict[int, ToolSetup]:
    """Every tool of a job, by number."""
    tools = {}
    for tool in job.tools:
        try:
            tools[tool.number] = tool_setup(tool, job.coefficients(tool), job.simulation, tolerance)
        except ToolError as error:
            raise JobError(str(job.path), [f"tools number {tool.number}: {error}"]) from error
    return tools


def stock_slices(stock: Stock, pitch_mm: float) -> SliceSet:
    """Slice a stock in three directions."""
    if stock.box_mm is not None:
        return box_slices(np.array(stock.box_mm.min), np.array(stock.box_mm.max), pitch_mm)
    if stock.cylinder_mm is not None:
        c = stock.cylinder_mm
        return cylinder_slices(
            centre_mm=c.centre, diameter_mm=c.diameter, axis=c.axis, low_mm=c.min, high_mm=c.max, pitch_mm=pitch_mm
        )
    return mesh_slices(_stock_mesh(stock), pitch_mm)


def stock_length_mm(stock: Stock) -> float:
    """Longest side of a stock's box."""
    if stock.box_mm is not None:
        return float(np.ptp(np.array([stock.box_mm.min, stock.box_mm.max]), axis=0).max())
    if stock.cylinder_mm is not None:
        return max(stock.cylinder_mm.diameter, stock.cylinder_mm.max - stock.cylinder_mm.min)
    return float(np.ptp(_stock_mesh(stock).box_mm, axis=0).max())


def _stock_mesh(stock: Stock) -> Solid:
    assert stock.stl is not None
    return load_mesh(stock.stl, unit=stock.unit, scale=stock.stl_scale, offset_mm=stock.offset_mm)
