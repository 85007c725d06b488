"""Result of an identification."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from twin.arrays import FloatArray
from twin.identification.cuts.fit_settings import Method
from twin.identification.cuts.measure import Measured
from twin.identification.fit.harmonics import ComplexArray, to_waveform
from twin.identification.fit.least_squares import Estimate
from twin.identification.models.straight import NAMES


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class CutResult:
    """One cut, measured and fitted; forces on the tool, machine axes, N.

    Attributes:
        held_out: whether it was left out of the fit.
        fitted_n: shape (3,), mean force by the coefficients found.
        fitted_harmonics: the waveform by the coefficients found, at the phase found; None where none was compared.
        phase_rad: spindle angle at the log's time 0, None where none was found.
    """

    name: str
    held_out: bool
    measured: Measured
    fitted_n: FloatArray
    fitted_harmonics: ComplexArray | None = None
    phase_rad: float | None = None

    @property
    def residual_n(self) -> FloatArray:
        """Shape (3,), measured minus fitted mean; NaN on an axis that was not measured."""
        return self.measured.mean_n - self.fitted_n

    def waveforms(self, angle_rad: FloatArray) -> tuple[FloatArray, FloatArray] | None:
        """Measured and fitted force at spindle angles, shape (n, 3) each; None where none were compared."""
        if self.measured.harmonics is None or self.fitted_harmonics is None or self.phase_rad is None:
            return None
        at_log = np.exp(-1j * self.phase_rad * np.arange(len(self.measured.harmonics)))[:, None]
        measured = to_waveform(self.measured.harmonics * at_log, angle_rad)
        return measured, to_waveform(self.fitted_harmonics, angle_rad)

    def waveform_error_n(self) -> float | None:
        """RMS of the vector between measured and fitted waveform over one revolution, on the measured axes."""
        if self.phase_rad is None:
            return None
        angle = np.linspace(0.0, 2.0 * np.pi, 720, endpoint=False)
        both = self.waveforms(angle)
        if both is None:
            return None
        off = (both[0] - both[1])[:, self.measured.axes]
        return float(np.sqrt((off**2).sum(axis=1).mean()))


@dataclass(frozen=True, slots=True, kw_only=True)
class Runout:
    """A runout that was found.

    Attributes:
        size_mm, angle_rad: as `runout_mm` and `runout_angle_deg` of a tool; with constant pitch the angle is known
            within one pitch, for the log does not show which tooth is the first.
        half_width_mm: shape (2,), half the widths of the 95 % intervals along and across tooth 0.
    """

    size_mm: float
    angle_rad: float
    half_width_mm: tuple[float, float]


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Identified:
    """Coefficients, their errors, and the quality of the fit.

    Attributes:
        r_squared: of the quantity that was fitted: all of it, then x, y, z; NaN where it does not vary.
        cuts: in the file's order, those held out among them.
        runout: None where it was not looked for.
        evaluations: how often the search computed the forces of all cuts; 0 where nothing was searched.
        at_bounds: coefficients that ended on a bound of the search.
        warnings: doubts about the result, one line each.
    """

    file: Path
    method: Method
    estimate: Estimate
    r_squared: tuple[float, float, float, float]
    cuts: tuple[CutResult, ...]
    runout: Runout | None = None
    evaluations: int = 0
    at_bounds: tuple[str, ...] = ()
    source: str | None = None
    warnings: tuple[str, ...] = ()

    @property
    def coefficients(self) -> dict[str, float]:
        """The coefficients by name: Ktc, Krc, Kac in N/mm2, Kte, Kre, Kae in N/mm; NaN where not determined."""
        return dict(zip(NAMES, self.estimate.values.tolist(), strict=True))
