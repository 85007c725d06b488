"""A coefficient set as text: a `[cutting]` table for a job file, with what is known about it."""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np

from gcode.underline import harmless
from twin.errors import IdentifyError
from twin.identification.fit.least_squares import CONFIDENCE
from twin.identification.models.straight import NAMES
from twin.identification.result import Identified
from twin.settings.toml_text import toml_text

_UNITS = {name: "N/mm2" if name.endswith("c") else "N/mm" for name in NAMES}
_DIGITS = 7


def source_of(result: Identified) -> str:
    """Source of the coefficients."""
    fitted = [cut for cut in result.cuts if not cut.held_out]
    origin = f"twin identify, method {result.method}, {len(fitted)} cuts of {result.file.name}"
    return f"{result.source} ({origin})" if result.source else origin


def coefficients_toml(result: Identified) -> str:
    """The file's text; it can be appended to a job file as is.

    Raises:
        IdentifyError: a coefficient that the cuts do not determine, or a set that no job may have.
    """
    estimate = result.estimate
    lost = [name for name, known in zip(NAMES, estimate.determined, strict=True) if not known]
    if lost:
        raise IdentifyError(
            f"{result.file}: no coefficient set written: {', '.join(lost)} not determined by these cuts; "
            "add cuts with other feeds and depths, or give them in fit.fixed"
        )
    if estimate.values[0] < 0.0:
        raise IdentifyError(
            f"{result.file}: no coefficient set written: Ktc = {estimate.values[0]:.4g} N/mm2, expected at least 0: "
            "check map, force_on and direction"
        )
    cutting: dict[str, object] = {
        name: _rounded(value) for name, value in zip(NAMES, estimate.values.tolist(), strict=True)
    }
    cutting |= {"source": source_of(result), "convention": "meridian"}
    if np.isfinite(estimate.errors).all():
        cutting["standard_errors"] = [_rounded(e) for e in estimate.errors.tolist()]
        if not estimate.fixed.any():
            cutting["correlation"] = [[round(c, 4) for c in row] for row in estimate.correlation.tolist()]
    comment = "".join(f"# {harmless(' '.join(line.splitlines()))}\n" for line in _comment(result))
    return comment + "\n" + toml_text({"cutting": cutting})


def _comment(result: Identified) -> Iterator[str]:
    estimate = result.estimate
    yield "Cutting coefficients; this table can be copied into a job file as is."
    yield f"{100 * CONFIDENCE:g} % intervals, {estimate.dof} degrees of freedom:"
    for i, name in enumerate(NAMES):
        half = float(estimate.half_widths[i])
        interval = "given, not fitted" if estimate.fixed[i] else f"± {half:.4g}" if math.isfinite(half) else "± unknown"
        yield f"  {name} = {estimate.values[i]:.6g} {_UNITS[name]} {interval}"
    yield f"R2 {result.r_squared[0]:.5f}, condition number {estimate.condition:.3g}"
    if result.runout is not None:
        degrees = math.degrees(result.runout.angle_rad)
        yield f"runout of the cutter in these cuts: {result.runout.size_mm:.5f} mm at {degrees:.1f} deg"
    yield "standard_errors and correlation are in the order " + ", ".join(NAMES) + "."
    held_out = [cut.name for cut in result.cuts if cut.held_out]
    yield "fitted: " + ", ".join(cut.name for cut in result.cuts if not cut.held_out)
    if held_out:
        yield "held out: " + ", ".join(held_out)
    yield from (f"warning: {line}" for line in result.warnings)


def _rounded(value: float) -> float:
    return float(f"{value:.{_DIGITS}g}")
