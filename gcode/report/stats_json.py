"""Program statistics as one JSON object, as `gcode stats --json` prints it."""

from __future__ import annotations

from typing import Any

from gcode.report.stats import Box, MotionTotals, ProgramStats, ValueSet


def stats_object(stats: ProgramStats) -> dict[str, Any]:
    """Statistics of a program as a JSON object; units are in the names, and missing values are null."""
    return {
        **_sums(stats.total),
        "rapid_mm_min": stats.rapid_mm_min,
        "cutting_box_mm": _box(stats.cutting_box),
        "box_mm": _box(stats.box),
        "blocks": stats.blocks,
        "tool_changes": stats.tool_changes,
        "untimed_motions": stats.untimed,
        "notices": stats.notices,
        "tools": [{"tool": number, **_sums(sums)} for number, sums in stats.tools.items()],
    }


def _sums(sums: MotionTotals) -> dict[str, Any]:
    return {
        "travel_mm": sums.travel_mm,
        "cutting_mm": sums.cutting_mm,
        "rapid_mm": sums.rapid_mm,
        "time_s": sums.time_s,
        "cutting_s": sums.cutting_s,
        "rapid_s": sums.rapid_s,
        "dwell_s": sums.dwell_s,
        "motions": dict(sums.motions),
        "feeds_mm_min": _values(sums.feeds_mm_min),
        "speeds_rpm": _values(sums.speeds_rpm),
    }


def _values(values: ValueSet | None) -> dict[str, Any] | None:
    if values is None:
        return None
    each = None if values.each is None else list(values.each)
    return {"least": values.least, "largest": values.largest, "each": each}


def _box(box: Box | None) -> dict[str, Any] | None:
    if box is None:
        return None
    return {"low": list(box.low_mm), "high": list(box.high_mm), "size": list(box.size_mm)}
