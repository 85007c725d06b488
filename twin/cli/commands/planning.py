"""A tool path planned, written and told about, as `twin paths` needs it."""

from __future__ import annotations

import time
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from twin.cam.path.to_nc import NcOptions, Operation, describe, nc_events, write_nc
from twin.cam.path.toolpath import MoveKind, ToolPath
from twin.cli.console import results, warn
from twin.cli.show.progress import working
from twin.cli.show.words import clock, grouped, plural
from twin.errors import ToolPathError
from twin.planning.accuracy import pitch_bound_mm
from twin.planning.paths import PlanSetup, plan, prepare
from twin.planning.replay_job import replay_tables, write_replay_job
from twin.planning.settings import PathSettings, read_settings, settings_of

#: Speed of rapids that times are told for, mm/min.
RAPID_MM_MIN = 10_000.0


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Planned:
    """A path and what it was made from.

    Attributes:
        wall_time_s: the computer's time.
    """

    settings: PathSettings
    setup: PlanSetup
    path: ToolPath
    wall_time_s: float


def check_outputs(files: Mapping[str, Path | None], *, force: bool) -> None:
    """Refuse before the work what cannot be written after it.

    Raises:
        ToolPathError: a file that is there, a missing folder, a wrong suffix.
    """
    from gcode.report.plot import PlotError, check_picture

    for what, path in files.items():
        if path is None:
            continue
        if not path.absolute().parent.is_dir():
            raise ToolPathError(f"{path}: there is no folder {path.parent}; expected one that exists")
        if path.exists() and not force:
            raise ToolPathError(f"{path}: is there already; expected a new name, or leave to replace it (--force)")
        if what == "recording" and path.suffix.lower() != ".rrd":
            raise ToolPathError(f"{path}: expected a file name that ends in .rrd")
        if what == "picture":
            try:
                check_picture(path)
            except PlotError as error:
                raise ToolPathError(str(error)) from None
    if len({p for p in files.values() if p is not None}) < sum(p is not None for p in files.values()):
        raise ToolPathError("two outputs have one name; expected a name for each (--out, --job-file)")


def planned(
    strategy: str, part: Path, settings_file: Path | None, values: Mapping[str, Any], *, quiet: bool
) -> Planned:
    """Plan a path.

    Args:
        values: settings that go before those of the file.

    Raises:
        TwinError: any mistake in settings or part.
    """
    own = read_settings(settings_file) if settings_file is not None else {}
    source = str(settings_file) if settings_file is not None else "settings"
    settings = settings_of({**own, **values, "strategy": strategy}, source)
    begin = time.perf_counter()
    with working(quiet=quiet) as report:
        setup = prepare(settings, part, report)
        path = plan(settings, setup, report)
    bound = pitch_bound_mm(settings, setup)
    if bound > settings.tolerance_mm:
        warn(
            f"pitch_mm = {settings.pitch_mm:g} may be too coarse: details between slices are known to {bound:.3g} mm, "
            f"more than tolerance_mm = {settings.tolerance_mm:g}"
            + ("; --exact makes rows from the triangles instead" if strategy == "scan" else "")
        )
    return Planned(settings=settings, setup=setup, path=path, wall_time_s=time.perf_counter() - begin)


def finish(made: Planned, files: Mapping[str, Path | None], *, force: bool, as_json: bool, quiet: bool) -> None:
    """Write everything and say what was made.

    Raises:
        ToolPathError: an empty path, or a file that cannot be written.
    """
    settings, path, out = made.settings, made.path, files["program"]
    assert out is not None
    if path.empty:
        raise ToolPathError(
            f"{out}: no file is written, for {describe(path.tool)} can cut nothing of this stock: no pocket is wide "
            "enough, or all of it lies above the stock or outside of the region"
        )
    operation = Operation(
        path=path,
        number=settings.tool_number,
        spindle_rpm=settings.spindle_rpm,
        coolant=settings.coolant,
        teeth=settings.teeth,
    )
    options = NcOptions(dialect=settings.dialect, decimals=settings.decimals, program_number=settings.program_number)
    lines = write_nc(out, [operation], options)
    job = files["job"]
    assert job is not None
    tables = replay_tables(out, [operation], options, made.setup.stock_mm, settings.pitch_mm, job.absolute().parent)
    write_replay_job(job, tables, f"Replays {out.name}: {path.name}")
    _draw(made, operation, options, files, force=force)
    _say(made, lines, files, as_json=as_json, quiet=quiet)


def _draw(
    made: Planned, operation: Operation, options: NcOptions, files: Mapping[str, Path | None], *, force: bool
) -> None:
    if files["picture"] is not None:
        from gcode.report.plot import plot_path

        plot_path(nc_events([operation], options), files["picture"], title=made.path.name)
    if files["recording"] is not None:
        from twin.cli.show.stills import paths_still
        from twin.sinks.rerun.still import write_still

        mesh = made.setup.part.mesh
        write_still(files["recording"], paths_still({"path": made.path}, mesh), force=force)


def _say(made: Planned, lines: int, files: Mapping[str, Path | None], *, as_json: bool, quiet: bool) -> None:
    lengths = {kind.value: length for kind, length in made.path.lengths_mm().items()}
    time_s = made.path.duration_s(RAPID_MM_MIN)
    if as_json:
        import json

        names = {what: None if path is None else str(path) for what, path in files.items()}
        arcs = sum(m.arc is not None for m in made.path.moves)
        told = {
            "lengths_mm": lengths,
            "machine_time_s": time_s,
            "points": made.path.points,
            "arcs": arcs,
            "lines": lines,
            "wall_time_s": made.wall_time_s,
            **names,
        }
        print(json.dumps(told, indent=2))
    elif not quiet:
        console = results()
        console.print(f"{made.path.name}, {describe(made.path.tool)}", markup=False)
        order = [k.value for k in MoveKind if k.value in lengths]
        console.print("  ".join(f"{k} {grouped(lengths[k])} mm" for k in order), markup=False, soft_wrap=True)
        console.print(f"{clock(time_s)} at the programmed feeds, {plural(lines, 'line')}", markup=False)
        for what, path in files.items():
            if path is not None:
                console.print(f"{what.capitalize():<10} {path}", markup=False, soft_wrap=True)
