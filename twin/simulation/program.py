"""A job's NC program as motions and events: the machine that it runs on, and what must hold before anything is cut."""

from __future__ import annotations

import math
from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import NamedTuple

import numpy as np

from gcode.events import Event, ToolChange
from gcode.flow.interpreter import interpret, taken_dialect
from gcode.language.program import read_program
from gcode.settings import MachineSettings, ToolOffset
from twin.arrays import FloatArray
from twin.errors import ReplayError
from twin.job import RAPIDS, Machine, Program, Tool
from twin.motion.from_nc import moves_from_nc
from twin.motion.path import Move
from twin.workpiece.stock import SliceSet

#: Height of the gauge point's reference position above the highest point of stock and longest tool, mm.
HOME_CLEARANCE_MM = 100.0
#: Motions that are longer than this are taken for a mistake.
_LONGEST_S, _FARTHEST_MM = 1e9, 1e7


class Plan(NamedTuple):
    """A program that has been read to its end.

    Attributes:
        time_s: machine time of motions and tool changes.
        work_mm: shape (2, 3), lower and upper corner of the box of the tool tip in feed motions that end below the top
            of the stock; None without any.
    """

    time_s: float
    work_mm: FloatArray | None


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class ProgramMoves:
    """Motions of the tool tip in workpiece coordinates, and the other events of a program, in order.

    The program is interpreted anew each time this is iterated, so memory does not grow with its length.

    Attributes:
        file: the NC program.
        dialect: name of the control's dialect, or ``auto``.
        settings: the machine as the interpreter needs it.
        origin_mm: shape (3,), work offset in which the stock is given.
        tool_length_mm: by tool number.
        rapid_mm_min: speed of straight positioning motions.
        axis_rapid_mm_min: shape (3,), rates of the axes where they move independently in rapids, None where rapids are
            straight.

    Raises:
        GcodeError: a program that cannot be interpreted, when its line comes.
        TwinError: a motion that cannot be replayed.
    """

    file: Path
    dialect: str
    settings: MachineSettings
    origin_mm: FloatArray
    tool_length_mm: Mapping[int, float]
    rapid_mm_min: float
    axis_rapid_mm_min: FloatArray | None

    def __iter__(self) -> Iterator[Move | Event]:
        events = interpret(
            read_program(self.file),
            file=str(self.file),
            dialect=self.dialect,
            settings=self.settings,
        )
        return moves_from_nc(
            events,
            origin_mm=self.origin_mm,
            start_mm=self.settings.start_mm,
            tool_length_mm=dict(self.tool_length_mm),
            rapid_mm_min=self.rapid_mm_min,
            axis_rapid_mm_min=self.axis_rapid_mm_min,
        )

    def checked(self, tool_change_s: float, top_mm: float) -> Plan:
        """Machine time and extent of the whole program; all of it is read and its tools checked.

        Args:
            tool_change_s: time of one tool change.
            top_mm: top of the stock.

        Raises:
            ReplayError: a tool that is not in the job, a feed motion without a tool.
            TwinError, GcodeError: as the class.
        """
        low, high = np.full(3, math.inf), np.full(3, -math.inf)
        time_s = math.fsum(self._checked_durations(tool_change_s, top_mm, low, high))
        return Plan(time_s, np.array([low, high]) if np.all(low <= high) else None)

    def _checked_durations(
        self, tool_change_s: float, top_mm: float, low: FloatArray, high: FloatArray
    ) -> Iterator[float]:
        """Durations of motions and tool changes; ``low`` and ``high`` come to hold the ends of feed motions."""
        tools: Collection[int] = self.tool_length_mm.keys()
        known = ", ".join(str(n) for n in sorted(tools))
        for item in self:
            if isinstance(item, ToolChange):
                if item.tool not in tools and item.tool != 0:
                    raise ReplayError(f"{item.place}: tool T{item.tool} is not in the job; expected one of {known}")
                yield tool_change_s
            elif isinstance(item, Move):
                length_mm = item.length_mm
                if not (item.duration_s < _LONGEST_S and length_mm < _FARTHEST_MM):
                    raise ReplayError(
                        f"{self.file}:{item.nc_line}: {length_mm:.3g} mm in {item.duration_s:.3g} s; expected a "
                        f"motion or dwell below {_FARTHEST_MM:g} mm and {_LONGEST_S:g} s: check the units and F"
                    )
                if item.tool == 0 and not item.rapid and length_mm > 0.0:
                    raise ReplayError(
                        f"{self.file}:{item.nc_line}: feed motion without a tool in the spindle; "
                        "expected a tool change (T.. M6) before it, program.tool in the job, or --tool N"
                    )
                if not item.rapid and item.end_mm[2] < top_mm:
                    for end_mm in (item.start_mm, item.end_mm):
                        np.minimum(low, end_mm, out=low)
                        np.maximum(high, end_mm, out=high)
                yield item.duration_s


def program_moves(
    program: Program, machine: Machine, tools: Sequence[Tool], origin_mm: FloatArray, stock: SliceSet
) -> ProgramMoves:
    """A job's program on its machine.

    Args:
        origin_mm: shape (3,), work offset in which the stock is given.
        stock: the machine's home position is over it, where the job does not say one.
    """
    return ProgramMoves(
        file=Path(program.file),
        dialect=program.dialect,
        settings=_machine_settings(program, machine, tools, origin_mm, stock),
        origin_mm=origin_mm,
        tool_length_mm={t.number: t.length_mm for t in tools},
        rapid_mm_min=machine.rapid_mm_min,
        axis_rapid_mm_min=_axis_rapids(program, machine),
    )


def _axis_rapids(program: Program, machine: Machine) -> FloatArray | None:
    """Rates of the axes in rapids, None where the control moves in a straight line."""
    path = machine.rapid or RAPIDS[taken_dialect(read_program(Path(program.file)), program.dialect)[0].name]
    if path == "straight":
        return None
    return np.array(machine.axis_rapid_mm_min or (machine.rapid_mm_min,) * 3)


def _offset_radius_mm(tool: Tool) -> float:
    """Radius of cutter compensation."""
    return 0.5 * tool.diameter_mm if tool.offset_radius_mm is None else tool.offset_radius_mm


def _machine_settings(
    program: Program, machine: Machine, tools: Sequence[Tool], origin_mm: FloatArray, stock: SliceSet
) -> MachineSettings:
    """The machine as the interpreter needs it.

    Without a home position in the job it is over the middle of the stock, above it and the longest tool.
    """
    middle = origin_mm + 0.5 * (stock.low_mm + stock.high_mm)
    longest = max((tool.length_mm for tool in tools), default=0.0)
    top = float(origin_mm[2] + stock.high_mm[2]) + longest + HOME_CLEARANCE_MM
    home = machine.home_mm or (float(middle[0]), float(middle[1]), top)
    return MachineSettings(
        offsets={str(name): position for name, position in machine.offsets.items()},
        home_mm=home,
        start_mm=machine.start_mm or home,
        tools={t.number: ToolOffset(length_mm=t.length_mm, radius_mm=_offset_radius_mm(t)) for t in tools},
        tool=program.tool,
        arc_centres=program.arc_centres,
        block_delete=program.block_delete,
        units=program.units,
        g70_units=program.g70_units,
        search_path=tuple(program.search_path),
        decimal_point=program.decimal_point,
        compensation_startup=program.compensation_startup,
        m_codes=program.m_codes,
    )
