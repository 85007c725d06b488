"""``gcode rewrite``: writes a program for another control."""

from __future__ import annotations

from enum import StrEnum
from pathlib import Path
from typing import Annotated

import typer

from gcode.cli.machine_options import DialectName, MachineUnit, ProgramFile, with_machine
from gcode.cli.setup import Setup


class Distance(StrEnum):
    """How coordinates are measured."""

    ABSOLUTE = "absolute"
    INCREMENTAL = "incremental"


class Arcs(StrEnum):
    """How arcs are written."""

    CENTRE = "centre"
    RADIUS = "radius"


@with_machine
def rewrite(
    file: ProgramFile,
    out: Annotated[
        Path,
        typer.Option("--out", "-o", metavar="FILE", help="Program file to write.", show_default=False, dir_okay=False),
    ],
    to: Annotated[
        DialectName | None,
        typer.Option(help="Control to write for; default: the control of the program (--dialect).", show_default=False),
    ] = None,
    units: Annotated[MachineUnit, typer.Option(help="Unit of the new program.")] = MachineUnit.MM,
    distance: Annotated[
        Distance, typer.Option(help="Absolute (G90) or incremental (G91) coordinates.")
    ] = Distance.ABSOLUTE,
    arcs: Annotated[
        Arcs, typer.Option(help="Write arcs with their centre (I, J, K) or, where this is safe, their radius (R).")
    ] = Arcs.CENTRE,
    decimals: Annotated[
        int | None,
        typer.Option(min=0, max=6, metavar="N", help="Decimal places of coordinates, 0 to 6.", show_default=False),
    ] = None,
    number_step: Annotated[
        int | None,
        typer.Option(
            min=1,
            max=1000,
            metavar="N",
            help="Increment of block numbers (N); without it, blocks are not numbered.",
            show_default=False,
        ),
    ] = None,
    program_number: Annotated[
        int | None,
        typer.Option(min=1, metavar="N", help="Program number (O word), for FANUC and Haas.", show_default=False),
    ] = None,
    wcs: Annotated[str, typer.Option(metavar="NAME", help="Work offset that the coordinates refer to.")] = "G54",
    *,
    setup: Setup,
) -> None:
    """Rewrite a program: the same motions for another control, in other units, or without macros and cycles.

    Subprograms, macros, cycles, work offsets and cutter compensation are resolved into plain motions. Tool length
    offsets stay as G43 H, so the control needs the same tool table.
    """
    from gcode.cli.console import UnusableFileError, with_progress
    from gcode.dialects import dialect_named
    from gcode.flow.interpreter import interpret_file
    from gcode.write import WriteOptions, write_program

    try:
        options = WriteOptions(
            dialect=setup.control if to is None else dialect_named(to.value),
            units=units.value,
            distance=distance.value,
            arcs=arcs.value,
            decimals=decimals,
            number_step=number_step,
            program_number=program_number,
            wcs=wcs,
        ).for_machine(setup.settings)
    except ValueError as error:
        raise typer.BadParameter(str(error)) from None
    try:
        events = interpret_file(file, dialect=setup.dialect, settings=setup.settings)
        write_program(out, with_progress(events, file.name), options)
    except OSError as error:
        raise UnusableFileError(f"{out}: cannot be written: {(error.strerror or str(error)).lower()}") from None
