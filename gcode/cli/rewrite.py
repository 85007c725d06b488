"""``gcode rewrite``."""

from __future__ import annotations

from enum import StrEnum
from pathlib import Path
from typing import Annotated

import typer

from gcode.cli.machine_options import DialectName, MachineUnit, ProgramFile, Setup, with_machine


class Distance(StrEnum):
    """What coordinates are measured from."""

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
        Path, typer.Option("--out", "-o", metavar="FILE", help="Program to write.", show_default=False, dir_okay=False)
    ],
    to: Annotated[
        DialectName | None,
        typer.Option(help="Control to write for; the program's own if not given.", show_default=False),
    ] = None,
    units: Annotated[MachineUnit, typer.Option(help="Unit of the program written.")] = MachineUnit.MM,
    distance: Annotated[Distance, typer.Option(help="Coordinates as places or as ways.")] = Distance.ABSOLUTE,
    arcs: Annotated[Arcs, typer.Option(help="Arcs by I, J, K or, where it is safe, by R.")] = Arcs.CENTRE,
    decimals: Annotated[
        int | None, typer.Option(min=0, max=6, help="Digits after the point of coordinates.", show_default=False)
    ] = None,
    number_step: Annotated[
        int | None, typer.Option(min=1, max=1000, help="Step of the block numbers.", show_default=False)
    ] = None,
    program_number: Annotated[
        int | None, typer.Option(min=1, help="O number, for FANUC and Haas.", show_default=False)
    ] = None,
    wcs: Annotated[str, typer.Option(help="Work offset that the coordinates are in.")] = "G54",
    *,
    setup: Setup,
) -> None:
    """Write a program anew: the same motions for another control, in other units, or without macros and cycles.

    Subprograms, macros, cycles, work offsets and cutter compensation are worked out; what is written are plain
    motions. A length offset stays G43 H, so the same tool table must be at the control.
    """
    from gcode.cli.console import UnusableFileError, with_progress
    from gcode.dialects import dialect_named
    from gcode.flow.interpreter import interpret_file
    from gcode.write import WriteOptions, write_program

    try:
        options = WriteOptions(
            dialect=setup.dialect if to is None else dialect_named(to.value),
            units=units.value,
            distance=distance.value,
            arcs=arcs.value,
            decimals=decimals,
            number_step=number_step,
            program_number=program_number,
            wcs=wcs,
        ).for_machine(setup.settings)
        events = interpret_file(file, dialect=setup.dialect, settings=setup.settings)
        write_program(out, with_progress(events, file.name), options)
    except (ValueError, OSError) as error:
        raise UnusableFileError(str(error)) from None
