"""What a user keeps beside programs: tool tables, parameter files, and settings of the machine.

| file | read by | holds |
| --- | --- | --- |
| ``.tbl`` | `read_tool_table` | tool table of LinuxCNC, lengths in the machine's unit |
| ``.toml`` | `read_tool_table` | ``[tools.N]``, lengths in mm |
| ``.var`` | `read_parameters` | numbered parameters of LinuxCNC, lengths in the machine's unit |
| ``.toml`` | `read_settings` | any field of `gcode.settings.MachineSettings` |

All of them refuse a file with one `gcode.errors.GcodeError` that names file, line and column, the value, and what was
expected.
"""

from gcode.tables.parameter_file import ParameterFile, read_parameters
from gcode.tables.settings_file import read_settings
from gcode.tables.tool_table import read_tool_table

__all__ = ["ParameterFile", "read_parameters", "read_settings", "read_tool_table"]
