"""Events -> NC programs: the way back from what `gcode.flow.interpret` yields, and the way out for tool paths."""

from gcode.write.errors import WriteError
from gcode.write.options import WriteOptions
from gcode.write.program import program_lines, write_file

__all__ = ["WriteError", "WriteOptions", "program_lines", "write_file"]
