"""``twin replay``."""

from __future__ import annotations

from collections.abc import Mapping
from enum import StrEnum
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from twin.cli import exit_codes

if TYPE_CHECKING:
    from twin.cli.commands.replay_work import Outcome
    from twin.job import Job


class Engine(StrEnum):
    """Geometry engines."""

    FAST = "fast"
    REFERENCE = "reference"


class Dialect(StrEnum):
    """Controls that a program is written for."""

    FANUC = "fanuc"
    HAAS = "haas"
    LINUXCNC = "linuxcnc"
    GRBL = "grbl"
    AUTO = "auto"


def replay(
    job_file: Annotated[Path, typer.Argument(metavar="JOB", help="Job file (TOML).", show_default=False)],
    view: Annotated[bool, typer.Option("--view", help="Show the run in rerun while it is computed.")] = False,
    rrd: Annotated[
        Path | None,
        typer.Option(
            metavar="FILE", help="Rerun recording to write; the job's output.rrd if not given.", show_default=False
        ),
    ] = None,
    mcap: Annotated[
        Path | None,
        typer.Option(
            metavar="FILE", help="Archive (MCAP) to write; the job's output.mcap if not given.", show_default=False
        ),
    ] = None,
    force: Annotated[
        bool, typer.Option("--force", help="Replace output files that were not made from this job file.")
    ] = False,
    strict: Annotated[
        bool,
        typer.Option(
            "--strict",
            help="Stop at the first collision, with exit code 3; implausible numbers are errors, exit code 1.",
        ),
    ] = False,
    as_json: Annotated[bool, typer.Option("--json", help="Print the summary as one JSON object.")] = False,
    quiet: Annotated[
        bool, typer.Option("--quiet", "-q", help="Print no progress and no summary, only warnings and errors.")
    ] = False,
    no_forces: Annotated[
        bool, typer.Option("--no-forces", help="Compute no forces, even if the job has cutting coefficients.")
    ] = False,
    material: Annotated[
        str | None,
        typer.Option(
            metavar="NAME",
            help="Material whose cutting coefficients all tools use, in place of the job's; see twin materials.",
            show_default=False,
        ),
    ] = None,
    engine: Annotated[
        Engine | None,
        typer.Option(help="Geometry engine: fast, or the slow reference; the job's if not given.", show_default=False),
    ] = None,
    dialect: Annotated[
        Dialect | None,
        typer.Option(
            help="Control that the program is written for; auto takes the likeliest; the job's if not given.",
            show_default=False,
        ),
    ] = None,
    tool: Annotated[
        int | None,
        typer.Option(
            metavar="N",
            min=0,
            help="Tool in the spindle when the program starts; the job's if not given.",
            show_default=False,
        ),
    ] = None,
    m_code: Annotated[
        list[int] | None,
        typer.Option(
            metavar="N",
            min=0,
            help="Number of an M code of the machine builder that moves nothing; may be repeated.",
            show_default=False,
        ),
    ] = None,
    threads: Annotated[
        int | None, typer.Option(min=1, max=64, help="Number of threads; all cores if not given.", show_default=False)
    ] = None,
) -> None:
    """Replay the NC program of a job: remove material, compute cutting forces, archive the run.

    Missing folders of outputs are created; outputs that were made from the same job file are replaced. Ctrl-C stops the
    replay; its outputs are complete up to there. A second Ctrl-C discards them. A replay that ends with an error leaves
    no outputs.
    """
    from twin.cli.commands.replay_work import replay_job
    from twin.cli.show.progress import progress
    from twin.job import load_job
    from twin.sinks.outputs import opened

    job = load_job(job_file)
    job = job if material is None else _with_material(job, material, quiet=quiet)
    job = job.without_forces() if no_forces else job
    job = job.with_simulation(store=engine.value) if engine is not None else job
    job = job.with_program(**_program_values(dialect, tool, m_code, job.program.m_codes))
    mcap, rrd = mcap or job.output.mcap, rrd or job.output.rrd
    with opened(mcap, rrd, view=view, force=force, job=job.path) as write, progress(quiet=quiet or as_json) as line:
        outcome = replay_job(job, line, write, strict=strict, threads=threads)
    if as_json:
        _print_json(outcome, {"job": job_file, "mcap": mcap, "rrd": rrd}, job.output.force_on)
    elif not quiet:
        _print_summary(outcome, {"archive": mcap, "recording": rrd}, job.output.force_on)
    _print_warnings(outcome, strict=strict)
    raise typer.Exit(_exit_code(outcome, strict=strict))


def _with_material(job: Job, name: str, *, quiet: bool) -> Job:
    """The job with a material's coefficients, and a note where they replace others."""
    changed = job.with_material(name)
    if job.forces and not quiet:
        from twin.cli.console import note

        material = changed.cutting.material if changed.cutting is not None else name
        note(f"--material: the coefficients of {material} replace those of the job")
    return changed


def _program_values(
    dialect: Dialect | None, tool: int | None, m_code: list[int] | None, known: Mapping[int, str]
) -> dict[str, Any]:
    """Values of the job's ``[program]`` table that options replace."""
    values: dict[str, Any] = {"m_codes": {**known, **dict.fromkeys(m_code, "none")}} if m_code else {}
    if dialect is not None:
        values["dialect"] = dialect.value
    if tool is not None:
        values["tool"] = tool
    return values


def _print_json(outcome: Outcome, files: dict[str, Path | None], force_on: str) -> None:
    from twin.cli.console import print_json
    from twin.cli.show.as_json import replay_object

    names = {key: None if path is None else str(path) for key, path in files.items()}
    print_json(replay_object(outcome, force_on) | names)


def _print_summary(outcome: Outcome, files: dict[str, Path | None], force_on: str) -> None:
    from twin.cli.console import results
    from twin.cli.show.summary import Timing, print_summary

    watch = outcome.watch
    timing = Timing(setup_s=outcome.setup_time_s, wall_s=outcome.wall_time_s)
    console = results()
    print_summary(console, outcome.summary, watch.header, watch.groups, force_on=force_on, timing=timing)
    for what, path in files.items():
        if path is not None:
            console.print(f"{what.capitalize():<10} {path}", markup=False, soft_wrap=True)


def _print_warnings(outcome: Outcome, *, strict: bool) -> None:
    from twin.cli.console import fail, warn

    if outcome.refused is not None:
        fail(f"stopped at a collision (--strict): {outcome.refused.message}")
        return
    errors = outcome.watch.doubts(outcome.summary) if strict else []
    for message in outcome.watch.warnings(outcome.summary):
        (fail if message in errors else warn)(message)
    if outcome.signal_number is not None:
        warn(f"stopped at {outcome.summary.machine_time_s:.1f} s of machine time; outputs have the run up to there")


def _exit_code(outcome: Outcome, *, strict: bool) -> int:
    if outcome.refused is not None:
        return exit_codes.COLLISION
    if outcome.signal_number is not None:
        return exit_codes.SIGNAL + outcome.signal_number
    return exit_codes.ERROR if strict and outcome.watch.doubts(outcome.summary) else exit_codes.OK
