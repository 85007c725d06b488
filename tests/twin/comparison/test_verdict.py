"""The sentence about a comparison says what was put in."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from support.compared import log_of, run

from twin.arrays import frozen
from twin.comparison.comparison import Comparison, compare
from twin.comparison.verdict import verdict
from twin.measured.settings import CompareSettings

RUN = run()


def compared(factors: tuple[float, float, float] = (1.0, 1.0, 1.0), *windows: tuple[float, float]) -> Comparison:
    log = log_of(RUN)
    log = replace(log, force_n=frozen(log.force_n * np.array(factors), "force_n", (None, 3)))
    return compare(RUN, log, CompareSettings(windows=windows, lag_s=0.0))


def test_equal_forces() -> None:
    text = verdict(compared())
    begins = "Simulated relative to measured: mean force ±0.0 %, peak ±0.0 %; RMS error 0.0 % of the measured RMS"
    assert text.startswith(begins)
    assert "warning" not in text


def test_a_measurement_a_quarter_larger() -> None:
    text = verdict(compared((1.25, 1.25, 1.25), (3.0, 3.5)))
    assert "mean force −20.0 %, peak −20.0 %; RMS error 20.0 % of the measured RMS" in text


def test_the_worst_axis_and_window_are_named() -> None:
    found = compared((1.0, 2.0, 1.0), (3.0, 3.2), (5.0, 5.2))
    text = verdict(found)
    worst = max(found.windows, key=lambda w: w.of("y").rms_n)
    assert text.startswith("Over 2 windows, simulated relative to measured: mean force −")
    assert (
        f"largest in Fy in {worst.span_s[0]:.2f}–{worst.span_s[1]:.2f} s: {worst.of('y').rms_n:.3g} N, 50.0 %" in text
    )


@pytest.mark.parametrize("count", [1, 2])
def test_warnings_are_mentioned(count: int) -> None:
    found = replace(compared(), warnings=("a doubt",) * count)
    says = ("1 warning says why", "2 warnings say why")[count - 1]
    assert says in verdict(found)


def test_air_is_not_comparable() -> None:
    found = compared()
    window = found.windows[0]
    nothing = replace(window.errors[-1], ratio_of_means=None, ratio_of_peaks=None, rms_by_rms=None)
    air = replace(found, windows=(replace(window, errors=(nothing,)),))
    assert "mean force not comparable, peak not comparable; RMS error not comparable" in verdict(air)
