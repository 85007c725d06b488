"""The commands put together."""

from __future__ import annotations

from typing import Annotated

import typer

from gcode.cli.check import check
from gcode.cli.motions import motions
from gcode.cli.plot import plot
from gcode.cli.rewrite import rewrite
from gcode.cli.stats import stats

app = typer.Typer(
    name="gcode",
    help="Reads NC programs as a control does: checks them, tells their motions, writes them anew.",
    epilog="Exit codes: 0 done, 1 a program has mistakes that messages name, 2 wrong arguments or a file that cannot "
    "be used, 130 Ctrl-C.",
    no_args_is_help=True,
    add_completion=False,
    pretty_exceptions_enable=False,
    context_settings={"help_option_names": ["-h", "--help"]},
)

for command in (check, motions, stats, plot, rewrite):
    app.command()(command)


def _print_version(wanted: bool) -> None:
    if wanted:
        from importlib.metadata import PackageNotFoundError, version

        try:
            typer.echo(version("machining-twin"))
        except PackageNotFoundError:
            typer.echo("not installed")
        raise typer.Exit


@app.callback()
def _options(
    version: Annotated[
        bool, typer.Option("--version", callback=_print_version, is_eager=True, help="Print the version and end.")
    ] = False,
) -> None: ...
