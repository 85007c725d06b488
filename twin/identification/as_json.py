"""A result as a JSON object: every number finite or null, units in the names."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from twin.identification.coefficients_toml import source_of
from twin.identification.models.straight import NAMES
from twin.identification.result import CutResult, Identified


def identified_object(result: Identified) -> dict[str, Any]:
    """All of a result."""
    e = result.estimate
    runout = result.runout
    return {
        "cuts_file": str(result.file),
        "method": result.method,
        "coefficients": _named(e.values),
        "standard_errors": _named(e.errors),
        "interval_95": {
            name: [_number(e.values[i] - e.half_widths[i]), _number(e.values[i] + e.half_widths[i])]
            for i, name in enumerate(NAMES)
        },
        "fixed": [name for name, fixed in zip(NAMES, e.fixed, strict=True) if fixed],
        "order": list(NAMES),
        "correlation": [_list(row) for row in e.correlation],
        "convention": "meridian",
        "source": source_of(result),
        "rank": e.rank,
        "condition_number": _number(e.condition),
        "degrees_of_freedom": e.dof,
        "spread_between_cuts_n": _number(e.spread_n),
        "r_squared": dict(zip(("all", "x", "y", "z"), map(_number, result.r_squared), strict=True)),
        "runout": None
        if runout is None
        else {
            "runout_mm": runout.size_mm,
            "runout_angle_deg": math.degrees(runout.angle_rad),
            "half_width_mm": _list(runout.half_width_mm),
        },
        "evaluations": result.evaluations,
        "at_bounds": list(result.at_bounds),
        "cuts": [_cut(cut) for cut in result.cuts],
        "warnings": list(result.warnings),
    }


def _cut(cut: CutResult) -> dict[str, Any]:
    m = cut.measured
    return {
        "name": cut.name,
        "held_out": cut.held_out,
        "spindle_rpm": m.rpm,
        "window_s": None if m.window_s is None else list(m.window_s),
        "measured_mean_n": _list(m.mean_n),
        "standard_error_n": _list(m.error_n),
        "fitted_mean_n": _list(cut.fitted_n),
        "residual_n": _list(cut.residual_n),
        "waveform_rms_error_n": _number(cut.waveform_error_n()),
        "spindle_angle_deg": None if cut.phase_rad is None else math.degrees(cut.phase_rad),
        "zero_n": None if m.zero_n is None else _list(m.zero_n),
        "drift_n_s": None if m.drift_n_s is None else _list(m.drift_n_s),
        "notes": list(m.notes),
    }


def _named(values: ArrayLike) -> dict[str, float | None]:
    return dict(zip(NAMES, _list(values), strict=True))


def _list(values: ArrayLike) -> list[float | None]:
    return [_number(v) for v in np.asarray(values, dtype=np.float64).tolist()]


def _number(value: float | None) -> float | None:
    return value if value is not None and math.isfinite(value) else None
