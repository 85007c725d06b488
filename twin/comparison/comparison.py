"""Comparison of a run with a log: corrections in order, then errors in every window."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from os import PathLike
from pathlib import Path

import numpy as np

from twin.arrays import FloatArray, frozen
from twin.comparison import checks
from twin.comparison.delay import Delay, find_delay
from twin.comparison.harmonics import Line, lines
from twin.comparison.metrics import AxisErrors, axis_errors
from twin.comparison.phase import best_shift
from twin.comparison.run_forces import RunForces, read_run_forces
from twin.errors import CompareError
from twin.measured.axes import mirrored
from twin.measured.filters import filtered
from twin.measured.forces import read_forces
from twin.measured.log import AXES, Correction, ForceLog, Gap
from twin.measured.settings import CompareSettings
from twin.measured.spindle import SpindleSpeed, spindle_speed
from twin.measured.uniform import outside_gaps, resample, uniform
from twin.measured.zero import offset_of, remove_drift, shift_zero


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class WindowResult:
    """One window.

    Attributes:
        span_s: begin and end on the run's clock.
        whole: whether it is the whole overlap because none was given.
        t_s: shape (n,), the samples' times on the run's clock.
        measured_n, simulated_n: shape (n, 3).
        spindle_angle_rad: shape (n,), of the simulation.
        shift_s: further shift of the measurement by ``phase``, 0 without.
        rpm, teeth: spindle speed of the run and teeth of the tool that cuts most; None in air.
        errors: of each measured axis, then of the resultant.
        lines: harmonics, see `twin.comparison.harmonics`.
    """

    span_s: Gap
    whole: bool
    t_s: FloatArray
    measured_n: FloatArray
    simulated_n: FloatArray
    spindle_angle_rad: FloatArray
    shift_s: float
    rpm: float | None
    teeth: int | None
    errors: tuple[AxisErrors, ...]
    lines: tuple[Line, ...]

    def of(self, axis: str) -> AxisErrors:
        """The errors of one axis."""
        return next(e for e in self.errors if e.axis == axis)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Comparison:
    """Result of a comparison.

    Attributes:
        log: as corrected, on its own clock.
        lag_s: run time = log time - lag.
        delay: result of the search for the lag, None where it was given.
        t_s: shape (n,), samples of the overlap on the run's clock, without gaps.
        measured_n, simulated_n: shape (n, 3).
        speed: measured spindle speed, None where it cannot be determined.
        corrections: all, in order; also on the log itself.
        warnings: possible mistakes.
    """

    run: RunForces
    log: ForceLog
    settings: CompareSettings
    lag_s: float
    delay: Delay | None
    score: float
    t_s: FloatArray
    measured_n: FloatArray
    simulated_n: FloatArray
    speed: SpindleSpeed | None
    windows: tuple[WindowResult, ...]
    corrections: tuple[Correction, ...]
    warnings: tuple[str, ...]


def compare_files(run: str | PathLike[str], measured: str | PathLike[str], settings: CompareSettings) -> Comparison:
    """Compare an archived run with a measured log.

    Raises:
        ArchiveError, MeasuredError, CompareError: a file that cannot be read, or the two do not fit.
    """
    log = read_forces(measured, settings)
    return compare(read_run_forces(Path(run)), log, settings)


def compare(run: RunForces, log: ForceLog, settings: CompareSettings) -> Comparison:
    """Compare a log with a run.

    The order is: rate, filters, delay, zero (and the delay again after a drift was subtracted), windows.

    Raises:
        CompareError: no overlap; forces in a wrong unit; a window outside; no air for the zero.
        MeasuredError: a filter or rate that does not fit.
    """
    warnings = [*mirrored(settings.axis_map, settings.force_on), *checks.check_units(run, log, settings)]
    rpm, teeth = run.speed_in(run.span_s) or (0.0, 1)
    log = uniform(log)
    speed = spindle_speed(log, teeth, rpm) if rpm else None
    if rpm:
        warnings += [*checks.check_rate(log, rpm, teeth), *checks.check_speed(log, speed, rpm)]
    log = _in_band(log, settings)
    lag_s, delay = _lag(run, log, settings)
    if settings.drift or settings.zero != "none":
        log = _zeroed(run, log, lag_s, settings)
        if settings.drift and delay is not None:
            lag_s, delay = _lag(run, log, settings)
    log = replace(log, corrections=(*log.corrections, _lag_record(lag_s, delay)))
    overlap = checks.check_overlap(run, log, lag_s)
    both = _Both.of(run, log, lag_s, settings)
    score = _score(both, log)
    if delay is not None:
        warnings += checks.check_delay(delay, log)
    warnings += checks.check_fit(run, log, score, _score(both, log, centred=False), settings)
    windows = tuple(_windows(run, log, both, overlap, settings))
    return Comparison(
        run=run,
        log=log,
        settings=settings,
        lag_s=lag_s,
        delay=delay,
        score=score,
        t_s=both.t_s,
        measured_n=both.measured_n,
        simulated_n=both.simulated_n,
        speed=speed,
        windows=windows,
        corrections=(*log.corrections, *_phase_records(windows, settings)),
        warnings=tuple(warnings),
    )


def _in_band(log: ForceLog, settings: CompareSettings) -> ForceLog:
    """Another rate, then the filters."""
    if settings.resample_hz is not None:
        log = resample(log, settings.resample_hz)
    for each in settings.filters:
        log = filtered(log, each)
    return log


def _lag(run: RunForces, log: ForceLog, settings: CompareSettings) -> tuple[float, Delay | None]:
    if settings.lag_s is not None:
        return settings.lag_s, None
    delay = find_delay(run, log, settings.lag_within_s, settings.spans)
    return delay.lag_s, delay


def _lag_record(lag_s: float, delay: Delay | None) -> Correction:
    how = "as given" if delay is None else f"by cross-correlation, coefficient {delay.score:.4f}"
    late = "late" if lag_s >= 0.0 else "early"
    return Correction(
        kind="lag",
        text=f"log {abs(lag_s):.6f} s {late}, {how}: run time = log time {'-' if lag_s >= 0.0 else '+'} that",
        values={"lag_s": lag_s, "found": "given" if delay is None else "auto"},
    )


def _zeroed(run: RunForces, log: ForceLog, lag_s: float, settings: CompareSettings) -> ForceLog:
    """The log without the amplifier's zero or drift."""
    offset = settings.zero
    if isinstance(offset, tuple) and len(offset) == 3:
        log = shift_zero(log, offset)
        if not settings.drift:
            return log
    if isinstance(offset, tuple) and len(offset) == 2:
        air: tuple[Gap, ...] = (offset,)
        where = f"mean of {offset[0]:g} to {offset[1]:g} s of the log"
    else:
        turn_s = max((60.0 / abs(rpm) for rpm in run.steps[:, 2].tolist() if rpm), default=0.02)
        air = tuple((a + lag_s, b + lag_s) for a, b in run.air(1.5 * turn_s, log.duration_s))
        where = "mean while the run cuts nothing"
    if settings.drift:
        return remove_drift(
            log, air if offset in ("none", "air") or len(offset) == 3 else _all_air(run, log, lag_s, air)
        )
    return shift_zero(log, offset_of(log, air).tolist(), where)


