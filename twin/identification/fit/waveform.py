"""Coefficients from waveforms, with phases and runout as further unknowns.

The forces are linear in the coefficients at given phases and runout, so these alone are searched, and the best
coefficients follow from linear least squares at each trial (variable projection; Golub and Pereyra, 1973). Waveforms
are compared by their harmonics, which is the same as sample by sample over whole revolutions.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy import optimize

from twin.arrays import FloatArray
from twin.identification.cuts.measure import Measured
from twin.identification.fit.harmonics import ComplexArray
from twin.identification.fit.least_squares import Estimate, fit_linear, from_covariance, quantile
from twin.identification.fit.means import START
from twin.identification.models.model import Model
from twin.identification.models.straight import NAMES
from twin.identification.result import Runout

_PHASE_GRID = 720
_ALTERNATIONS = 6
#: Runouts that the search begins with, in feeds per tooth, and directions over half a turn.
_SIZES = (0.15, 0.4)
_DIRECTIONS = 6
_PRECISION = 1e-10
#: A harmonic that alone decides an unknown leaves no residual for its noise.
_LEAST_FREE = 1e-6
_PHASE_STEP_RAD = 1e-5
#: Step of slopes over runout, in feeds per tooth; chips end at places that move with it.
_RUNOUT_STEP = 1e-3


@dataclass(frozen=True, slots=True, eq=False)
class Waveforms:
    """Cuts whose waveforms are fitted together.

    Attributes:
        angle_rad: shape (cuts,), phase where it is given, NaN where it is to be found.
        fixed: shape (6,), see `twin.identification.fit.least_squares.fixed_values`.
        sector_rad: directions of runout that can be distinguished where no phase is given: one pitch if it is constant,
            for any tooth may be called the first; else a full turn.
    """

    models: Sequence[Model]
    measured: Sequence[Measured]
    angle_rad: FloatArray
    fixed: FloatArray
    sector_rad: float = 2.0 * math.pi

    def values(self) -> FloatArray:
        """Shape (m,), the measured waveforms."""
        return np.concatenate([_real(measured_harmonics(m)[:, m.axes]) for m in self.measured])

    def design(self, phases: FloatArray, runout_mm: FloatArray | None) -> FloatArray:
        """Shape (m, 6), the waveforms for unit coefficients."""
        return np.concatenate(
            [
                _real(_turned(model.harmonics(len(measured_harmonics(m)) - 1, runout_mm)[:, m.axes], phase))
                for model, m, phase in zip(self.models, self.measured, phases, strict=True)
            ]
        )

    def slope_over_phase(self, phases: FloatArray, k: FloatArray, runout_mm: FloatArray | None) -> FloatArray:
        """Shape (m, cuts), change of the fitted waveforms with each phase."""
        columns = []
        for model, m, phase in zip(self.models, self.measured, phases, strict=True):
            c = _turned(model.harmonics(len(measured_harmonics(m)) - 1, runout_mm)[:, m.axes], phase) @ k
            columns.append(_real(c * (1j * np.arange(len(c)))[:, None]))
        out = np.zeros((sum(map(len, columns)), len(columns)))
        first = 0
        for j, column in enumerate(columns):
            out[first : first + len(column), j] = column
            first += len(column)
        return out

    def best_phases(self, k: FloatArray, runout_mm: FloatArray | None) -> FloatArray:
        """Shape (cuts,), the phases on a grid at which the waveforms agree best; given ones as given."""
        found = []
        for model, m, given in zip(self.models, self.measured, self.angle_rad, strict=True):
            found.append(float(given) if np.isfinite(given) else _best_phase(model, m, k, runout_mm))
        return np.array(found)

    def phase(self, k: FloatArray, runout_mm: FloatArray | None) -> float:
        """The phase of the only cut at which it fits best with given coefficients."""
        start = self.best_phases(k, runout_mm)
        if np.isfinite(self.angle_rad[0]):
            return float(start[0])
        values, width = self.values(), 2.0 * math.pi / _PHASE_GRID

        def cost(phase: float) -> float:
            return float(np.sum((self.design(np.array([phase]), runout_mm) @ k - values) ** 2))

        bounds = (float(start[0]) - width, float(start[0]) + width)
        return float(optimize.minimize_scalar(cost, bounds=bounds, method="bounded").x)


@dataclass(frozen=True, slots=True, eq=False)
class WaveformFit:
    """Result of the fit.

    Attributes:
        phases: shape (cuts,), spindle angles at the logs' time 0.
        runout_mm: shape (2,), along and across tooth 0; None where the files' own was used.
        runout: the same, human-readable.
        evaluations: how often the forces of all cuts were computed.
    """

    estimate: Estimate
    phases: FloatArray
    runout_mm: FloatArray | None
    runout: Runout | None
    evaluations: int


def fit_waveforms(cuts: Waveforms, guesses: Sequence[FloatArray], *, runout: bool) -> WaveformFit:
    """Least squares on waveforms.

    Args:
        guesses: coefficients, shape (6,), that phases are first looked for with; ordinary ones if there are none.
        runout: whether the runout is unknown.
    """
    search = _Search(cuts, runout)
    starts = [search.settled(k, r) for k in (guesses or [np.array(START)]) for r in search.runouts()]
    best = min(starts, key=search.cost)
    found = search.refined(best)
    return search.result_of(found)


def measured_harmonics(measured: Measured) -> ComplexArray:
    """Shape (count + 1, 3), of a cut that has a waveform."""
    assert measured.harmonics is not None
    return measured.harmonics


def _real(c: ComplexArray) -> FloatArray:
    """Coefficients as numbers whose squares sum to the mean square over a revolution, each column below the last."""
    parts = np.concatenate((c[:1].real, c[1:].real / math.sqrt(2.0), c[1:].imag / math.sqrt(2.0)))
    return np.asarray(np.moveaxis(parts, 0, 1).reshape(parts.shape[0] * parts.shape[1], *parts.shape[2:]))


def _turned(c: ComplexArray, phase_rad: float) -> ComplexArray:
    """The same waveform at a later angle."""
    turn = np.exp(1j * phase_rad * np.arange(len(c)))
    return np.asarray(c * turn.reshape(-1, *([1] * (c.ndim - 1))))


def _best_phase(model: Model, measured: Measured, k: FloatArray, runout_mm: FloatArray | None) -> float:
    """The phase on a grid with the largest correlation of measured and fitted waveform."""
    c = measured_harmonics(measured)[:, measured.axes]
    fitted = model.harmonics(len(c) - 1, runout_mm)[:, measured.axes] @ k
    cross = (np.conj(c) * fitted).sum(axis=1)
    cross[0] = 0.0  # a mean does not depend on the phase
    # the sum of cross[h] exp(i h phase) at all phases of the grid; harmonics beyond its length come round again
    folded = np.zeros(_PHASE_GRID, dtype=np.complex128)
    np.add.at(folded, np.arange(len(cross)) % _PHASE_GRID, cross)
    return float(np.argmax(np.fft.ifft(folded).real) * (2.0 * math.pi / _PHASE_GRID))


class _Search:
    """Trials of phases and runout; a trial is the free phases and, in feeds per tooth, the runout."""

    def __init__(self, cuts: Waveforms, runout: bool) -> None:
        self.cuts = cuts
        self.values = cuts.values()
        self.free_phase = ~np.isfinite(cuts.angle_rad)
        self.runout = runout
        self.unit_mm = max(model.feed_per_tooth_mm for model in cuts.models)
        self.sector = cuts.sector_rad if self.free_phase.all() else 2.0 * math.pi
        self.evaluations = 0

    def runouts(self) -> list[FloatArray]:
        """Runouts to begin with, in feeds per tooth; directions over one pitch if a phase can take up the rest."""
        if not self.runout:
            return [np.zeros(0)]
        count = max(1, round(_DIRECTIONS * self.sector / math.pi))
        angles = np.arange(count) * (self.sector / count)
        return [size * np.array([math.cos(a), math.sin(a)]) for size in _SIZES for a in angles]

    def split(self, trial: FloatArray) -> tuple[FloatArray, FloatArray | None]:
        """Phases of all cuts, and runout in mm."""
        count = int(self.free_phase.sum())
        phases = self.cuts.angle_rad.copy()
        phases[self.free_phase] = trial[:count]
        return phases, trial[count:] * self.unit_mm if self.runout else None

    def solve(self, trial: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Best coefficients at a trial, and what is left."""
        self.evaluations += 1
        design = self.cuts.design(*self.split(trial))
        k = _solved(design, self.values, self.cuts.fixed)
        return k, design @ k - self.values

    def cost(self, trial: FloatArray) -> float:
        """Sum of squares at a trial."""
        return float(np.sum(self.solve(trial)[1] ** 2))

    def settled(self, k: FloatArray, runout: FloatArray) -> FloatArray:
        """A trial with the best phases on the grid for coefficients, and the best coefficients for these, in turns."""
        runout_mm = runout * self.unit_mm if self.runout else None
        trial = np.zeros(0)
        for _ in range(_ALTERNATIONS):
            phases = self.cuts.best_phases(k, runout_mm)[self.free_phase]
            now = np.concatenate((phases, runout))
            if np.array_equal(now, trial):
                break
            trial = now
            k, _ = self.solve(trial)
        return trial

    def slopes(self, trial: FloatArray) -> FloatArray:
        """Central differences of what is left."""
        count = int(self.free_phase.sum())
        columns = []
        for j in range(len(trial)):
            step = np.zeros(len(trial))
            step[j] = _PHASE_STEP_RAD if j < count else _RUNOUT_STEP
            columns.append((self.solve(trial + step)[1] - self.solve(trial - step)[1]) / (2.0 * step[j]))
        return np.column_stack(columns)

    def refined(self, trial: FloatArray) -> FloatArray:
        """The trial at the bottom of the valley that it lies in."""
        if len(trial) == 0:
            return trial

        def left(x: FloatArray) -> FloatArray:
            return self.solve(x)[1]

        found = optimize.least_squares(left, trial, jac=self.slopes, ftol=_PRECISION, xtol=_PRECISION, gtol=_PRECISION)
        return np.asarray(found.x)

    def result_of(self, trial: FloatArray) -> WaveformFit:
        """Coefficients at a trial with their errors, with phases and runout free as well."""
        k, left = self.solve(trial)
        phases, runout_mm = self.split(trial)
        given = np.isfinite(self.cuts.fixed)
        design = self.cuts.design(phases, runout_mm)
        more = [self.cuts.slope_over_phase(phases, k, runout_mm)[:, self.free_phase]]
        if runout_mm is not None:
            more.append(self._slope_over_runout(phases, runout_mm, k))
        plain = fit_linear(design, self.values, None, self.cuts.fixed)
        slopes = np.concatenate((design[:, ~given], *more), axis=1)
        covariance = _robust_covariance(slopes, left)
        dof = len(left) - slopes.shape[1]
        full, found = np.zeros((len(NAMES), len(NAMES))), np.flatnonzero(~given)
        full[np.ix_(found, found)] = covariance[: len(found), : len(found)]
        full[~plain.determined, :] = full[:, ~plain.determined] = math.nan
        estimate = from_covariance(plain.values, full, given, dof, plain.condition, plain.rank, None, float(dof))
        phases, runout_mm = self._reduced(phases, runout_mm)
        return WaveformFit(estimate, phases, runout_mm, _runout(runout_mm, covariance, dof), self.evaluations)

    def _slope_over_runout(self, phases: FloatArray, runout_mm: FloatArray, k: FloatArray) -> FloatArray:
        columns, size = [], _RUNOUT_STEP * self.unit_mm
        for j in range(2):
            step = np.eye(2)[j] * size
            change = self.cuts.design(phases, runout_mm + step) - self.cuts.design(phases, runout_mm - step)
            columns.append(change @ k / (2.0 * size))
        return np.column_stack(columns)

    def _reduced(self, phases: FloatArray, runout_mm: FloatArray | None) -> tuple[FloatArray, FloatArray | None]:
        """The same waveforms with the runout's direction in the first sector: another tooth is called the first."""
        turn = 2.0 * math.pi
        if runout_mm is not None:
            angle = math.atan2(runout_mm[1], runout_mm[0]) % turn
            sectors = self.sector * math.floor(angle / self.sector)
            c, s = math.cos(sectors), math.sin(sectors)
            runout_mm = np.array([[c, s], [-s, c]]) @ runout_mm
            phases = phases + sectors
        return np.where(self.free_phase, phases % turn, phases), runout_mm


