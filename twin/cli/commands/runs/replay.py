"""``twin replay``."""

from __future__ import annotations

from collections.abc import Mapping
from enum import StrEnum
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from gcode.cli.machine_options import MCodeOption, ProgramDialect, ToolOption
from twin.cli import exit_codes
from twin.cli.options import options_from
from twin.drafting.settings import DraftSettings

if TYPE_CHECKING:
    from twin.cli.commands.runs.replay_source import Source
    from twin.cli.commands.runs.replay_work import Outcome

#: Keys of a draft that have options of their own, for jobs too.
_OWN_OPTIONS = ("material", "dialect", "tool", "m_codes")


class Engine(StrEnum):
    """Geometry engines."""

    FAST = "fast"
    REFERENCE = "reference"


@options_from(DraftSettings, "drafting", omit=_OWN_OPTIONS, panel="Job of an NC program")
def replay(
    file: Annotated[
        Path,
        typer.Argument(metavar="JOB|PART.nc", help="Job file (TOML), or an NC program alone.", show_default=False),
    ],
    drafting: Mapping[str, Any],
    save_job: Annotated[
        Path | None,
        typer.Option(
            "--save-job",
            metavar="FILE",
            help="Write the job of an NC program to a file, to edit and replay; an existing one keeps its values.",
            show_default=False,
            rich_help_panel="Job of an NC program",
        ),
    ] = None,
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
        ProgramDialect | None,
        typer.Option(
            help="Control that the program is written for; auto takes the likeliest; the job's if not given.",
            show_default=False,
        ),
    ] = None,
    tool: ToolOption = None,
    m_code: MCodeOption = None,
    threads: Annotated[
        int | None, typer.Option(min=1, max=64, help="Number of threads; all cores if not given.", show_default=False)
    ] = None,
) -> None:
    """Replay an NC program, or the job of one: remove material, compute cutting forces, archive the run.

    An NC program without a job file gets one in memory, as twin job drafts it: every assumption is printed, and the
    archive is written to the current folder. Forces need --material.

    Missing folders of outputs are created; outputs that were made from the same job or program are replaced. Ctrl-C
    stops the replay; its outputs are complete up to there. A second Ctrl-C discards them. A replay that ends with an
    error leaves no outputs.
    """
    from twin.cli.commands.runs.replay_source import source_of
    from twin.cli.commands.runs.replay_work import replay_job
    from twin.cli.show.progress import progress
    from twin.sinks.outputs import opened

    own = {"dialect": dialect and dialect.value, "tool": tool, "m_codes": tuple(m_code) if m_code else None}
    options = {"material": material, **own}
    given = {key: value for key, value in options.items() if value is not None}
    source = source_of(file, {**drafting, **given}, save_job, quiet=quiet or as_json)
    job = source.job.without_forces() if no_forces else source.job
    job = job.with_simulation(store=engine.value) if engine is not None else job
    mcap, rrd = mcap or job.output.mcap, rrd or job.output.rrd
    with opened(mcap, rrd, view=view, force=force, job=source.key) as write, progress(quiet=quiet or as_json) as line:
        outcome = replay_job(job, line, write, strict=strict, threads=threads)
    if as_json:
        _print_json(outcome, source, {"mcap": mcap, "rrd": rrd}, job.output.force_on)
    elif not quiet:
        _print_summary(outcome, {"archive": mcap, "recording": rrd}, job.output.force_on)
    _print_warnings(outcome, strict=strict)
    raise typer.Exit(_exit_code(outcome, strict=strict))


def _print_json(outcome: Outcome, source: Source, files: dict[str, Path | None], force_on: str) -> None:
    from twin.cli.console import print_json
    from twin.cli.show.as_json import replay_object

    names = {key: None if path is None else str(path) for key, path in files.items()}
    print_json(replay_object(outcome, force_on) | {"job": str(source.file)} | names | source.assumed)


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