def _all_air(run: RunForces, log: ForceLog, lag_s: float, given: tuple[Gap, ...]) -> tuple[Gap, ...]:
    """The segment given, and where the run cuts nothing."""
    turn_s = max((60.0 / abs(rpm) for rpm in run.steps[:, 2].tolist() if rpm), default=0.02)
    return (*given, *((a + lag_s, b + lag_s) for a, b in run.air(1.5 * turn_s, log.duration_s)))


@dataclass(frozen=True, slots=True)
class _Both:
    """Measured and simulated at the log's samples inside the overlap."""

    t_s: FloatArray
    measured_n: FloatArray
    simulated_n: FloatArray
    source: Callable[[FloatArray], FloatArray]

    @classmethod
    def of(cls, run: RunForces, log: ForceLog, lag_s: float, settings: CompareSettings) -> _Both:
        t_s = log.t_s - lag_s
        begin, end = run.span_s
        source = _simulation(run, log, lag_s, settings)
        simulated = source(t_s)
        inside = (t_s >= begin) & (t_s <= end) & outside_gaps(log, log.t_s)
        if inside.sum() < 2:
            raise CompareError(
                f"{log.source}: with a lag of {lag_s:.4f} s the run, {begin:.4f} to {end:.4f} s, lies in a gap of the "
                "log; give the lag with --lag SECONDS, or --lag auto"
            )
        return cls(
            frozen(t_s[inside], "t_s", (None,)),
            frozen(log.force_n[inside], "measured_n", (None, 3)),
            frozen(simulated[inside], "simulated_n", (None, 3)),
            source,
        )


