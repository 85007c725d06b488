"""Reads NC programs as a control does: events, motions as arrays, checks, statistics, and programs written again.

    import gcode

    for event in gcode.interpret_file("part.nc", dialect="haas"):
        if isinstance(event, gcode.ArcMotion):
            print(event.place, event.centre_mm)

Lengths are mm, feeds mm/min and spindle speeds rpm, whatever units a program is written in. Points are the controlled
point (the tool tip as the control knows it) in machine coordinates.

The names below are the public interface; every other module is private and may change. Importing the package loads
nothing else: a name is loaded when it is used for the first time.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from gcode.dialects import DIALECTS, FANUC, GRBL, HAAS, LINUXCNC, Dialect, dialect_named
    from gcode.errors import Call, GcodeError, Place
    from gcode.events import (
        PLANE_AXES,
        ArcMotion,
        Block,
        CoolantChange,
        Dwell,
        Event,
        LinearMotion,
        Motion,
        MotionState,
        Notice,
        Plane,
        Point,
        ProgramStop,
        SpindleChange,
        ToolChange,
    )
    from gcode.flow.interpreter import ProgramSource, check, interpret, interpret_file
    from gcode.language.program import Program, read_program
    from gcode.report.motion_arrays import MotionArrays, MotionKind, concatenate, motion_arrays
    from gcode.report.motion_json import motion_objects
    from gcode.report.path_geometry import extremes_mm, length_mm, points_mm
    from gcode.report.plot import PlotError, plot_path
    from gcode.report.stats import Box, MotionTotals, ProgramStats, ValueSet, program_stats
    from gcode.report.stats_json import stats_object
    from gcode.settings import Limits, MachineSettings, ToolOffset
    from gcode.tables import ParameterFile, read_parameters, read_settings, read_tool_table
    from gcode.write import WriteError, WriteOptions, program_lines, rewrite, write_program

__all__ = [
    "DIALECTS",
    "FANUC",
    "GRBL",
    "HAAS",
    "LINUXCNC",
    "PLANE_AXES",
    "ArcMotion",
    "Block",
    "Box",
    "Call",
    "CoolantChange",
    "Dialect",
    "Dwell",
    "Event",
    "GcodeError",
    "Limits",
    "LinearMotion",
    "MachineSettings",
    "Motion",
    "MotionArrays",
    "MotionKind",
    "MotionState",
    "MotionTotals",
    "Notice",
    "ParameterFile",
    "Place",
    "Plane",
    "PlotError",
    "Point",
    "Program",
    "ProgramSource",
    "ProgramStats",
    "ProgramStop",
    "SpindleChange",
    "ToolChange",
    "ToolOffset",
    "ValueSet",
    "WriteError",
    "WriteOptions",
    "check",
    "concatenate",
    "dialect_named",
    "extremes_mm",
    "interpret",
    "interpret_file",
    "length_mm",
    "motion_arrays",
    "motion_objects",
    "plot_path",
    "points_mm",
    "program_lines",
    "program_stats",
    "read_parameters",
    "read_program",
    "read_settings",
    "read_tool_table",
    "rewrite",
    "stats_object",
    "write_program",
]

#: Modules of the public names.
_HOMES = {
    "gcode.dialects": ("DIALECTS", "FANUC", "GRBL", "HAAS", "LINUXCNC", "Dialect", "dialect_named"),
    "gcode.errors": ("Call", "GcodeError", "Place"),
    "gcode.events": (
        *("PLANE_AXES", "ArcMotion", "Block", "CoolantChange", "Dwell", "Event", "LinearMotion", "Motion"),
        *("MotionState", "Notice", "Plane", "Point", "ProgramStop", "SpindleChange", "ToolChange"),
    ),
    "gcode.flow.interpreter": ("ProgramSource", "check", "interpret", "interpret_file"),
    "gcode.language.program": ("Program", "read_program"),
    "gcode.report.motion_arrays": ("MotionArrays", "MotionKind", "concatenate", "motion_arrays"),
    "gcode.report.motion_json": ("motion_objects",),
    "gcode.report.path_geometry": ("extremes_mm", "length_mm", "points_mm"),
    "gcode.report.plot": ("PlotError", "plot_path"),
    "gcode.report.stats": ("Box", "MotionTotals", "ProgramStats", "ValueSet", "program_stats"),
    "gcode.report.stats_json": ("stats_object",),
    "gcode.settings": ("Limits", "MachineSettings", "ToolOffset"),
    "gcode.tables": ("ParameterFile", "read_parameters", "read_settings", "read_tool_table"),
    "gcode.write": ("WriteError", "WriteOptions", "program_lines", "rewrite", "write_program"),
}
_HOME = {name: module for module, names in _HOMES.items() for name in names}


def __getattr__(name: str) -> Any:
    if name not in _HOME:
        raise AttributeError(f"module 'gcode' has no attribute {name!r}")
    value = getattr(import_module(_HOME[name]), name)
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    return sorted({*globals(), *__all__})
