"""Cutting coefficients: data with a source and a named convention."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Literal

import numpy as np

from twin.arrays import FloatArray


@dataclass(frozen=True, slots=True, kw_only=True)
class CuttingCoefficients:
    """Coefficients of the instantaneous rigid force model (tri-slice paper, eq. 2).

        dF_t = (Ktc h + Kte) db      dF_r = (Krc h + Kre) db      dF_a = (Kac h + Kae) db

    Under Kienzle's law h is replaced by h^(1 - m), with an exponent m for each direction and h in mm.

    Attributes:
        Ktc, Krc, Kac: tangential, radial, axial, per chip area, N/mm2.
        Kte, Kre, Kae: the same per edge length, N/mm.
        mt, mr, ma: exponents of Kienzle's law, from 0 (linear) to below 1.
        source: where the numbers come from.
        convention: what db is: ``meridian``, the length along the tool's meridian (dz / sin kappa). Sets made with
            the helical edge length are not interchangeable with these.

    Raises:
        ValueError: a value that is not finite, an exponent out of its range, or an empty source.
    """

    Ktc: float
    Kte: float
    Krc: float
    Kre: float
    Kac: float
    Kae: float
    mt: float = 0.0
    mr: float = 0.0
    ma: float = 0.0
    source: str
    convention: Literal["meridian"] = "meridian"

    def __post_init__(self) -> None:
        for name in ("Ktc", "Kte", "Krc", "Kre", "Kac", "Kae"):
            if not math.isfinite(getattr(self, name)):
                raise ValueError(f"{name} = {getattr(self, name)}, expected a finite number")
        for name in ("mt", "mr", "ma"):
            if not 0.0 <= getattr(self, name) < 1.0:
                raise ValueError(f"{name} = {getattr(self, name)}, expected at least 0 and below 1")
        if not self.source.strip():
            raise ValueError("source is empty, expected where the coefficients come from")

    @property
    def values(self) -> FloatArray:
        """Shape (6,): Ktc, Kte, Krc, Kre, Kac, Kae, the order that kernels take."""
        return np.array([self.Ktc, self.Kte, self.Krc, self.Kre, self.Kac, self.Kae])
