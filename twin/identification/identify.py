"""Identification on one page: file of cuts -> models and measurements -> fit -> coefficients and errors."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from twin.arrays import FloatArray
from twin.comparison.delay import find_delay
from twin.errors import CompareError, IdentifyError, MeasuredError
from twin.identification.cuts.axes_hint import other_axes
from twin.identification.cuts.cuts_file import Cut, Cuts
from twin.identification.cuts.fit_settings import Method
from twin.identification.cuts.measure import Measured, given_mean, log_of, measure, straight_window
from twin.identification.doubts import LEAST_FIT, doubts
from twin.identification.fit.least_squares import Estimate, fixed_values
from twin.identification.fit.means import START, equations, fit_means, search_means
from twin.identification.fit.waveform import Waveforms, fit_waveforms, measured_harmonics
from twin.identification.models.job_model import JobRun, replay_units
from twin.identification.models.model import Model, pass_model
from twin.identification.models.straight import reach_mm
from twin.identification.result import CutResult, Identified, Runout
from twin.measured.log import ForceLog
from twin.measured.steady import find_cut
from twin.measured.uniform import uniform


@dataclass(frozen=True, slots=True, eq=False)
class Prepared:
    """One cut ready to be fitted."""

    cut: Cut
    held_out: bool
    model: Model
    measured: Measured


def prepare(cuts: Cuts, report: Callable[[str], None] = lambda _: None) -> list[Prepared]:
    """Read the logs and make the models of all cuts.

    Args:
        report: called with a line about the present task.

    Raises:
        TwinError, gcode.errors.GcodeError: a log or job that cannot be used; the message names it.
    """
    made = []
    for cut in cuts.cuts:
        report(f"{cut.name}: {'replaying its job' if cut.job else 'reading' if cut.log else 'mean force'}")
        try:
            made.append(_job_cut(cuts, cut) if cut.job is not None else _straight_cut(cuts, cut))
        except (MeasuredError, CompareError, IdentifyError) as error:
            raise IdentifyError(f"{cuts.path}: cut {cut.name}: {error}") from error
    return made


def identify(cuts: Cuts, method: Method | None = None, report: Callable[[str], None] = lambda _: None) -> Identified:
    """Find the cutting coefficients.

    Args:
        method: in place of the file's.
        report: called with a line about the present task.

    Raises:
        TwinError, gcode.errors.GcodeError: see `prepare`; or cuts that the method cannot use.
    """
    return identify_prepared(cuts, prepare(cuts, report), method, report)


def identify_prepared(
    cuts: Cuts, prepared: list[Prepared], method: Method | None = None, report: Callable[[str], None] = lambda _: None
) -> Identified:
    """The same with cuts that `prepare` made."""
    method = method or cuts.fit.method
    fitted = [p for p in prepared if not p.held_out]
    report(f"fitting {len(fitted)} cuts ({method})")
    if method == "waveform":
        return _by_waveforms(cuts, prepared, fitted)
    given = equations([p.model for p in fitted], [p.measured for p in fitted], cuts.fit)
    evaluations, at_bounds = 0, tuple[str, ...]()
    if method == "mean":
        estimate = fit_means(given, cuts.fit)
    else:
        search = search_means([p.model for p in fitted], [p.measured for p in fitted], given, cuts.fit)
        estimate, evaluations, at_bounds = search.estimate, search.evaluations, search.at_bounds
    k = estimate.values
    results = tuple(_result(p, k) for p in prepared)
    r_squared = _r_squared(given.values, given.design @ k, given.axis)
    return _result_of(cuts, method, estimate, r_squared, prepared, results, None, evaluations, at_bounds)


def _straight_cut(cuts: Cuts, cut: Cut) -> Prepared:
    tool = cuts.tool
    assert tool is not None and cut.spindle_rpm and cut.feed_mm_min
    model = pass_model(tool, cut, str(cuts.path))
    held_out = cut.name in cuts.held_out
    if cut.log is None:
        return Prepared(cut, held_out, model, given_mean(cut, cut.spindle_rpm))
    log = log_of(cut, cut.spindle_rpm)
    found = find_cut(log.t_s, log.force_n, 60.0 / cut.spindle_rpm, tool.teeth)
    window = straight_window(cut, log, found, reach_mm(model.cut), cut.spindle_rpm, cut.feed_mm_min / 60.0)
    measured = measure(cut, log, found, window, cut.spindle_rpm, tool.teeth, cuts.fit)
    return Prepared(cut, held_out, model.at_speed(cut.feed_mm_min / measured.rpm), measured)


def _job_cut(cuts: Cuts, cut: Cut) -> Prepared:
    assert cut.job is not None
    run = replay_units(cut.job)
    held_out = cut.name in cuts.held_out
    if cut.log is None:
        return Prepared(cut, held_out, run.model(cut.run_window_s or run.cut_s), given_mean(cut, run.rpm))
    log = log_of(cut, run.rpm)
    found = find_cut(log.t_s, log.force_n, 60.0 / run.rpm, run.teeth)
    lag_s, why = _lag(cut, run, log)
    run_window = cut.run_window_s
    if run_window is None:
        inner = (run.cut_s[0] + 60.0 / run.rpm, run.cut_s[1] - 60.0 / run.rpm)
        run_window = (cut.window_s[0] - lag_s, cut.window_s[1] - lag_s) if cut.window_s else inner
    window = cut.window_s or (run_window[0] + lag_s, run_window[1] + lag_s)
    measured = measure(
        cut, log, found, window, run.rpm, run.teeth, cuts.fit, run.seeming_speed(run_window, log.rate_hz)
    )
    note = f"log lags the run by {lag_s:.4f} s, {why}"
    return Prepared(cut, held_out, run.model(run_window), replace(measured, notes=(*measured.notes, note)))


def _lag(cut: Cut, run: JobRun, log: ForceLog) -> tuple[float, str]:
    """Log's time less machine time, and how it is known; not looked for where both windows are given."""
    if cut.lag_s is not None:
        return cut.lag_s, "as given"
    if cut.window_s is not None and cut.run_window_s is not None:
        return 0.5 * sum(cut.window_s) - 0.5 * sum(cut.run_window_s), "by the windows"
    delay = find_delay(run.forces(np.array(START)), uniform(log))
    return delay.lag_s, f"found by correlation with the run, {delay.score:.3f}"


