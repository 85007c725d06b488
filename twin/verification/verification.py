"""A job's machined part compared with its design."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

from twin.job import Job, load_job
from twin.record import Collision
from twin.settings.check import changed
from twin.simulation.setup import stock_length_mm
from twin.verification.deviation import Deviation, Limits, deviation
from twin.verification.machining import At, Begin, machined
from twin.verification.settings import VerifySettings
from twin.workpiece.solids.from_mesh import Solid, load_mesh
from twin.workpiece.solids.units import size_doubts


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Verification:
    """Result of a verification.

    Attributes:
        settings: tolerances and extent.
        design: the design.
        deviation: deviation of the machined surface, with gouges, excess and regions out of tolerance.
        collisions: collisions of the job's program.
        warnings: doubts about the unit of the design.
    """

    settings: VerifySettings
    design: Solid
    deviation: Deviation
    collisions: tuple[Collision, ...]
    warnings: tuple[str, ...] = ()

    @property
    def within_tolerance(self) -> bool:
        """Whether neither gouges nor excess exceed their tolerance."""
        return self.deviation.gouge_ok and self.deviation.excess_ok


def verify(
    job: Job | Path | str,
    part: Path | str,
    settings: VerifySettings | None = None,
    *,
    begin: Begin = lambda _t: None,
    at: At = lambda _t, _n: None,
    **values: Any,
) -> Verification:
    """Machine a job's program without forces and compare the machined surface with the design.

    Args:
        job: a job, or the path of a job file.
        part: STL file of the design, in the stock's coordinates, mm.
        settings: tolerances; only those of ``values`` if not given.
        begin: called once with the machine time of the whole program, s.
        at: called for every motion with its start time, s, and NC line.
        values: tolerances by the names of `VerifySettings`, before those of ``settings``.

    Raises:
        SettingsError: wrong tolerances; the message has every mistake.
        TwinError, gcode.GcodeError: a job, program or design that cannot be read or replayed.

    Example:
        >>> verify("part.toml", "part.stl", tolerance_mm=0.02).deviation.worst_gouge_mm
    """
    settings = changed(VerifySettings, settings, values, "verify")
    job = job if isinstance(job, Job) else load_job(job)
    design = load_mesh(part, unit=settings.unit, like_mm=stock_length_mm(job.stock) if settings.unit == "auto" else 1.0)
    if settings.pitch_mm is not None:
        job = job.with_simulation(slice_pitch_mm=settings.pitch_mm)
    store, collisions = machined(job, begin=begin, at=at)
    found = deviation(
        store,
        design,
        tolerance_mm=settings.tolerance_mm,
        excess_mm=settings.excess_mm,
        limits=Limits.of(design, settings.region_mm),
    )
    smallest = min(tool.diameter_mm for tool in job.tools)
    length = float((store.high_mm - store.low_mm).max())
    doubts = size_doubts(design.name, design.box_mm, tool_mm=smallest, stock_mm=length)
    return Verification(
        settings=settings,
        design=design,
        deviation=found,
        collisions=collisions,
        warnings=(*design.notes, *doubts),
    )
