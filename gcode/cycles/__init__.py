"""Canned cycles of mills as pure functions: from the words of a block to the steps of its holes."""

from gcode.cycles.cycle_tables import FANUC_CYCLES, HAAS_CYCLES, LINUXCNC_CYCLES
from gcode.cycles.errors import CycleError
from gcode.cycles.expansion import run_cycle
from gcode.cycles.interface import CycleInput, CycleOutput
from gcode.cycles.rules import Act, Cycle, CycleRules, DwellUnit
from gcode.cycles.steps import Move, OperatorStop, Orient, Pause, Position, Spindle, Step

__all__ = [
    "FANUC_CYCLES",
    "HAAS_CYCLES",
    "LINUXCNC_CYCLES",
    "Act",
    "Cycle",
    "CycleError",
    "CycleInput",
    "CycleOutput",
    "CycleRules",
    "DwellUnit",
    "Move",
    "OperatorStop",
    "Orient",
    "Pause",
    "Position",
    "Spindle",
    "Step",
    "run_cycle",
]
