"""``twin identify``."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from twin.cli.options import options_from
from twin.identification.cuts.fit_settings import Fit

if TYPE_CHECKING:
    from twin.identification.cuts.cuts_file import Cuts
    from twin.identification.result import Identified


@options_from(Fit, "fit", panel="Fit: these options override the file's [fit] table")
def identify(
    cuts_file: Annotated[Path, typer.Argument(metavar="CUTS", help="File of test cuts (TOML).", show_default=False)],
    fit: Mapping[str, Any],
    out: Annotated[
        Path | None,
        typer.Option(
            "-o",
            "--out",
            metavar="FILE.toml",
            help="Coefficients to write; a plot is written next to them.",
            show_default=False,
        ),
    ] = None,
    plot: Annotated[
        Path | None,
        typer.Option(metavar="FILE.png", help="Plot of measured and fitted forces to write.", show_default=False),
    ] = None,
    force: Annotated[bool, typer.Option("--force", help="Replace output files that exist.")] = False,
    as_json: Annotated[bool, typer.Option("--json", help="Print the result as one JSON object.")] = False,
    verbose: Annotated[
        bool, typer.Option("--verbose", "-v", help="Print how each log was read and corrected.")
    ] = False,
) -> None:
    """Find cutting coefficients from test cuts, with their errors.

    Methods: mean is linear least squares on mean forces; iterative searches until simulated mean forces match;
    waveform is least squares on the force over a revolution; it finds spindle phases and, with --runout, the runout.
    """
    from twin.cli.show.progress import doing
    from twin.errors import IdentifyError
    from twin.identification.cuts.load import load_cuts
    from twin.identification.identify import identify as find
    from twin.identification.write import refuse_existing

    cuts = load_cuts(cuts_file, fit)
    if out is not None and plot is None:
        plot = out.with_suffix(".png")
    _check_suffixes(out, plot)
    refuse_existing([p for p in (out, plot) if p is not None], force=force)
    with doing("identifying", quiet=as_json) as report:
        result = find(cuts, report=report)
    try:
        _write(result, out, plot, force=force)
    except IdentifyError:  # the result shows why no set can be written
        if not as_json:
            _print(cuts, result, {}, verbose=verbose)
            _warn(result)
        raise
    if as_json:
        _print_json(result, out, plot)
    else:
        _print(cuts, result, {"Coefficients": out, "Plot": plot}, verbose=verbose)
    _warn(result)


def _check_suffixes(out: Path | None, plot: Path | None) -> None:
    for option, path, suffix in (("--out", out, ".toml"), ("--plot", plot, ".png")):
        if path is not None and path.suffix.lower() != suffix:
            raise typer.BadParameter(f"{path}: expected a file name that ends in {suffix}", param_hint=option)


def _write(result: Identified, out: Path | None, plot: Path | None, *, force: bool) -> None:
    from twin.identification.coefficients_toml import coefficients_toml
    from twin.identification.plot import plot_png
    from twin.identification.write import write_files

    contents = {}
    if out is not None:
        contents[out] = coefficients_toml(result).encode()
    if plot is not None:
        contents[plot] = plot_png(result)
    write_files(contents, force=force)


def _print_json(result: Identified, out: Path | None, plot: Path | None) -> None:
    from twin.cli.console import print_json
    from twin.identification.as_json import identified_object

    files = {"coefficients_file": out and str(out), "plot_file": plot and str(plot)}
    print_json(identified_object(result) | files)


def _print(cuts: Cuts, result: Identified, files: dict[str, Path | None], *, verbose: bool) -> None:
    from twin.cli.console import results
    from twin.cli.show.identify_tables import print_identified

    console = results()
    print_identified(console, cuts, result, verbose=verbose)
    for what, path in files.items():
        if path is not None:
            console.print(f"{what:<12} {path}", markup=False, soft_wrap=True)


def _warn(result: Identified) -> None:
    from twin.cli.console import warn

    for line in result.warnings:
        warn(line)
