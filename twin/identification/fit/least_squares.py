"""Linear least squares for the six coefficients, with what is known about how well they are known.

Means of forces, and waveforms at given phase and runout, are linear in the coefficients: y = A K + noise.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy import optimize, stats

from twin.arrays import FloatArray
from twin.identification.cuts.fit_settings import Name
from twin.identification.models.straight import NAMES

#: A singular value below this part of the largest, columns scaled to length 1, is none.
RANK_TOLERANCE = 1e-8
#: Confidence of the intervals.
CONFIDENCE = 0.95
#: A part of a coefficient in a direction that the cuts leave free above which it is called undetermined.
_FREE_PART = 1e-6
#: The spread between cuts is looked for up to this many times the largest residual.
_WIDEST_SPREAD = 1e3


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Estimate:
    """The six coefficients, order `NAMES`, and their statistics.

    Attributes:
        values: shape (6,), N/mm2 and N/mm in turn; NaN where the cuts do not determine a coefficient.
        errors: shape (6,), standard errors; 0 where fixed, NaN where unknown.
        half_widths: shape (6,), half the width of the 95 % intervals (Student's t).
        covariance: shape (6, 6); NaN rows where unknown.
        fixed: shape (6,), whether a value was given and not fitted.
        dof: degrees of freedom, number of equations less that of unknowns.
        condition: condition number of the equations, columns scaled to length 1; infinite where rank is missing.
        rank: of the equations of the coefficients that are not fixed.
        spread_n: standard deviation between cuts beyond the stated errors, N (Paule and Mandel); None where no errors
            are stated, and from the residuals alone.
    """

    values: FloatArray
    errors: FloatArray
    half_widths: FloatArray
    covariance: FloatArray
    fixed: NDArray[np.bool_]
    dof: int
    condition: float
    rank: int
    spread_n: float | None = None

    @property
    def determined(self) -> NDArray[np.bool_]:
        """Shape (6,): which coefficients have a value."""
        return np.isfinite(self.values)

    @property
    def correlation(self) -> FloatArray:
        """Shape (6, 6), correlation matrix; NaN off the diagonal where a coefficient is fixed or unknown."""
        out = np.full((len(NAMES), len(NAMES)), math.nan)
        known = np.isfinite(self.errors) & (self.errors > 0.0)
        at = np.ix_(known, known)
        out[at] = self.covariance[at] / np.outer(self.errors[known], self.errors[known])
        np.fill_diagonal(out, 1.0)
        return out


def fixed_values(fixed: Mapping[Name, float]) -> FloatArray:
    """Shape (6,), the given values in order, NaN where a coefficient is to be found."""
    named = {str(name): value for name, value in fixed.items()}
    return np.array([named.get(name, math.nan) for name in NAMES])


def quantile(dof: float) -> float:
    """Half width of the 95 % interval in standard errors; Student's t, normal where ``dof`` is infinite."""
    return float(stats.t.ppf(0.5 + 0.5 * CONFIDENCE, dof)) if math.isfinite(dof) else float(stats.norm.ppf(0.975))


def fit_linear(design: FloatArray, values: FloatArray, errors: FloatArray | None, fixed: FloatArray) -> Estimate:
    """Least squares, weighted by the standard errors of the values where these are known.

    Without errors all values count alike and the residuals give the noise. With errors, what the residuals have beyond
    them is taken as a spread between cuts with one variance more, found by Paule and Mandel's rule: chi squared equals
    its degrees of freedom.

    Args:
        design: shape (m, 6).
        values: shape (m,), N.
        errors: shape (m,), standard errors of the values, N, above 0; or None.
        fixed: shape (6,), see `fixed_values`.
    """
    given = np.isfinite(fixed)
    design = _without_rounding(design)
    a, y = design[:, ~given], values - design[:, given] @ fixed[given]
    rank, condition, free = _rank(a)
    dof = len(y) - rank
    if errors is None:
        k, normal, chi2 = _solve(a, y, np.ones(len(y)))
        covariance = normal * (chi2 / dof) if dof > 0 else np.full_like(normal, math.nan)
        return _estimate(fixed, k, covariance, free, dof, condition, rank, None, float(dof))
    spread = _spread(a, y, errors, dof)
    k, covariance, _ = _solve(a, y, np.hypot(errors, spread))
    return _estimate(fixed, k, covariance, free, dof, condition, rank, spread, dof if dof > 0 else math.inf)


def _without_rounding(design: FloatArray) -> FloatArray:
    """The equations with columns that are only rounding, compared with others of their kind, set to zero."""
    out = design.copy()
    length = np.linalg.norm(out, axis=0)
    for kind in (slice(0, None, 2), slice(1, None, 2)):
        rounding = length[kind] < RANK_TOLERANCE * length[kind].max(initial=0.0)
        out[:, kind] = np.where(rounding, 0.0, out[:, kind])
    return out


def _rank(a: FloatArray) -> tuple[int, float, NDArray[np.bool_]]:
    """Rank, condition number, and which columns take part in a combination that has no effect."""
    if a.shape[1] == 0:
        return 0, 1.0, np.zeros(0, dtype=bool)
    length = np.linalg.norm(a, axis=0)
    scaled = a / np.where(length > 0.0, length, 1.0)
    _, s, vt = np.linalg.svd(scaled, full_matrices=True)
    rank = int(np.sum(s > RANK_TOLERANCE * s[0])) if s[0] > 0.0 else 0
    free = np.abs(vt[rank:]).max(axis=0, initial=0.0) > _FREE_PART
    condition = float(s[0] / s[-1]) if rank == a.shape[1] else math.inf
    return rank, condition, free


def _solve(a: FloatArray, y: FloatArray, errors: FloatArray) -> tuple[FloatArray, FloatArray, float]:
    """Solution of least length, the inverse of the normal matrix, and chi squared."""
    weighted = a / errors[:, None]
    length = np.linalg.norm(weighted, axis=0)
    length = np.where(length > 0.0, length, 1.0)
    inverse = np.linalg.pinv(weighted / length, rcond=RANK_TOLERANCE)
    k = (inverse @ (y / errors)) / length
    normal = (inverse @ inverse.T) / np.outer(length, length)
    return k, normal, float(np.sum(((y - a @ k) / errors) ** 2))


def _spread(a: FloatArray, y: FloatArray, errors: FloatArray, dof: int) -> float:
    """Standard deviation beyond the stated errors that makes chi squared equal to its degrees of freedom."""
    if dof <= 0 or _solve(a, y, errors)[2] <= dof:
        return 0.0

    def excess(log_spread: float) -> float:
        return _solve(a, y, np.hypot(errors, math.exp(log_spread)))[2] / dof - 1.0

    widest = _WIDEST_SPREAD * max(float(np.abs(y).max()), float(errors.max()))
    low, high = math.log(1e-9 * float(errors.min())), math.log(widest)
    return math.exp(float(optimize.brentq(excess, low, high, xtol=1e-10)))


def _estimate(
    fixed: FloatArray,
    k: FloatArray,
    covariance: FloatArray,
    free: NDArray[np.bool_],
    dof: int,
    condition: float,
    rank: int,
    spread: float | None,
    t_dof: float,
) -> Estimate:
    """Put together what was fitted and what was given."""
    given = np.isfinite(fixed)
    found = np.flatnonzero(~given)
    values, full = fixed.copy(), np.zeros((len(NAMES), len(NAMES)))
    values[found] = np.where(free, math.nan, k)
    full[np.ix_(found, found)] = covariance
    full[found[free], :] = full[:, found[free]] = math.nan
    return from_covariance(values, full, given, dof, condition, rank, spread, t_dof)


def from_covariance(
    values: FloatArray,
    covariance: FloatArray,
    fixed: NDArray[np.bool_],
    dof: int,
    condition: float,
    rank: int,
    spread: float | None,
    t_dof: float,
) -> Estimate:
    """An estimate with the errors and intervals that follow from a covariance matrix."""
    with np.errstate(invalid="ignore"):
        errors = np.sqrt(np.diag(covariance))
    return Estimate(
        values=values,
        errors=errors,
        half_widths=errors * (quantile(t_dof) if t_dof > 0 else math.nan),
        covariance=covariance,
        fixed=fixed,
        dof=dof,
        condition=condition,
        rank=rank,
        spread_n=spread,
    )