def _simulation(
    run: RunForces, log: ForceLog, lag_s: float, settings: CompareSettings
) -> Callable[[FloatArray], FloatArray]:
    """The run's force at times on the measured axes, through the log's filters where both have them."""
    measured = np.array([axis in log.axes for axis in AXES], float)
    if not settings.filters or not settings.filter_both:
        return lambda t_s: run.at(t_s) * measured
    grid = log.t_s - lag_s
    force = run.at(grid) * measured
    for each in settings.filters:
        force = each.apply(force, log.rate_hz)
    return lambda t_s: np.column_stack([np.interp(t_s, grid, force[:, axis]) for axis in range(3)])


def _score(both: _Both, log: ForceLog, *, centred: bool = True) -> float:
    """Correlation over the whole overlap, all measured axes together, each less its mean or with it."""
    axes = [AXES.index(a) for a in log.axes]
    m, s = both.measured_n[:, axes], both.simulated_n[:, axes]
    if centred:
        m, s = m - m.mean(axis=0), s - s.mean(axis=0)
    power = float(np.sqrt(np.sum(m * m) * np.sum(s * s)))
    return float(np.sum(m * s)) / power if power > 0.0 else 0.0


def _windows(
    run: RunForces, log: ForceLog, both: _Both, overlap: Gap, settings: CompareSettings
) -> Iterator[WindowResult]:
    for span in settings.spans or (overlap,):
        inside = (both.t_s >= span[0]) & (both.t_s <= span[1])
        if inside.sum() < 2:
            raise CompareError(
                f"window {span[0]:g}:{span[1]:g}: {int(inside.sum())} samples of {log.source} in it, the overlap is "
                f"{overlap[0]:.4f} to {overlap[1]:.4f} s of the run; expected a window inside it"
            )
        yield _window(run, log, both, inside, span, settings)


def _window(
    run: RunForces,
    log: ForceLog,
    both: _Both,
    inside: np.ndarray[tuple[int], np.dtype[np.bool_]],
    span: Gap,
    settings: CompareSettings,
) -> WindowResult:
    t_s, measured, simulated = both.t_s[inside], both.measured_n[inside], both.simulated_n[inside]
    rpm, teeth = run.speed_in(span) or (None, None)
    shift = 0.0
    if settings.phase and rpm:
        shift, simulated = best_shift(both.source, t_s, measured, 60.0 / abs(rpm))
    axes = [AXES.index(a) for a in log.axes]
    errors = [axis_errors(a, measured[:, i], simulated[:, i]) for a, i in zip(log.axes, axes, strict=True)]
    if len(axes) > 1:
        errors.append(axis_errors("resultant", *(np.linalg.norm(v, axis=1) for v in (measured, simulated))))
    found = lines(log.axes, t_s, measured[:, axes], simulated[:, axes], rpm, teeth or 1) if rpm else []
    return WindowResult(
        span_s=span,
        whole=not settings.spans,
        t_s=t_s,
        measured_n=measured,
        simulated_n=simulated,
        spindle_angle_rad=run.angle_at(t_s + shift),
        shift_s=shift,
        rpm=rpm,
        teeth=teeth,
        errors=tuple(errors),
        lines=tuple(found),
    )


def _phase_records(windows: tuple[WindowResult, ...], settings: CompareSettings) -> Iterator[Correction]:
    """The shift of each window."""
    if not settings.phase:
        return
    for w in windows:
        turn = 360.0 * w.shift_s * (w.rpm or 0.0) / 60.0
        yield Correction(
            kind="phase",
            text=f"window {w.span_s[0]:g} to {w.span_s[1]:g} s: simulation {1e3 * w.shift_s:+.4f} ms "
            f"({turn:+.1f}° of the spindle) to the measured phase",
            values={"begin_s": w.span_s[0], "end_s": w.span_s[1], "shift_s": w.shift_s, "angle_deg": turn},
        )
