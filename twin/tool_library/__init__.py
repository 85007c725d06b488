"""Tool libraries of CAM programs and controls: files in, tools as the job file describes them out.

`read_tool_library` reads one. Each format has a module that turns its entries into `RawTool`; `assemble` checks
these and makes the tools (docs/tool-libraries.md).
"""

from twin.tool_library.library import LibraryUnit, ToolLibrary
from twin.tool_library.library_tool import LibraryTool, ToolCylinder
from twin.tool_library.read import read_tool_library

__all__ = ["LibraryTool", "LibraryUnit", "ToolCylinder", "ToolLibrary", "read_tool_library"]
