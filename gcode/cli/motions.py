"""``gcode motions``."""

from __future__ import annotations

from gcode.cli.machine import (
    BlockDeleteOption,
    DialectName,
    DialectOption,
    ParametersOption,
    ProgramFile,
    SearchPathOption,
    SettingsOption,
    ToolTableOption,
    UnitOption,
    setup_of,
)


def motions(
    file: ProgramFile,
    dialect: DialectOption = DialectName.FANUC,
    tool_table: ToolTableOption = None,
    parameters: ParametersOption = None,
    settings: SettingsOption = None,
    machine_units: UnitOption = None,
    block_delete: BlockDeleteOption = False,
    search_path: SearchPathOption = None,
) -> None:
    """Print every motion and dwell of a program as one JSON object a line.

    Points are the controlled point in machine coordinates, mm: work offsets applied, tool length taken off. A program
    that is refused has its motions up to there printed.
    """
    import json
    import sys

    from gcode.cli.say import written
    from gcode.interpret import interpret_file
    from gcode.motion_json import motion_objects

    setup = setup_of(
        dialect=dialect,
        settings=settings,
        tool_table=tool_table,
        parameters=parameters,
        machine_units=machine_units,
        block_delete=block_delete,
        search_path=search_path,
    )
    encode = json.JSONEncoder(allow_nan=False).encode
    with written():
        events = interpret_file(file, dialect=setup.dialect, settings=setup.settings)
        for made in motion_objects(events, setup.settings.start_mm):
            sys.stdout.write(f"{encode(made)}\n")
