"""``gcode plot``."""

from __future__ import annotations

from enum import StrEnum
from pathlib import Path
from typing import Annotated

import typer

from gcode.cli.machine_options import ProgramFile, Setup, with_machine


class View(StrEnum):
    """From where the path is seen."""

    ISO = "iso"
    XY = "xy"
    XZ = "xz"
    YZ = "yz"


class ColourBy(StrEnum):
    """What the colour of a motion at a feed tells."""

    Z = "z"
    TOOL = "tool"


@with_machine
def plot(
    file: ProgramFile,
    out: Annotated[
        Path, typer.Option("--out", "-o", metavar="FILE.png|.svg|.pdf", help="Picture to write.", show_default=False)
    ],
    view: Annotated[View, typer.Option(help="From where the path is seen.")] = View.ISO,
    colour: Annotated[ColourBy, typer.Option(help="What the colours of feeds tell.")] = ColourBy.Z,
    tolerance_mm: Annotated[float, typer.Option(min=1e-6, help="How far chords may lie off arcs, mm.")] = 0.01,
    *,
    setup: Setup,
) -> None:
    """Draw the path of a program: rapids dashed, feeds coloured, the same scale along all axes."""
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
