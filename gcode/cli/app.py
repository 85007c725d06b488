"""The program ``gcode``: its commands and the options of the program itself."""

from __future__ import annotations

from typing import Annotated

import typer

from gcode.cli.commands.check import check
from gcode.cli.commands.motions import motions
from gcode.cli.commands.plot import plot
from gcode.cli.commands.rewrite import rewrite
from gcode.cli.commands.stats import stats
from gcode.cli.help import HelpCommand, HelpGroup

app = typer.Typer(
    name="gcode",
    cls=HelpGroup,
    help="Reads NC programs as a control does: checks them, lists their motions, prints statistics, "
    "plots the tool path, and rewrites them for another control.",
    epilog="Exit codes: 0 done, 1 an error in a program or another file, 2 incorrect command line, 130 Ctrl-C, "
    "141 closed pipe.",
    pretty_exceptions_enable=False,
    context_settings={"help_option_names": ["-h", "--help"]},
)

for command in (check, motions, stats, plot, rewrite):
    app.command(cls=HelpCommand)(command)


def _print_version(wanted: bool) -> None:
    if wanted:
        import platform
        from importlib.metadata import version

        from gcode.version import __version__

        typer.echo(f"gcode {__version__}\npython {platform.python_version()}\nnumpy {version('numpy')}")
        raise typer.Exit


@app.callback()
def _options(
    version: Annotated[
        bool,
        typer.Option(
            "--version",
            callback=_print_version,
            is_eager=True,
            help="Print the versions of gcode, Python and numpy, and exit.",
        ),
    ] = False,
) -> None: ...
