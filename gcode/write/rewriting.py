"""A program written again: for another control, in other units, without macros and cycles."""

from __future__ import annotations

from pathlib import Path

from gcode.dialects import FANUC, Dialect
from gcode.flow.interpreter import ProgramSource, interpret
from gcode.settings import MachineSettings
from gcode.write.options import WriteOptions
from gcode.write.program import write_program


def rewrite(
    source: ProgramSource,
    out: Path | str,
    options: WriteOptions | None = None,
    *,
    file: str = "<program>",
    dialect: Dialect | str = FANUC,
    settings: MachineSettings | None = None,
) -> int:
    """Writes the motions of a program as a new program, whole or not at all.

    Subprograms, macros, cycles, work offsets and cutter compensation are resolved into plain motions; a length offset
    stays G43 H, so the control needs the same tool table. Coordinates are those of the work offset `options.wcs`.

    Args:
        source: the program's text, its lines, the path of its file (a `Path`), or the result of `read_program`.
        out: file of the new program.
        options: how it is written; default `WriteOptions()`. Its work zero, tool table and tool are those of
            `settings`.
        file: name of a text in errors; a file is named by its path.
        dialect: the control whose language `source` is in, or its name; ``options.dialect`` is that of the new program.
        settings: the machine at the program's start; default `MachineSettings()`.

    Returns:
        Number of lines written.

    Raises:
        GcodeError: where the program is refused.
        WriteError: for an event that the new program cannot express.
        OSError: where the file cannot be written.
    """
    settings = settings or MachineSettings()
    events = interpret(source, file=file, dialect=dialect, settings=settings)
    return write_program(out, events, (options or WriteOptions()).for_machine(settings))