def _by_waveforms(cuts: Cuts, prepared: list[Prepared], fitted: list[Prepared]) -> Identified:
    for p in fitted:
        if p.measured.harmonics is None:
            why = (
                f"its log has {p.measured.samples_per_rev:.1f} samples per revolution, too few for its teeth"
                if p.cut.log
                else "it has a mean force only"
            )
            raise IdentifyError(
                f"{cuts.path}: cut {p.cut.name} has no waveform: {why}; use --method mean, or hold it out"
            )
    if cuts.fit.runout and not all(p.model.has_runout for p in fitted):
        names = ", ".join(p.cut.name for p in fitted if not p.model.has_runout)
        raise IdentifyError(f"{cuts.path}: fit.runout = true: the runout of jobs is in their files ({names})")
    angles = [p.cut.spindle_angle_deg for p in fitted]
    together = Waveforms(
        [p.model for p in fitted],
        [p.measured for p in fitted],
        np.radians([math.nan if a is None else a for a in angles]),
        fixed_values(cuts.fit.fixed),
        _sector(cuts),
    )
    by_means = fit_means(equations(together.models, together.measured, cuts.fit), cuts.fit)
    guesses = [by_means.values] if by_means.determined.all() else []
    found = fit_waveforms(together, guesses, runout=cuts.fit.runout)
    k, runout_mm = found.estimate.values, found.runout_mm
    phases = dict(zip([p.cut.name for p in fitted], found.phases.tolist(), strict=True))
    results = tuple(_with_waveform(p, k, runout_mm, phases.get(p.cut.name)) for p in prepared)
    values = together.values()
    axis = np.concatenate(
        [np.repeat(np.flatnonzero(m.axes), 2 * len(measured_harmonics(m)) - 1) for m in together.measured]
    )
    r_squared = _r_squared(values, together.design(found.phases, runout_mm) @ k, axis.astype(np.float64))
    return _result_of(
        cuts, "waveform", found.estimate, r_squared, prepared, results, found.runout, found.evaluations, ()
    )


def _sector(cuts: Cuts) -> float:
    tool = cuts.tool
    even = tool is not None and (tool.pitch_deg is None or np.ptp(tool.pitch_deg) < 1e-9)
    return 2.0 * math.pi / tool.teeth if tool is not None and even else 2.0 * math.pi


def _result(p: Prepared, k: FloatArray) -> CutResult:
    return CutResult(name=p.cut.name, held_out=p.held_out, measured=p.measured, fitted_n=p.model.means() @ k)


def _with_waveform(p: Prepared, k: FloatArray, runout_mm: FloatArray | None, phase_rad: float | None) -> CutResult:
    """A cut with its waveform at the phase that was fitted; of one held out, at the phase that suits it best."""
    measured = p.measured
    if measured.harmonics is None or not np.isfinite(k).all():
        return _result(p, k)
    own = runout_mm if p.model.has_runout else None
    if phase_rad is None:
        given = math.nan if p.cut.spindle_angle_deg is None else math.radians(p.cut.spindle_angle_deg)
        alone = Waveforms([p.model], [measured], np.array([given]), k)
        phase_rad = alone.phase(k, own)
    fitted = p.model.harmonics(len(measured.harmonics) - 1, own) @ k
    return CutResult(
        name=p.cut.name,
        held_out=p.held_out,
        measured=measured,
        fitted_n=fitted[0].real,
        fitted_harmonics=fitted,
        phase_rad=phase_rad,
    )


def _r_squared(values: FloatArray, fitted: FloatArray, axis: FloatArray) -> tuple[float, float, float, float]:
    """Coefficient of determination of all values, and of those of x, y and z."""

    def of(which: np.ndarray[tuple[int], np.dtype[np.bool_]]) -> float:
        total = float(np.sum((values[which] - values[which].mean()) ** 2)) if which.any() else 0.0
        return 1.0 - float(np.sum((values[which] - fitted[which]) ** 2)) / total if total > 0.0 else math.nan

    return of(axis >= 0), of(axis == 0), of(axis == 1), of(axis == 2)


def _result_of(
    cuts: Cuts,
    method: Method,
    estimate: Estimate,
    r_squared: tuple[float, float, float, float],
    prepared: list[Prepared],
    results: tuple[CutResult, ...],
    runout: Runout | None,
    evaluations: int,
    at_bounds: tuple[str, ...],
) -> Identified:
    warnings = [*doubts(cuts, estimate, results, at_bounds, runout=runout is not None, r_squared=r_squared[0])]
    if r_squared[0] < LEAST_FIT or estimate.values[0] < 0.0:
        fitted = [p for p in prepared if not p.held_out]
        axes = other_axes([p.model for p in fitted], [p.measured for p in fitted])
        warnings += [f"mean forces would follow the model with {axes} of what the map gives"] if axes else []
    return Identified(
        file=cuts.path,
        method=method,
        estimate=estimate,
        r_squared=r_squared,
        cuts=results,
        runout=runout,
        evaluations=evaluations,
        at_bounds=at_bounds,
        source=cuts.fit.source,
        warnings=tuple(warnings),
    )
