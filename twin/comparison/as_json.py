"""A comparison as a JSON object: every number finite or null, units in the names."""

from __future__ import annotations

import math
from dataclasses import asdict
from typing import Any

from twin.comparison.comparison import Comparison, WindowResult
from twin.comparison.verdict import verdict


def comparison_object(found: Comparison) -> dict[str, Any]:
    """Files, corrections, warnings, and for each window errors and harmonics."""
    log = found.log
    made = {
        "run": str(found.run.path),
        "run_program": found.run.header.program,
        "run_digest": found.run.digest,
        "measured": str(log.source),
        "force_on": "tool",
        "axes": {axis: channel for axis, channel in zip("xyz", log.channels, strict=True) if channel},
        "rate_hz": log.rate_hz,
        "lag_s": found.lag_s,
        "lag_found": found.delay is not None,
        "correlation": found.score,
        "verdict": verdict(found),
        "overlap_s": [float(found.t_s[0]), float(found.t_s[-1])] if len(found.t_s) else None,
        "samples": len(found.t_s),
        "measured_rpm": found.speed.rpm if found.speed else None,
        "notes": list(log.notes),
        "corrections": [asdict(c) for c in found.corrections],
        "warnings": list(found.warnings),
        "windows": [_window(w) for w in found.windows],
    }
    return {key: _finite(value) for key, value in made.items()}


def _window(window: WindowResult) -> dict[str, Any]:
    return {
        "begin_s": window.span_s[0],
        "end_s": window.span_s[1],
        "whole_overlap": window.whole,
        "samples": len(window.t_s),
        "shift_s": window.shift_s,
        "rpm": window.rpm,
        "teeth": window.teeth,
        "errors": {e.axis: {k: v for k, v in asdict(e).items() if k != "axis"} for e in window.errors},
        "harmonics": [asdict(line) for line in window.lines],
    }


def _finite(value: Any) -> Any:
    """Numbers that JSON does not have become null."""
    if isinstance(value, float):
        return value if math.isfinite(value) else None
    if isinstance(value, dict):
        return {k: _finite(v) for k, v in value.items()}
    if isinstance(value, list | tuple):
        return [_finite(v) for v in value]
    return value
