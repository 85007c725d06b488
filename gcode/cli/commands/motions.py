"""``gcode motions``: prints motions as JSON lines."""

from __future__ import annotations

from gcode.cli.machine_options import ProgramFile, Setup, with_machine


@with_machine
def motions(file: ProgramFile, *, setup: Setup) -> None:
    """Print every motion and dwell of a program as one JSON object per line.

    Positions are those of the controlled point in machine coordinates, mm: the tool tip while the tool length offset is
    active, else the gauge point. If the program has an error, the motions before it are printed.
    """
    import json
    import sys

    from gcode.flow.interpreter import interpret_file
    from gcode.report.motion_json import motion_objects
    from gcode.underline import harmless_json

    encode = json.JSONEncoder(allow_nan=False).encode
    events = interpret_file(file, dialect=setup.dialect, settings=setup.settings)
    for made in motion_objects(events, setup.settings.start_mm):
        sys.stdout.write(f"{harmless_json(encode(made))}\n")
