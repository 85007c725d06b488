"""The result of a comparison as one or two sentences: level, peaks, waveform, and where it is worst."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from twin.comparison.comparison import Comparison, WindowResult
from twin.comparison.metrics import AxisErrors
from twin.number_format import plural


def verdict(found: Comparison) -> str:
    """Mean and peak of the simulated force by the measured, RMS error, worst axis; a hint at warnings.

    The force is the resultant, or the axis if only one was measured. Of several windows the ranges are given.
    """
    totals = [w.errors[-1] for w in found.windows]
    name = "force" if totals[0].axis == "resultant" else f"F{totals[0].axis}"
    where = "" if len(totals) == 1 else f"Over {len(totals)} windows, "
    sentence = f"{where}simulated relative to measured: mean {name} {_changes(e.ratio_of_means for e in totals)}, "
    sentence += f"peak {_changes(e.ratio_of_peaks for e in totals)}; RMS error {_shares(totals)} of the measured RMS"
    text = f"{sentence[0].upper()}{sentence[1:]}{_worst(found.windows)}."
    if found.warnings:
        count = len(found.warnings)
        text += f" {plural(count, 'warning').capitalize()} {'says' if count == 1 else 'say'} why this may be doubtful."
    return text


def _worst(windows: Sequence[WindowResult]) -> str:
    """The axis and window with the largest RMS error in N; nothing where there is no choice."""
    axes = [(e, w) for w in windows for e in w.errors if e.axis != "resultant" and e.rms_by_rms is not None]
    if len(axes) < 2:
        return ""
    errors, window = max(axes, key=lambda each: each[0].rms_n)
    within = f" in {window.span_s[0]:.2f}–{window.span_s[1]:.2f} s" if len(windows) > 1 else ""
    return f", largest in F{errors.axis}{within}: {errors.rms_n:.3g} N, {_percent(errors.rms_by_rms)} of its RMS"


def _changes(ratios: Iterable[float | None]) -> str:
    """Ratios as changes: ``+3.1 %``, ``-2.0 to +3.1 %``; between no forces none is known."""
    known = [100.0 * (r - 1.0) for r in ratios if r is not None]
    if not known:
        return "not comparable"
    low, high = min(known), max(known)
    return f"{_signed(high)} %" if _signed(low) == _signed(high) else f"{_signed(low)} to {_signed(high)} %"


def _signed(change: float) -> str:
    text = f"{change:+.1f}".replace("-", "−")
    return "±0.0" if text in ("+0.0", "−0.0") else text


def _shares(totals: Sequence[AxisErrors]) -> str:
    known = [e.rms_by_rms for e in totals if e.rms_by_rms is not None]
    if not known:
        return "not comparable"
    low, high = _percent(min(known)), _percent(max(known))
    return high if low == high else f"{low.removesuffix(' %')} to {high}"


def _percent(share: float | None) -> str:
    return "–" if share is None else f"{100.0 * share:.1f} %"
