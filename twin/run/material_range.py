"""Engaged time of a run outside the range of chip thickness and cutting speed that its coefficients hold for."""

from __future__ import annotations

import json
import math
import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import TypeAlias

from twin.record import RunHeader, Step

_TOOL_KEY = re.compile(r"tools\[(\d+)\]\.number")
#: Rounding of a chip thickness or speed at the end of its range.
_ROUNDING = 1e-6
Interval: TypeAlias = tuple[float, float]


@dataclass(slots=True)
class _Outside:
    """One quantity of one tool: its range, the engaged time outside, and the values on either side."""

    what: str
    unit: str
    interval: Interval
    time_s: float = 0.0
    low: float = math.inf
    high: float = -math.inf

    def take(self, value: float, duration_s: float) -> bool:
        """Count a step; returns whether it is outside."""
        lowest, highest = self.interval
        if lowest * (1.0 - _ROUNDING) <= value <= highest * (1.0 + _ROUNDING):
            return False
        self.time_s += duration_s
        self.low, self.high = min(self.low, value), max(self.high, value)
        return True

    def __str__(self) -> str:
        values = (
            f"{self.low:.3g}" if self.high - self.low <= 0.005 * self.high else f"{self.low:.3g} to {self.high:.3g}"
        )
        lowest, highest = self.interval
        held = f"{lowest:g}" if lowest == highest else f"{lowest:g} to {highest:g}"
        return f"{self.what} of {values} {self.unit} (range {held})"


@dataclass(slots=True)
class _Tool:
    """A tool whose coefficients have a range."""

    name: str
    diameter_mm: float
    chip: _Outside | None
    speed: _Outside | None
    engaged_s: float = 0.0
    outside_s: float = 0.0


class MaterialRange:
    """Takes the records of a run; its memory does not grow with the run."""

    def __init__(self) -> None:
        self._tools: dict[int, _Tool] = {}

    def header(self, header: RunHeader) -> None:
        """Take the ranges of the tools from the run's parameters."""
        parameters = header.parameters
        for key, number in parameters.items():
            match = _TOOL_KEY.fullmatch(key)
            if match:
                tool = _tool(parameters, int(match[1]))
                if tool.chip is not None or tool.speed is not None:
                    self._tools[int(number)] = tool

    def step(self, step: Step) -> None:
        """Count one step."""
        tool = self._tools.get(step.tool)
        if tool is None or not step.engagement.cutting or step.rapid:
            return
        tool.engaged_s += step.duration_s
        outside = False
        if tool.chip is not None and step.feed_mm_min:
            outside = tool.chip.take(step.engagement.chip_thickness_mm, step.duration_s)
        if tool.speed is not None and step.spindle_rpm:
            speed = math.pi * tool.diameter_mm * abs(step.spindle_rpm) / 1000.0
            outside = tool.speed.take(speed, step.duration_s) or outside
        if outside:
            tool.outside_s += step.duration_s

    def warnings(self) -> Iterator[str]:
        """One line for each tool that cuts outside its range."""
        for number, tool in self._tools.items():
            if tool.outside_s > 0.0:
                found = [str(q) for q in (tool.chip, tool.speed) if q is not None and q.time_s > 0.0]
                yield (
                    f"T{number}: {100.0 * tool.outside_s / tool.engaged_s:.3g} % of the engaged time is outside the "
                    f"range of {tool.name}: {'; '.join(found)}"
                )


def _tool(parameters: Mapping[str, str], index: int) -> _Tool:
    own = f"tools[{index}].cutting"
    table = own if f"{own}.Ktc" in parameters else "cutting"
    chip, speed = (_interval(parameters, f"{table}.{key}") for key in ("chip_range_mm", "speed_range_m_min"))
    material = parameters.get(f"{table}.material")
    return _Tool(
        name=f'{table}.material = "{material}"' if material else f"the coefficients in {table}",
        diameter_mm=float(parameters.get(f"tools[{index}].diameter_mm", "0")),
        chip=chip and _Outside("largest uncut chip thickness", "mm", chip),
        speed=speed and _Outside("cutting speed at the tool's diameter", "m/min", speed),
    )


def _interval(parameters: Mapping[str, str], key: str) -> Interval | None:
    if key not in parameters:
        return None
    low, high = json.loads(parameters[key])
    return float(low), float(high)
