"""A planned tool path with everything needed to write its NC program and the job file that replays it."""

from __future__ import annotations

import time
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from types import MappingProxyType
from typing import Any

from gcode.report.plot import plot_path
from twin.cam.path.to_nc import NcOptions, Operation, describe, nc_events, write_nc
from twin.cam.path.toolpath import ToolPath
from twin.cam.slices.sections import SlicedPart
from twin.errors import ToolPathError
from twin.planning.accuracy import pitch_bound_mm
from twin.planning.gouges import Gouge, deepest_gouge
from twin.planning.output_files import check_outputs
from twin.planning.paths import PlanSetup, Progress, plan, prepare, silent
from twin.planning.replay_job import replay_tables, write_replay_job
from twin.planning.settings import PathSettings
from twin.settings.check import changed
from twin.workpiece.solids.units import size_doubts

#: Rapid traverse rate for the machining time, mm/min.
RAPID_MM_MIN = 10_000.0


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class PlannedPath:
    """A tool path and what it was made from.

    Attributes:
        settings: its parameters.
        setup: part, tool and stock.
        path: the moves of the tool tip; none where the tool cannot cut anything.
        pitch_bound_mm: bound on the error between the part's slices, see `twin.planning.accuracy`.
        gouge: the deepest gouge of the path on the part's triangles, None where none is deeper than the tolerance.
        computed_s: computing time.
    """

    settings: PathSettings
    setup: PlanSetup
    path: ToolPath
    pitch_bound_mm: float
    gouge: Gouge | None
    computed_s: float

    @property
    def machine_time_s(self) -> float:
        """Time at the programmed feeds, with rapids at 10 m/min and without acceleration."""
        return self.path.duration_s(RAPID_MM_MIN)

    @property
    def warnings(self) -> tuple[str, ...]:
        """Warnings: doubts about the unit, gouges of the path, slices that may be too far apart for the accuracy."""
        return tuple(self._warnings())

    def _warnings(self) -> Iterator[str]:
        settings, found, mesh = self.settings, self.gouge, self.setup.part.mesh
        yield from mesh.notes
        yield from size_doubts(mesh.name, mesh.box_mm, tool_mm=2.0 * self.setup.tool.nominal_radius_mm)
        other = "; --exact makes rows from the triangles instead" if settings.strategy == "scan" else ""
        if found is not None:
            x, y, z = found.point_mm
            yield (
                f"the path gouges the part by {found.depth_mm:.3g} mm at X{x:.3f} Y{y:.3f} Z{z:.3f}, more than "
                f"tolerance_mm = {settings.tolerance_mm:g}: a smaller pitch_mm is needed than {settings.pitch_mm:g}"
                f"{other if not settings.exact else ''}"
            )
        if self.pitch_bound_mm > settings.tolerance_mm:
            yield (
                f"pitch_mm = {settings.pitch_mm:g} may be too coarse: details between slices are accurate to "
                f"{self.pitch_bound_mm:.3g} mm, more than tolerance_mm = {settings.tolerance_mm:g}{other}"
            )

    @property
    def operation(self) -> Operation:
        """The path with tool number, spindle speed and coolant, as a program needs them."""
        return Operation(
            path=self.path,
            number=self.settings.tool_number,
            spindle_rpm=self.settings.spindle_rpm,
            coolant=self.settings.coolant,
            teeth=self.settings.teeth,
        )

    @property
    def nc_options(self) -> NcOptions:
        """Control, decimal places and program number of the NC program."""
        settings = self.settings
        return NcOptions(dialect=settings.dialect, decimals=settings.decimals, program_number=settings.program_number)

    def write(self, out: Path | str, job_file: Path | str | None = None, *, force: bool = False) -> int:
        """Write the NC program and the job file that replays it.

        Args:
            out: the NC program.
            job_file: the job file; the program's name with the suffix ``.toml`` if not given.
            force: replace files that exist.

        Returns:
            Number of lines of the program.

        Raises:
            ToolPathError: the path is empty, a file exists already, or a file cannot be written.
        """
        return write_paths([self], out, job_file, force=force)

    def plot(self, file: Path | str) -> None:
        """Draw the path as .png, .svg or .pdf."""
        plot_path(nc_events([self.operation], self.nc_options), Path(file), title=self.path.name)


