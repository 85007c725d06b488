"""The commands put together."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from importlib import import_module
from typing import Annotated, Any

import typer

from twin.cli.help import HelpCommand, HelpGroup

#: Options that print help.
_HELP_OPTIONS = ("-h", "--help")
#: The commands by the folder of their modules, and the line of each in the program's help, which is printed without
#: importing them.
_ROOMS: Mapping[str, Mapping[str, str]] = {
    "runs": {
        "replay": "Replay an NC program, or the job of one: remove material, compute cutting forces, archive the run.",
        "job": "Draft a job file from an NC program: tools from its comments, stock from its motions, resolution to "
        "suit them.",
        "view": "Show an archived run, or an archived comparison, in the rerun viewer.",
        "report": "Write a page about a run: summary, forces by tool and line, worst positions, collisions, warnings.",
        "info": "Print the contents of an archive: summary of the run, program, stock, tools, messages, attached "
        "files.",
        "export": "Write every force sample of a run as CSV or Parquet.",
        "mesh": "Write the machined part as a triangle mesh.",
    },
    "logs": {
        "compare": "Compare a measured force log with a run: errors, harmonics, report.",
        "identify": "Find cutting coefficients from test cuts, with their errors.",
    },
    "parts": {
        "reach": "Find the material that tools cannot reach on a part: position, volume, thickness.",
        "paths": "Make an NC program from a part's STL file, and a job file that replays it.",
        "verify": "Replay a job without forces and compare the machined surface with the design: "
        "gouges, excess material, positions.",
        "mold": "Machine a mold from its STL file: roughing, semi-finishing of rest material, finishing; "
        "one program per stage.",
    },
    "tables": {
        "tools": "List, check and convert tool libraries: Fusion 360, FreeCAD, LinuxCNC, Vectric, CAMotics, DIN 4000, "
        "CSV.",
        "materials": "List cutting coefficients of materials with their sources, or print one of them.",
        "schema": "Print the JSON Schema of a job file or settings file, for editors that complete and check TOML.",
    },
}
#: Folder of each command's module.
_ROOM = {name: room for room, commands in _ROOMS.items() for name in commands}
#: The line of each command in the program's help.
COMMANDS: Mapping[str, str] = {name: line for commands in _ROOMS.values() for name, line in commands.items()}


def app_for(arguments: Sequence[str]) -> typer.Typer:
    """The program with what a command line needs: one command, or the lines of all of them for the program's help."""
    first = next(iter(arguments), "")
    if first in COMMANDS:
        return _program([first])
    return _listing() if first in _HELP_OPTIONS else whole_app()


def whole_app() -> typer.Typer:
    """The program with all its commands."""
    app = _program(COMMANDS)
    # the former name of `twin reach`
    app.command("machinable", hidden=True, cls=HelpCommand)(_command("reach"))
    return app


def _program(names: Iterable[str]) -> typer.Typer:
    app = _empty()
    for name in names:
        app.command(cls=HelpCommand)(_command(name))
    return app


def _command(name: str) -> Callable[..., Any]:
    command: Callable[..., Any] = getattr(import_module(f"twin.cli.commands.{_ROOM[name]}.{name}"), name)
    return command


def _listing() -> typer.Typer:
    app = _empty()
    for name, line in COMMANDS.items():
        app.command(name, help=line, cls=HelpCommand)(lambda: None)
    return app


def _empty() -> typer.Typer:
    app = typer.Typer(
        name="twin",
        cls=HelpGroup,
        help="A machining digital twin: replays NC programs, removes material, predicts cutting forces.",
        epilog="Exit codes: 0 done, 1 an error, explained in the message, 2 wrong use of the command line, 3 a "
        "collision under --strict, 4 out of tolerance, 130 Ctrl-C, 141 closed pipe.",
        pretty_exceptions_enable=False,
        context_settings={"help_option_names": list(_HELP_OPTIONS)},
    )
    app.callback()(_options)
    return app


def _print_version(wanted: bool) -> None:
    if wanted:
        import platform
        from importlib.metadata import version

        from twin.version import __version__

        typer.echo(f"twin {__version__}\npython {platform.python_version()}")
        for package in ("numba", "numpy", "rerun-sdk"):
            typer.echo(f"{package} {version(package)}")
        raise typer.Exit


def _options(
    version: Annotated[
        bool,
        typer.Option(
            "--version",
            callback=_print_version,
            is_eager=True,
            help="Print the versions of twin, Python, numba, numpy and rerun, and exit.",
        ),
    ] = False,
) -> None: ...
