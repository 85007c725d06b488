"""Simple command lines carried out without the command-line library, whose start takes longer than a short program.

A command line is simple where it names check, stats or motions, program files, and at most a dialect, ``--json`` and
``--notices``. All others, also those with a mistake, are left to the library.
"""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from gcode.cli import exit_codes

#: Flags of each command.
_FLAGS: Mapping[str, tuple[str, ...]] = {"check": ("--json", "--notices"), "stats": ("--json",), "motions": ()}
_DIALECTS = ("fanuc", "haas", "linuxcnc", "grbl")


@dataclass(frozen=True, slots=True, kw_only=True)
class SimpleCommand:
    """A simple command line.

    Attributes:
        name: of the command.
        files: its programs.
        flags: the flags given.
        dialect: name of the dialect.
    """

    name: str
    files: tuple[Path, ...]
    flags: frozenset[str]
    dialect: str


def simple_command(arguments: Sequence[str]) -> SimpleCommand | None:
    """Reads a command line; None for one that is not simple.

    Args:
        arguments: without the program's name.
    """
    if not arguments or arguments[0] not in _FLAGS or "_GCODE_COMPLETE" in os.environ:
        return None
    name, files, flags, dialect = arguments[0], [], set(), _DIALECTS[0]
    rest = iter(arguments[1:])
    for argument in rest:
        if argument in _FLAGS[name]:
            flags.add(argument)
        elif argument in ("-d", "--dialect"):
            dialect = next(rest, "")
        elif argument.startswith("-") or not argument:
            return None
        else:
            files.append(Path(argument))
    if dialect not in _DIALECTS or not files or (len(files) > 1 and name != "check"):
        return None
    return SimpleCommand(name=name, files=tuple(files), flags=frozenset(flags), dialect=dialect)


def carry_out(command: SimpleCommand) -> int:
    """Carries out a simple command line.

    Returns:
        The exit code.
    """
    from gcode.cli.setup import Setup
    from gcode.cli.tasks import print_findings, print_motions, print_stats
    from gcode.dialects import dialect_named
    from gcode.settings import MachineSettings

    setup = Setup(dialect=dialect_named(command.dialect), settings=MachineSettings())
    as_json = "--json" in command.flags
    if command.name == "check":
        return print_findings(command.files, setup, as_json=as_json, notices="--notices" in command.flags)
    if command.name == "stats":
        from gcode.report.stats import RAPID_MM_MIN

        print_stats(command.files[0], setup, RAPID_MM_MIN, as_json=as_json)
    else:
        print_motions(command.files[0], setup)
    return exit_codes.OK
