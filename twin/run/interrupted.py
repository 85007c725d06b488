"""The summary of a run whose archive ends before it: summed up from the records that are there."""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import replace

from twin.record import Collision, NcEvent, Record, RunHeader, RunSummary, Step
from twin.simulation.totals import Totals


def summary_of(records: Iterable[Record]) -> RunSummary:
    """Times, forces and collisions of records that end early.

    Returns:
        A summary that is not complete, without digest; the removed volumes, which are in no record, are nan.
    """
    totals = Totals({})
    step_rad = math.radians(1.0)
    for record in records:
        match record:
            case RunHeader():
                totals = Totals({tool.number: tool.description for tool in record.tools})
                step_rad = math.radians(float(record.parameters.get("simulation.angle_step_deg", 1.0)))
            case NcEvent(kind="block"):
                totals.set_block(record.text)
            case Step():
                totals.add_step(record, step_rad / _speed_rad_s(record) if record.spindle_rpm else 0.0)
            case Collision():
                totals.collisions += 1
    total = totals.summary(complete=False, areas_mm2=(), removed_mm3={})
    tools = tuple(replace(tool, removed_volume_mm3=math.nan) for tool in total.tools)
    return replace(total, digest="", removed_volume_mm3=math.nan, tools=tools)


def _speed_rad_s(step: Step) -> float:
    return abs(step.spindle_rpm) * 2.0 * math.pi / 60.0
