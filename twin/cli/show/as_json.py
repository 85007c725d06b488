"""Results as JSON objects: every number finite or null, units in the names."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from twin.cli.show.summary import mean_force
from twin.record import Collision, RunSummary, ToolSummary

if TYPE_CHECKING:
    from twin.archive import RunInfo
    from twin.cli.commands.runs.replay_work import Outcome

_FORCE_NAMES = ("x", "y", "z", "resultant")


def replay_object(outcome: Outcome, force_on: str) -> dict[str, Any]:
    """A replay: its summary, how fast it was, its collisions and warnings."""
    summary, wall_s = outcome.summary, outcome.wall_time_s
    header = outcome.watch.header
    return {
        "program": header.program if header is not None else None,
        **summary_object(summary, force_on),
        "wall_time_s": wall_s,
        "setup_time_s": outcome.setup_time_s,
        "real_time_factor": summary.machine_time_s / wall_s if wall_s > 0.0 else None,
        "collision_list": [_collision(c) for c in outcome.watch.collisions],
        "warnings": outcome.watch.warnings(summary),
    }


def info_object(info: RunInfo, force_on: str) -> dict[str, Any]:
    """A run's file."""
    header = info.header
    return {
        "file": str(info.path),
        "size_bytes": info.path.stat().st_size,
        "complete": info.complete,
        "intact": info.intact,
        "damage": info.damage,
        "program": header.program,
        "twin_version": header.twin_version,
        "planned_time_s": header.planned_time_s,
        "duration_s": info.duration_s,
        "stock_bounds_mm": header.stock_bounds_mm.tolist(),
        "slice_pitch_mm": list(header.slice_pitch_mm),
        "tools": [{"number": t.number, "description": t.description} for t in header.tools],
        "messages": info.counts,
        "attachments": info.attachments,
        "parameters": header.parameters,
        "summary": None if info.summary is None else summary_object(info.summary, force_on),
    }


def summary_object(summary: RunSummary, force_on: str) -> dict[str, Any]:
    """Sums of a run; forces are null where none were computed."""
    computed = summary.samples > 0
    return {
        "complete": summary.complete,
        "machine_time_s": summary.machine_time_s,
        "cutting_time_s": summary.cutting_time_s,
        "removed_volume_mm3": summary.removed_volume_mm3,
        "steps": summary.steps,
        "samples": summary.samples,
        "force_on": force_on,
        "peak_force_n": _force(summary.peak_force_n) if computed else None,
        "mean_force_n": _force(mean_force(summary.mean_force_n, force_on)) if computed else None,
        "collisions": summary.collisions,
        "tools": [_tool(tool, computed, force_on) for tool in summary.tools],
        "top_lines": [{"nc_line": n, "text": text, "force_n": f} for n, text, f in summary.top_lines],
        "digest": summary.digest,
    }


def _tool(tool: ToolSummary, computed: bool, force_on: str) -> dict[str, Any]:
    return {
        "number": tool.number,
        "description": tool.description,
        "cutting_time_s": tool.cutting_time_s,
        "air_time_s": tool.air_time_s,
        "rapid_time_s": tool.rapid_time_s,
        "removed_volume_mm3": tool.removed_volume_mm3,
        "removal_rate_mm3_min": 60.0 * tool.removed_volume_mm3 / tool.cutting_time_s if tool.cutting_time_s else None,
        "peak_force_n": _force(tool.peak_force_n) if computed else None,
        "mean_force_n": _force(mean_force(tool.mean_force_n, force_on)) if computed else None,
        "peak_torque_nm": tool.peak_torque_nm if computed else None,
        "mean_torque_nm": tool.mean_torque_nm if computed else None,
        "peak_power_w": tool.peak_power_w if computed else None,
        "peak_line": tool.peak_line if computed else None,
    }


def _force(four: tuple[float, float, float, float]) -> dict[str, float]:
    return dict(zip(_FORCE_NAMES, four, strict=True))


def _collision(collision: Collision) -> dict[str, Any]:
    return {
        "t_s": collision.t_s,
        "nc_line": collision.nc_line,
        "tool": collision.tool,
        "kind": collision.kind,
        "point_mm": list(collision.point_mm),
        "volume_mm3": collision.volume_mm3,
        "message": collision.message,
    }