def _solved(design: FloatArray, values: FloatArray, fixed: FloatArray) -> FloatArray:
    """Best coefficients, of least length where several are."""
    given = np.isfinite(fixed)
    k = fixed.copy()
    a = design[:, ~given]
    length = np.linalg.norm(a, axis=0)
    length = np.where(length > 0.0, length, 1.0)
    k[~given] = np.linalg.lstsq(a / length, values - design[:, given] @ fixed[given], rcond=1e-10)[0] / length
    return k


def _robust_covariance(slopes: FloatArray, left: FloatArray) -> NDArray[np.float64]:
    """Covariance that does not suppose equal noise at all harmonics (HC3 of MacKinnon and White, 1985)."""
    length = np.linalg.norm(slopes, axis=0)
    length = np.where(length > 0.0, length, 1.0)
    inverse = np.linalg.pinv(slopes / length, rcond=1e-10)
    leverage = np.sum((slopes / length) * inverse.T, axis=1)
    spread = inverse * (left / np.maximum(1.0 - leverage, _LEAST_FREE))[None, :]
    return np.asarray((spread @ spread.T) / np.outer(length, length))


def _runout(runout_mm: FloatArray | None, covariance: FloatArray, dof: int) -> Runout | None:
    if runout_mm is None:
        return None
    half = quantile(float(dof)) * np.sqrt(np.diag(covariance)[-2:]) if dof > 0 else np.full(2, math.nan)
    return Runout(
        size_mm=math.hypot(*runout_mm),
        angle_rad=math.atan2(runout_mm[1], runout_mm[0]) % (2.0 * math.pi),
        half_width_mm=(float(half[0]), float(half[1])),
    )
