"""Low-pass and notch filters, forwards and backwards (no phase shift) unless causal."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Literal, TypeAlias

import numpy as np
from scipy import signal

from twin.arrays import FloatArray, frozen
from twin.errors import MeasuredError
from twin.measured.log import Correction, ForceLog
from twin.measured.uniform import pieces, uniform

#: Least frequency and width, as a part of the sampling rate: coefficients of narrower filters are lost in rounding.
_LEAST_PART = 1e-6

Phase: TypeAlias = Literal["zero", "causal"]


@dataclass(frozen=True, slots=True, kw_only=True)
class Filter:
    """A filter that is applied to a log and, equally, to a simulation.

    Attributes:
        kind: ``lowpass`` (Butterworth) or ``notch``.
        hz: corner of the low-pass, -3 dB as applied; or the centre of the notch.
        order: of the low-pass, in one direction.
        quality: of the notch: centre divided by width at -3 dB.
        phase: ``zero`` runs forwards and backwards; ``causal`` forwards only, as a filter in an amplifier does.
    """

    kind: Literal["lowpass", "notch"]
    hz: float
    order: int = 4
    quality: float = 30.0
    phase: Phase = "zero"

    def text(self) -> str:
        """One human-readable line."""
        direction = "forwards and backwards, no phase shift" if self.phase == "zero" else "causal"
        if self.kind == "lowpass":
            late = "" if self.phase == "zero" else f", {1e3 * self.delay_s():.3f} ms late in its pass band"
            return f"low-pass {self.hz:g} Hz (-3 dB), Butterworth order {self.order}, {direction}{late}"
        return f"notch at {self.hz:g} Hz, {self.hz / self.quality:.3g} Hz wide, {direction}"

    def delay_s(self) -> float:
        """Delay of slow signals."""
        if self.phase == "zero" or self.kind == "notch":
            return 0.0
        poles = signal.butter(self.order, 1.0, analog=True, output="zpk")[1]
        return float(np.sum(-1.0 / poles).real) / (2.0 * np.pi * self.hz)

    def apply(self, values: FloatArray, rate_hz: float) -> FloatArray:
        """Filter along the first axis.

        Args:
            values: shape (n, k), evenly spaced.

        Raises:
            MeasuredError: a frequency or a width that is not below half the sampling rate, or next to nothing.
        """
        self._check(rate_hz)
        sos = self._sections(rate_hz)
        if self.phase == "causal":
            start = signal.sosfilt_zi(sos)[:, :, None] * values[0]
            return np.asarray(signal.sosfilt(sos, values, axis=0, zi=start)[0])
        pad = min(len(values) - 1, int(np.ceil(self._memory_s() * rate_hz)))
        return np.asarray(signal.sosfiltfilt(sos, values, axis=0, padlen=max(pad, 0)))

    def _check(self, rate_hz: float) -> None:
        least, most = _LEAST_PART * rate_hz, 0.5 * rate_hz
        if not least <= self.hz < most:
            raise MeasuredError(
                f"{self.kind} at {self.hz:g} Hz: expected it below half the sampling rate, {most:g} Hz, and at least "
                f"{least:g} Hz"
            )
        if self.kind == "notch" and not least <= self.hz / self.quality < most:
            raise MeasuredError(
                f"notch at {self.hz:g} Hz of quality {self.quality:g}: expected it {least:g} to {most:g} Hz wide, a "
                f"quality of {self.hz / most:.3g} to {self.hz / least:.3g}"
            )

    def _memory_s(self) -> float:
        """Time over which the filter rings."""
        width = self.hz if self.kind == "lowpass" else self.hz / self.quality
        return 1.5 / width

    def _sections(self, rate_hz: float) -> FloatArray:
        twice = self.phase == "zero"
        if self.kind == "lowpass":
            wide = (2.0**0.5 - 1.0) ** (-0.5 / self.order) if twice else 1.0
            corner = rate_hz / np.pi * np.arctan(wide * np.tan(np.pi * self.hz / rate_hz))
            return np.asarray(signal.butter(self.order, corner, fs=rate_hz, output="sos"))
        quality = self.quality * (2.0**0.5 - 1.0) ** -0.5 if twice else self.quality
        b, a = signal.iirnotch(self.hz, quality, fs=rate_hz)
        return np.asarray(signal.tf2sos(b, a))


def parse_notch(text: str, phase: Phase = "zero") -> Filter:
    """``700`` or ``700:20``: centre frequency, and quality (centre frequency divided by width).

    Raises:
        MeasuredError: not numbers above 0.
    """
    centre, _, quality = text.partition(":")
    try:
        made = Filter(kind="notch", hz=float(centre), quality=float(quality or 30.0), phase=phase)
    except ValueError:
        raise MeasuredError(f"notch {text!r}: expected HZ or HZ:QUALITY, e.g. 700:30") from None
    if not made.hz > 0.0 or not made.quality > 0.0:
        raise MeasuredError(f"notch {text!r}: expected numbers above 0, e.g. 700:30")
    return made


def filtered(log: ForceLog, with_filter: Filter) -> ForceLog:
    """The log, filtered piece by piece between its gaps.

    Raises:
        MeasuredError: a frequency that is not below half the sampling rate.
    """
    log = uniform(log)
    force = log.force_n.copy()
    for piece in pieces(log):
        force[piece] = with_filter.apply(log.force_n[piece], log.rate_hz)
    done = Correction(
        kind=with_filter.kind,
        text=with_filter.text(),
        values={"hz": with_filter.hz, "phase": with_filter.phase, "delay_s": with_filter.delay_s()},
    )
    return replace(log, force_n=frozen(force, "force_n", (None, 3)), corrections=(*log.corrections, done))
