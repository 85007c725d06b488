"""Files about the machine: tool tables, parameter files, and settings.

| file | read by | holds |
| --- | --- | --- |
| ``.tbl`` | `read_tool_table` | tool table of LinuxCNC, lengths in the machine's unit |
| ``.toml`` | `read_tool_table` | ``[tools.N]``, lengths in mm |
| ``.var`` | `read_parameters` | numbered parameters of LinuxCNC, lengths in the machine's unit |
| ``.toml`` | `read_settings` | any field of `gcode.settings.MachineSettings` |

All of them refuse a file with one `gcode.errors.GcodeError` that names file, line and column, the value, and the
expected value.
"""

from gcode.tables.parameter_file import ParameterFile, read_parameters
from gcode.tables.settings_file import read_settings
from gcode.tables.tool_table import read_tool_table

__all__ = ["ParameterFile", "read_parameters", "read_settings", "read_tool_table"]
