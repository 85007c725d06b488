"""``gcode motions``: prints motions as JSON lines."""

from __future__ import annotations

from gcode.cli.machine_options import ProgramFile, with_machine
from gcode.cli.setup import Setup


@with_machine
def motions(file: ProgramFile, *, setup: Setup) -> None:
    """Print every motion and dwell of a program as one JSON object per line.

    Positions are those of the controlled point in machine coordinates, mm: the tool tip while the tool length offset is
    active, else the gauge point. If the program has an error, the motions before it are printed.
    """
    from gcode.cli.tasks import print_motions

    print_motions(file, setup)
