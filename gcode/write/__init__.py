"""Events -> NC programs: the reverse of the interpreter, and the output of tool paths."""

from gcode.write.errors import WriteError
from gcode.write.options import WriteOptions
from gcode.write.program import program_lines, write_program
from gcode.write.rewriting import rewrite

__all__ = ["WriteError", "WriteOptions", "program_lines", "rewrite", "write_program"]
