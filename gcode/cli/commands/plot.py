"""``gcode plot``: plots the tool path."""

from __future__ import annotations

from enum import StrEnum
from pathlib import Path
from typing import Annotated

import typer

from gcode.cli.machine_options import ProgramFile, with_machine
from gcode.cli.setup import Setup


class View(StrEnum):
    """Direction of view."""

    ISO = "iso"
    XY = "xy"
    XZ = "xz"
    YZ = "yz"


class ColourBy(StrEnum):
    """Quantity that colours the feed motions."""

    Z = "z"
    TOOL = "tool"


@with_machine
def plot(
    file: ProgramFile,
    out: Annotated[
        Path, typer.Option("--out", "-o", metavar="FILE.png|.svg|.pdf", help="Image file to write.", show_default=False)
    ],
    view: Annotated[View, typer.Option(help="Direction of view.")] = View.ISO,
    colour: Annotated[ColourBy, typer.Option(help="Colour feed motions by height (z) or by tool.")] = ColourBy.Z,
    tolerance_mm: Annotated[float, typer.Option(min=1e-6, metavar="MM", help="Chord tolerance of arcs, mm.")] = 0.01,
    *,
    setup: Setup,
) -> None:
    """Plot the tool path of a program: rapids dashed, feed motions coloured, all axes to the same scale."""
    from gcode.cli.console import UnusableFileError, with_progress
    from gcode.flow.interpreter import interpret_file
    from gcode.report.plot import PlotError, check_picture, plot_path

    try:
        check_picture(out)
        events = interpret_file(file, dialect=setup.dialect, settings=setup.settings)
        plot_path(
            with_progress(events, file.name),
            out,
            view=view.value,
            colour=colour.value,
            tolerance_mm=tolerance_mm,
            title=file.name,
        )
    except PlotError as error:
        raise UnusableFileError(str(error)) from None
