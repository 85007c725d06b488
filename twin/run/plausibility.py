"""Numbers of a run that are hardly what the user meant: one line for each kind, none of them ends the run.

Everything is derived from the records, so a replay and an archive get the same lines.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass

from twin.record import NcEvent, Record, RunHeader, RunSummary, Step
from twin.run.material_range import MaterialRange

#: Feed per tooth above this part of the tool's radius; feeds of high-feed cutters reach a fifth of it.
_LARGE_CHIP = 0.25
#: Feed per tooth below the radius of a sharp edge: as a length, mm, and as a part of the tool's diameter.
_EDGE_MM, _EDGE_PART = 0.001, 0.0005
#: Lengths of a path in inches, as large as the stock in mm within these factors.
_INCH_MM, _LIKE_STOCK = 25.4, (0.25, 2.0)
#: A path whose extent differs from the stock's by this factor is doubtful.
_OTHER_UNITS = 8.0
_UNITS = re.compile(r"G0*2[01](?![\d.])", re.IGNORECASE)
_TOOL_KEY = re.compile(r"tools\[(\d+)\]\.(number|diameter_mm|teeth)")


def tool_sizes(header: RunHeader) -> dict[int, tuple[float, int]]:
    """Diameter, mm, and number of teeth of the run's tools, by tool number."""
    found: dict[str, dict[str, float]] = {}
    for key, value in header.parameters.items():
        match = _TOOL_KEY.fullmatch(key)
        if match:
            found.setdefault(match[1], {})[match[2]] = float(value)
    return {int(t["number"]): (t["diameter_mm"], int(t["teeth"])) for t in found.values()}


@dataclass(slots=True)
class _Doubt:
    """One kind of doubt about one tool: the line where it is worst, its text there, and on how many lines it is."""

    line: int
    size: float
    text: str
    lines: int = 1
    last_line: int = 0