def plan_paths(
    part: Path | str | SlicedPart,
    settings: PathSettings | None = None,
    *,
    progress: Progress = silent,
    **values: Any,
) -> PlannedPath:
    """Plan a tool path on a part.

    Args:
        part: STL file of the part, a closed solid in mm, or its slices.
        settings: parameters; only those of ``values`` if not given.
        progress: called with the current task and its share that is done, 0 to 1.
        values: parameters by the names of `PathSettings`, before those of ``settings``.

    Returns:
        The path; `PlannedPath.write` writes program and job file.

    Raises:
        SettingsError: wrong parameters; the message has every mistake.
        MeshError, StockError, ToolError: the mesh is not a closed solid, an impossible pitch, an invalid tool text.
        ToolPathError: a stepover or depth too large for the tool, or a safe height below the stock's top.

    Example:
        >>> plan_paths("part.stl", strategy="scan", tool="ball 8", stepover_mm=0.25).write("part.nc")
    """
    settings = changed(PathSettings, settings, values, "plan_paths")
    begin = time.perf_counter()
    setup = prepare(settings, part, progress)
    path = plan(settings, setup, progress)
    progress("checking", 1.0)
    gouge = deepest_gouge(path, setup.surface, settings.allowance_mm, settings.tolerance_mm)
    return PlannedPath(
        settings=settings,
        setup=setup,
        path=path,
        pitch_bound_mm=pitch_bound_mm(settings, setup),
        gouge=gouge,
        computed_s=time.perf_counter() - begin,
    )


def write_paths(
    paths: Sequence[PlannedPath],
    out: Path | str,
    job_file: Path | str | None = None,
    *,
    header: Sequence[str] = (),
    tables: Mapping[str, Mapping[str, Any]] = MappingProxyType({}),
    force: bool = False,
) -> int:
    """Write the NC program of one or several paths, in order, and the job file that replays it.

    Args:
        paths: planned on the same part; control and stock are those of the last one.
        out: the NC program.
        job_file: the job file; the program's name with the suffix ``.toml`` if not given.
        header: comments at the beginning of the program.
        tables: further keys of the job file, or other values, by table, e.g. ``{"cutting": {...}}``.
        force: replace files that exist.

    Returns:
        Number of lines of the program.

    Raises:
        ToolPathError: a path is empty, a file exists already, or a file cannot be written.

    Example:
        >>> rough = plan_paths("part.stl", strategy="scan", tool="ball 8", layers=5, allowance_mm=0.1)
        >>> finish = plan_paths(rough.setup.part, strategy="scan", tool="ball 8", stepover_mm=0.25)
        >>> write_paths([rough, finish], "part.nc", tables={"simulation": {"angle_step_deg": 5.0}})
    """
    out, last = Path(out), paths[-1]
    job = out.with_suffix(".toml") if job_file is None else Path(job_file)
    for made in paths:
        if made.path.empty:
            raise ToolPathError(
                f"{out}: no file is written, as {describe(made.path.tool)} cannot cut anything of this stock: no "
                "pocket is wide enough, or all of it lies above the stock or outside the region"
            )
    check_outputs({"program": out, "job": job}, force=force)
    operations, options = [made.operation for made in paths], replace(last.nc_options, header=tuple(header))
    lines = write_nc(out, operations, options)
    folder = job.absolute().parent
    keys = replay_tables(out, operations, options, last.setup.stock_mm, last.settings.pitch_mm, folder)
    for name, table in tables.items():
        keys[name] = {**keys.get(name, {}), **table}
    write_replay_job(job, keys, f"Replays {out.name}: {', then '.join(made.path.name for made in paths)}")
    return lines
