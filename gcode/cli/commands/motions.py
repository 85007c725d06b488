"""``gcode motions``: prints motions as JSON lines."""

from __future__ import annotations

from gcode.cli.machine_options import ProgramFile, Setup, with_machine


@with_machine
def motions(file: ProgramFile, *, setup: Setup) -> None:
    """Print every motion and dwell of a program as one JSON object per line.

    Positions are those of the controlled point in machine coordinates, mm: the tool tip while the tool length offset is
    active, else the gauge point. If the program has an error, the motions before it are printed.
    """
    import sys

    from gcode.flow.interpreter import run
    from gcode.report.batch_lines import motion_lines

    events = run(file, dialect=setup.dialect, settings=setup.settings)
    for text in motion_lines(events, setup.settings.start_mm):
        sys.stdout.write(text)