class Plausibility:
    """Takes the records of a run; its memory does not grow with the run."""

    def __init__(self) -> None:
        self._parameters: Mapping[str, str] = {}
        self._tools: dict[int, tuple[float, int]] = {}
        self._stock_mm = 0.0
        self._doubts: dict[tuple[str, int], _Doubt] = {}
        self._checked: tuple[int, int, float, float, bool] | None = None
        self._states_units = False
        self._range = MaterialRange()
        self._low, self._high = [float("inf")] * 2, [float("-inf")] * 2

    def take(self, record: Record) -> None:
        """Take one record."""
        if isinstance(record, Step):
            self._step(record)
            self._range.step(record)
        elif isinstance(record, NcEvent):
            self._states_units = self._states_units or (record.kind == "block" and bool(_UNITS.search(record.text)))
        elif isinstance(record, RunHeader):
            self._header(record)
            self._range.header(record)

    def _header(self, header: RunHeader) -> None:
        self._parameters = header.parameters
        low, high = header.stock_bounds_mm
        self._stock_mm = float(max(high[0] - low[0], high[1] - low[1]))
        self._tools = tool_sizes(header)

    def _step(self, step: Step) -> None:
        if step.rapid or step.feed_mm_min == 0.0:
            return
        for i in (0, 1):
            self._low[i] = min(self._low[i], step.start_mm[i], step.end_mm[i])
            self._high[i] = max(self._high[i], step.start_mm[i], step.end_mm[i])
        state = (step.nc_line, step.tool, step.feed_mm_min, step.spindle_rpm, step.engagement.cutting)
        if state != self._checked:
            self._checked = state
            self._check_machine(step)
            if step.engagement.cutting and step.spindle_rpm and step.tool in self._tools:
                self._check_chip(step)

    def _check_machine(self, step: Step) -> None:
        key = "max_feed_mm_min" if "machine.max_feed_mm_min" in self._parameters else "rapid_mm_min"
        most = self._number(f"machine.{key}")
        if most is not None and step.feed_mm_min > most * (1.0 + 1e-9):
            self._note("feed", step, step.feed_mm_min, f"F{step.feed_mm_min:g} is above machine.{key} = {most:g}")
        fastest = self._number("machine.max_spindle_rpm")
        speed = abs(step.spindle_rpm)
        if fastest is not None and speed > fastest:
            self._note("speed", step, speed, f"S{speed:g} is above machine.max_spindle_rpm = {fastest:g}")

    def _check_chip(self, step: Step) -> None:
        diameter, teeth = self._tools[step.tool]
        per_turn = step.feed_mm_min / abs(step.spindle_rpm)
        chip, edge = per_turn / teeth, min(_EDGE_MM, _EDGE_PART * diameter)
        at = f"T{step.tool}: a feed per tooth of {chip:.3g} mm (F{step.feed_mm_min:g} S{abs(step.spindle_rpm):g})"
        if chip > _LARGE_CHIP * 0.5 * diameter:
            self._note(
                "large chip", step, chip, f"{at} is more than a quarter of the tool's radius, {diameter / 2:g} mm"
            )
        elif chip < edge:
            self._note(
                "small chip", step, -chip, f"{at} is below {edge:g} mm, about the radius of a sharp edge: it rubs"
            )
        angle, longest = self._number("simulation.angle_step_deg"), self._number("simulation.step_mm")
        if angle is not None and longest is not None and per_turn * angle / 360.0 > longest:
            travel = per_turn * angle / 360.0
            self._note(
                "travel",
                step,
                travel,
                f"T{step.tool}: the tool travels {travel:.3g} mm between two force samples, more than "
                f"simulation.step_mm = {longest:g}: check F and S",
            )

    def _number(self, key: str) -> float | None:
        value = self._parameters.get(key)
        return None if value is None else float(value)

    def _note(self, kind: str, step: Step, size: float, text: str) -> None:
        doubt = self._doubts.get((kind, step.tool))
        if doubt is None:
            self._doubts[kind, step.tool] = _Doubt(step.nc_line, size, text, last_line=step.nc_line)
            return
        if step.nc_line != doubt.last_line:
            doubt.lines, doubt.last_line = doubt.lines + 1, step.nc_line
        if size > doubt.size:
            doubt.line, doubt.size, doubt.text = step.nc_line, size, text

    def warnings(self, summary: RunSummary) -> Iterator[str]:
        """One line for each doubt.

        Args:
            summary: of the run.
        """
        for doubt in self._doubts.values():
            more = f" (the most of {doubt.lines} such motions)" if doubt.lines > 1 else ""
            yield f"line {doubt.line}: {doubt.text}{more}"
        yield from self._range.warnings()
        if summary.complete:
            yield from self._units(summary)
            yield from self._no_force(summary)

    def _units(self, summary: RunSummary) -> Iterator[str]:
        """A program without G20 and G21 whose path has another size than the stock."""
        path = max(high - low for low, high in zip(self._low, self._high, strict=True))
        if self._states_units or not 0.0 < path < float("inf") or self._stock_mm <= 0.0:
            return
        least, most = (factor * self._stock_mm for factor in _LIKE_STOCK)
        widest = max((diameter for diameter, _ in self._tools.values()), default=0.0)
        sizes = f"the feed motions extend over {path:.3g} mm, the stock over {self._stock_mm:.3g} mm"
        small = path * _OTHER_UNITS < self._stock_mm and (path < widest or summary.removed_volume_mm3 <= 0.0)
        if self._parameters.get("program.units") != "inch":
            if small and least <= path * _INCH_MM <= most:
                yield f'{sizes}, and the program has no G20 or G21; for a program in inches set program.units = "inch"'
        elif path > _OTHER_UNITS * self._stock_mm and least <= path / _INCH_MM <= most:
            yield f'{sizes}, and the program has no G20 or G21; for a program in mm set program.units = "mm"'

    def _no_force(self, summary: RunSummary) -> Iterator[str]:
        with_forces = any("cutting.Ktc" in key for key in self._parameters)
        if with_forces and summary.cutting_time_s > 0.0 and summary.peak_force_n[3] == 0.0:
            yield (
                f"{summary.removed_volume_mm3:.3g} mm3 were removed without any force: "
                "check the cutting coefficients, F and S"
            )
