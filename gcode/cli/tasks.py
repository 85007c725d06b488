"""The work of ``gcode check``, ``stats`` and ``motions``; this module needs no command-line library."""

from __future__ import annotations

import sys
from collections.abc import Iterable
from pathlib import Path
from typing import TYPE_CHECKING

from gcode.cli import exit_codes
from gcode.cli.setup import Setup

if TYPE_CHECKING:
    from gcode.cli.commands.findings import Findings


def print_motions(file: Path, setup: Setup) -> None:
    """Prints every motion and dwell of a program as one JSON object per line."""
    from gcode.flow.interpreter import run
    from gcode.report.batch_lines import motion_lines

    events = run(file, dialect=setup.dialect, settings=setup.settings)
    for text in motion_lines(events, setup.settings.start_mm):
        sys.stdout.write(text)


def print_stats(file: Path, setup: Setup, rapid_mm_min: float, *, as_json: bool) -> None:
    """Prints statistics of a program, as tables or as a JSON object."""
    from gcode.cli.console import results, say_json, with_progress
    from gcode.flow.interpreter import run
    from gcode.report.stats import program_stats

    events = run(file, dialect=setup.dialect, settings=setup.settings)
    found = program_stats(with_progress(events, file.name), rapid_mm_min)
    if as_json:
        import json

        from gcode.report.stats_json import stats_object

        say_json(json.dumps({"file": str(file), **stats_object(found)}, indent=2))
    else:
        from gcode.cli.commands.stats_tables import print_stats as print_tables

        print_tables(results(), file.name, found)


def print_findings(files: Iterable[Path], setup: Setup, *, as_json: bool, notices: bool) -> int:
    """Checks programs and prints what is found.

    Returns:
        The exit code: that of an error where any program has one or cannot be read.
    """
    from gcode.cli.commands.findings import findings
    from gcode.cli.console import fail

    codes = {exit_codes.OK}
    for file in files:
        found = findings(file, setup)
        if found.unreadable is not None:
            fail(str(found.unreadable))
            codes.add(exit_codes.ERROR)
            continue
        (_print_json if as_json else _print_text)(found, notices)
        codes.add(exit_codes.ERROR if found.errors else exit_codes.OK)
    return max(codes)


def _print_text(found: Findings, notices: bool) -> None:
    from gcode.cli.console import say
    from gcode.cli.number_format import plural

    for error in found.errors:
        say(f"{error.underlined()}\n")
    for group in found.grouped(notices=notices):
        say(group)
    count = plural(len(found.errors), "error")
    warnings = len(found.warnings)
    kinds = ((warnings, "warning"), (len(found.notices) - warnings, "notice"))
    more = "".join(f", {plural(number, kind)}" for number, kind in kinds if number)
    say(f"{found.file}: {count}{more}", colour="red" if found.errors else "green")


def _print_json(found: Findings, notices: bool) -> None:
    import json

    from gcode.cli.console import say_json

    for made in found.objects(notices=notices):
        say_json(json.dumps(made))
