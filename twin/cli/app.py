"""The commands put together."""

from __future__ import annotations

from typing import Annotated

import typer

from twin.cli.commands.compare import compare
from twin.cli.commands.export import export
from twin.cli.commands.identify import identify
from twin.cli.commands.info import info
from twin.cli.commands.mesh import mesh
from twin.cli.commands.mold import mold
from twin.cli.commands.paths import paths
from twin.cli.commands.reach import reach
from twin.cli.commands.replay import replay
from twin.cli.commands.schema import schema
from twin.cli.commands.verify import verify
from twin.cli.commands.view import view
from twin.cli.help import HelpCommand, HelpGroup

app = typer.Typer(
    name="twin",
    cls=HelpGroup,
    help="A machining digital twin: replays NC programs, removes material, predicts cutting forces.",
    epilog="Exit codes: 0 done, 1 an error, explained in the message, 2 wrong use of the command line, 3 a collision "
    "under --strict, 4 out of tolerance, 130 Ctrl-C, 141 closed pipe.",
    pretty_exceptions_enable=False,
    context_settings={"help_option_names": ["-h", "--help"]},
)

for command in (
    replay,
    view,
    info,
    export,
    compare,
    identify,
    mesh,
    reach,
    paths,
    verify,
    mold,
    schema,
):
    app.command(cls=HelpCommand)(command)
# the former name of `twin reach`
app.command("machinable", hidden=True, cls=HelpCommand)(reach)


def _print_version(wanted: bool) -> None:
    if wanted:
        import platform
        from importlib.metadata import version

        from twin.version import __version__

        typer.echo(f"twin {__version__}\npython {platform.python_version()}")
        for package in ("numba", "numpy", "rerun-sdk"):
            typer.echo(f"{package} {version(package)}")
        raise typer.Exit


@app.callback()
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
