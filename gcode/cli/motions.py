"""``gcode motions``."""

from __future__ import annotations

from gcode.cli.machine_options import ProgramFile, Setup, with_machine


@with_machine
def motions(
    file: ProgramFile,
    *,
    setup: Setup,
) -> None:
    """Print every motion and dwell of a program as one JSON object a line.

    Points are the controlled point in machine coordinates, mm: work offsets applied, tool length taken off. A program
    that is refused has its motions up to there printed.
    """
    import json
    import sys

    from gcode.cli.console import written
    from gcode.flow.interpreter import interpret_file
    from gcode.report.motion_json import motion_objects

    encode = json.JSONEncoder(allow_nan=False).encode
    with written():
        events = interpret_file(file, dialect=setup.dialect, settings=setup.settings)
        for made in motion_objects(events, setup.settings.start_mm):
            sys.stdout.write(f"{encode(made)}\n")
