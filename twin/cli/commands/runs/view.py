"""``twin view``."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

if TYPE_CHECKING:
    from twin.sinks.rerun.web import WebServer


def view(
    run: Annotated[
        Path, typer.Argument(metavar="RUN.mcap", help="Archive of a run or of a comparison.", show_default=False)
    ],
    rrd: Annotated[
        Path | None,
        typer.Option(metavar="FILE", help="Write a rerun recording instead of opening the viewer.", show_default=False),
    ] = None,
    web: Annotated[
        bool, typer.Option("--web", help="Show it in a browser, served on 127.0.0.1 until Ctrl-C, instead of a window.")
    ] = False,
    force: Annotated[bool, typer.Option("--force", help="Replace a recording that exists.")] = False,
) -> None:
    """Show an archived run, or an archived comparison, in the rerun viewer."""
    from twin.archive.comparison_file import is_comparison

    if is_comparison(run):
        _comparison(run, rrd, web=web, force=force)
    else:
        _run(run, rrd, web=web, force=force)


def _run(path: Path, rrd: Path | None, *, web: bool, force: bool) -> None:
    """The records of a run."""
    from twin.archive import read_run
    from twin.cli.early_end import warn_of_early_end
    from twin.cli.show.progress import progress
    from twin.record import RunHeader, Step
    from twin.sinks.outputs import opened

    records = read_run(path)
    header = next(records)
    assert isinstance(header, RunHeader)
    warn_of_early_end(path)
    with _served(web=web) as server:
        window = rrd is None and server is None
        with (
            opened(None, rrd, view=window, web=server, force=force) as write,
            progress(quiet=False) as line,
        ):
            write(header)
            line.start(header.planned_time_s)
            for record in records:
                write(record)
                if isinstance(record, Step):
                    line.at(record.t_s, record.nc_line)
        _end(rrd, server)


def _comparison(path: Path, rrd: Path | None, *, web: bool, force: bool) -> None:
    """Measured and simulated forces of a comparison."""
    from twin.archive.comparison_file import read_comparison
    from twin.errors import ArchiveError
    from twin.sinks.rerun.compare import show_comparison

    if rrd is not None and rrd.exists() and not force:
        raise ArchiveError(f"{rrd}: already exists; replace it with --force")
    forces, _ = read_comparison(path)
    with _served(web=web) as server:
        show_comparison(forces, rrd=rrd, spawn=rrd is None and server is None, web=server)
        _end(rrd, server)


@contextmanager
def _served(*, web: bool) -> Iterator[WebServer | None]:
    """The server for a browser, whose address is printed, if it is requested."""
    if not web:
        yield None
        return
    from twin.cli.console import results
    from twin.sinks.rerun.web import web_server

    with web_server() as server:
        results().print(f"Browser    {server.url}  (Ctrl-C ends it)", markup=False, soft_wrap=True)
        yield server


def _end(rrd: Path | None, server: WebServer | None) -> None:
    """Name the recording; go on serving until the user ends it."""
    from twin.cli.console import results

    if rrd is not None:
        results().print(f"Recording  {rrd}", markup=False, soft_wrap=True)
    if server is not None:
        server.wait()
