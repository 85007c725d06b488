"""Coefficients from mean forces: by linear least squares, and by the tri-slice paper's iterative search."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from scipy import optimize

from twin.arrays import FloatArray
from twin.identification.cuts.fit_settings import Fit, Name
from twin.identification.cuts.measure import Measured
from twin.identification.fit.least_squares import Estimate, fit_linear, fixed_values
from twin.identification.models.model import Model
from twin.identification.models.straight import NAMES

#: Where the search begins, and the bounds beyond which no material lies; c in N/mm2, e in N/mm.
START = (1000.0, 10.0, 400.0, 10.0, 200.0, 5.0)
LOWER = (0.0, -1000.0, -50000.0, -1000.0, -50000.0, -1000.0)
UPPER = (50000.0, 1000.0, 50000.0, 1000.0, 50000.0, 1000.0)
_PRECISION = 1e-13
_MOST_EVALUATIONS = 500
#: A coefficient this near to a bound, in parts of the bounds' distance, is on it.
_ON_BOUND = 1e-9


@dataclass(frozen=True, slots=True, eq=False)
class Equations:
    """Mean forces of the measured axes, one below the other.

    Attributes:
        design: shape (m, 6), means for unit coefficients.
        values: shape (m,), measured means.
        errors: shape (m,), their standard errors; None where one is unknown, or where they are not to be used.
        axis: shape (m,), 0, 1, 2 for x, y, z.
    """

    design: FloatArray
    values: FloatArray
    errors: FloatArray | None
    axis: FloatArray


def equations(models: Sequence[Model], measured: Sequence[Measured], fit: Fit) -> Equations:
    """The equations of cuts that are fitted."""
    rows = [m.axes for m in measured]
    errors = np.concatenate([m.error_n[r] for m, r in zip(measured, rows, strict=True)])
    weighted = fit.weights == "errors" and bool(np.all(np.isfinite(errors) & (errors > 0.0)))
    return Equations(
        design=np.concatenate([model.means()[r] for model, r in zip(models, rows, strict=True)]),
        values=np.concatenate([m.mean_n[r] for m, r in zip(measured, rows, strict=True)]),
        errors=errors if weighted else None,
        axis=np.concatenate([np.flatnonzero(r) for r in rows]).astype(np.float64),
    )


def fit_means(given: Equations, fit: Fit) -> Estimate:
    """Linear least squares; the regression of slotting forces over feed is a special case."""
    return fit_linear(given.design, given.values, given.errors, fixed_values(fit.fixed))


@dataclass(frozen=True, slots=True, eq=False)
class Search:
    """Result of an iterative search.

    Attributes:
        evaluations: simulations of all cuts.
        at_bounds: coefficients that ended on a bound.
    """

    estimate: Estimate
    evaluations: int
    at_bounds: tuple[str, ...]


def search_means(models: Sequence[Model], measured: Sequence[Measured], given: Equations, fit: Fit) -> Search:
    """Search for the coefficients with which simulated mean forces match measured ones (tri-slice paper, Fig. 17).

    Each trial simulates a revolution of every cut and takes its mean; a bounded trust-region search moves the
    coefficients that are not fixed. It begins at the same place each time, so that equal files give equal results.
    """
    fixed = fixed_values(fit.fixed)
    free = ~np.isfinite(fixed)
    start, low, high = (_vector(d, o) for d, o in ((START, fit.start), (LOWER, fit.lower), (UPPER, fit.upper)))
    start = np.clip(start, low, high)
    runs = [model.harmonics(0)[0].real[m.axes] for model, m in zip(models, measured, strict=True)]
    weights = np.ones(len(given.values)) if given.errors is None else 1.0 / _errors(given, fixed)

    def simulated(found: FloatArray) -> FloatArray:
        k = fixed.copy()
        k[free] = found
        return np.concatenate([run @ k for run in runs])

    def off(found: FloatArray) -> FloatArray:
        return (simulated(found) - given.values) * weights

    if not free.any():
        return Search(fit_linear(given.design, given.values, given.errors, fixed), 1, ())
    found = optimize.least_squares(
        off,
        start[free],
        bounds=(low[free], high[free]),
        jac="3-point",
        x_scale=np.array(START)[free],
        ftol=_PRECISION,
        xtol=_PRECISION,
        gtol=_PRECISION,
        max_nfev=_MOST_EVALUATIONS,
    )
    return _search_result(found, given, fixed, weights, (low[free], high[free]))


def _errors(given: Equations, fixed: FloatArray) -> FloatArray:
    """Standard errors of the means with the spread between cuts in them."""
    assert given.errors is not None
    spread = fit_linear(given.design, given.values, given.errors, fixed).spread_n or 0.0
    return np.hypot(given.errors, spread)


def _search_result(
    found: optimize.OptimizeResult,
    given: Equations,
    fixed: FloatArray,
    weights: FloatArray,
    bounds: tuple[FloatArray, FloatArray],
) -> Search:
    """Errors by the slope at the end of the search; no number where the cuts do not determine it."""
    free = ~np.isfinite(fixed)
    design = given.design.copy()
    design[:, free] = found.jac / weights[:, None]
    estimate = fit_linear(design, given.values, given.errors, fixed)
    near = _ON_BOUND * (bounds[1] - bounds[0])
    on = (found.x - bounds[0] <= near) | (bounds[1] - found.x <= near)
    values = estimate.values.copy()
    values[free] = np.where(estimate.determined[free], found.x, np.nan)
    names = np.array(NAMES)[free][on].tolist()
    # three-point slopes take two simulations for each unknown at each step
    evaluations = int(found.nfev + 2 * free.sum() * (found.njev or 0))
    return Search(replace(estimate, values=values), evaluations, tuple(names))


def _vector(default: tuple[float, ...], given: Mapping[Name, float]) -> FloatArray:
    named = {str(name): value for name, value in given.items()}
    return np.array([named.get(name, value) for name, value in zip(NAMES, default, strict=True)])
