"""Warnings: coefficients that the cuts cannot determine, and implausible results."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence

import numpy as np

from twin.identification.cuts.cuts_file import Cuts
from twin.identification.cuts.measure import SPEED_DOUBT
from twin.identification.fit.least_squares import Estimate
from twin.identification.models.straight import NAMES
from twin.identification.result import CutResult
from twin.measured.axes import mirrored

#: Condition numbers above make coefficients follow each other; nine cuts with three feeds and three depths have 6.
_CONDITION = 30.0
#: Two coefficients whose errors are this much correlated cannot be told apart well.
_CORRELATION = 0.98
#: Ktc of metals and plastics lies between, N/mm2.
_PLAUSIBLE_KTC = (20.0, 20000.0)
#: Mean forces above this in N, or all below that, speak of another unit.
_PLAUSIBLE_N = (0.01, 100_000.0)
#: Waveforms repeat with each tooth but for this part of their size, or the teeth do not cut alike.
_ALIKE = 0.15
#: Forces that follow the model have an R2 above.
LEAST_FIT = 0.9
#: Samples in one tooth passing below which means may be off.
_LEAST_SAMPLES = 2.0


def doubts(
    cuts: Cuts,
    estimate: Estimate,
    results: Sequence[CutResult],
    at_bounds: Sequence[str],
    *,
    runout: bool,
    r_squared: float,
) -> Iterator[str]:
    """One line for each.

    Args:
        at_bounds: coefficients on a bound of the search.
        runout: whether it was found.
        r_squared: of all that was fitted.
    """
    yield from _undetermined(cuts, estimate)
    yield from _uncertain(estimate)
    yield from _implausible(estimate, results)
    yield from _logs(cuts, results)
    yield from _runout(cuts, results, runout)
    if r_squared < LEAST_FIT:
        yield (
            f"R2 = {r_squared:.3f}, expected above {LEAST_FIT:g}: forces do not follow the model; check map, force_on, "
            "direction, depths, teeth and helix; fit.lowpass_hz excludes a resonance of the dynamometer"
        )
    if at_bounds:
        yield f"{', '.join(at_bounds)}: at a bound of the search; widen fit.lower and fit.upper, or check the cuts"


def _logs(cuts: Cuts, results: Sequence[CutResult]) -> Iterator[str]:
    """Warnings about the logs."""
    teeth = cuts.tool.teeth if cuts.tool is not None else 1
    yield from dict.fromkeys(text for cut in cuts.cuts for text in mirrored(cut.axis_map, cut.force_on))
    no_air = [r.name for r in results if any("no air found" in note for note in r.measured.notes)]
    if no_air:
        yield (
            f"{', '.join(no_air)}: no air in the log, zero not corrected: "
            "an offset of the amplifier counts as force, mostly as edge force"
        )
    for r in results:
        if r.measured.samples_per_rev < _LEAST_SAMPLES * teeth:
            yield (
                f"{r.name}: {r.measured.samples_per_rev:.2f} samples per revolution, expected more than "
                f"{_LEAST_SAMPLES * teeth:g} (twice the tooth-passing frequency): its mean may be off"
            )
        yield from (f"{r.name}: {note}" for note in r.measured.notes if note.startswith(SPEED_DOUBT))


def _runout(cuts: Cuts, results: Sequence[CutResult], found: bool) -> Iterator[str]:
    """Teeth that do not cut alike where the fit supposes that they do."""
    tool = cuts.tool
    if tool is None or found or tool.teeth < 2 or tool.runout_mm > 0.0 or tool.pitch_deg is not None:
        return
    worst = max(((_unlike(r, tool.teeth), r.name) for r in results if not r.held_out), default=(0.0, ""))
    if worst[0] > _ALIKE:
        yield (
            f"{worst[1]}: {100.0 * worst[0]:.0f} % of the variation of the force does not repeat with each tooth: "
            "runout; it reduces contact in thin chips and biases the edge coefficients; "
            "find it with --method waveform --runout, or give tool.runout_mm"
        )


def _unlike(result: CutResult, teeth: int) -> float:
    """Size of the harmonics between multiples of the tooth-passing frequency, relative to these multiples."""
    c = result.measured.harmonics
    if c is None or len(c) <= teeth:
        return 0.0
    power = (np.abs(c[:, result.measured.axes]) ** 2).sum(axis=1)
    with_teeth = float(power[teeth::teeth].sum())
    return math.sqrt(float(power[1:].sum() - with_teeth) / with_teeth) if with_teeth > 0.0 else 0.0


def _undetermined(cuts: Cuts, estimate: Estimate) -> Iterator[str]:
    lost = [name for name, known in zip(NAMES, estimate.determined, strict=True) if not known]
    if lost:
        straight = [c for c in cuts.cuts if c.name not in cuts.held_out and c.feed_mm_min and c.spindle_rpm]
        per_rev = {round(c.feed_mm_min / c.spindle_rpm, 9) for c in straight if c.feed_mm_min and c.spindle_rpm}
        why = "all have the same feed per tooth, and c and e need two" if len(per_rev) == 1 else "they are too similar"
        yield (
            f"{', '.join(lost)}: not determined by these cuts ({estimate.rank} independent equations for "
            f"{int((~estimate.fixed).sum())} coefficients): {why}; add cuts, or give some in fit.fixed"
        )
    elif estimate.dof <= 0:
        yield "as many coefficients as equations: standard errors cannot be determined; add cuts"
    elif estimate.condition > _CONDITION:
        yield (
            f"condition number {estimate.condition:.0f} (expected below {_CONDITION:g}): the cuts are too similar, "
            "so errors in forces are magnified; add feeds and depths that differ more"
        )


def _uncertain(estimate: Estimate) -> Iterator[str]:
    for i, name in enumerate(NAMES):
        value, half = float(estimate.values[i]), float(estimate.half_widths[i])
        if estimate.fixed[i] or not (math.isfinite(value) and math.isfinite(half)):
            continue
        if half > abs(value):
            yield f"{name} = {value:.4g} ± {half:.2g}: the interval contains zero"
    correlation = estimate.correlation
    for i in range(len(NAMES)):
        for j in range(i):
            if abs(correlation[i, j]) > _CORRELATION:
                yield (
                    f"{NAMES[j]} and {NAMES[i]}: errors correlated by {correlation[i, j]:+.3f}, "
                    "only a combination of the two is known well"
                )


def _implausible(estimate: Estimate, results: Sequence[CutResult]) -> Iterator[str]:
    ktc = float(estimate.values[0])
    means = np.concatenate([r.measured.mean_n[r.measured.axes] for r in results])
    largest = float(np.abs(means).max())
    if ktc < 0.0:
        yield (
            f"Ktc = {ktc:.4g} N/mm2, expected above 0: check map (signs, swapped axes), force_on, direction; "
            "a dynamometer under the part measures the force on the workpiece"
        )
    elif math.isfinite(ktc) and not _PLAUSIBLE_KTC[0] <= ktc <= _PLAUSIBLE_KTC[1]:
        yield (
            f"Ktc = {ktc:.4g} N/mm2, expected {_PLAUSIBLE_KTC[0]:g} to {_PLAUSIBLE_KTC[1]:g}: "
            "check the unit of the forces (N, kN) and the feeds"
        )
    elif not _PLAUSIBLE_N[0] <= largest <= _PLAUSIBLE_N[1]:
        yield f"largest mean force {largest:.3g} N: check the unit of the forces"
