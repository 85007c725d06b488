"""Possible mistakes in a log or a run, reported before the numbers are trusted."""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np

from twin.arrays import FloatArray
from twin.comparison.delay import FAR_RIVALS, Delay, better_axes, find_delay
from twin.comparison.run_forces import RunForces
from twin.errors import CompareError
from twin.measured.log import AXES, ForceLog, Gap
from twin.measured.settings import CompareSettings
from twin.measured.spindle import SpindleSpeed

#: Forces that differ by this factor are of another scale: no cut is modelled that badly.
_UNIT_FACTOR = 150.0
#: Up to this factor a prefix is wrong; beyond it the numbers may be no forces at all.
_THOUSANDS = 7000.0
#: From this factor on it is worth a warning.
_DOUBTFUL_FACTOR = 7.0
#: For each unit the one a thousand times larger, and the one a thousand times smaller.
_OTHER_UNITS = {"N": ("kN", "mN"), "kN": ("MN", "N"), "mN": ("N", "uN")}
#: An axis with less than this part of the run's force hardly takes part in it; a log's axis beyond this many times the
#: run's force is of another scale all the same.
_LEAST_SHARE, _FAR_ABOVE = 0.05, 2.0
#: The least level that a factor is proposed for, N.
_LEAST_LEVEL_N = 1e-3
_LEVEL_SAMPLES = 50_000
_SPEED_WITHIN = 0.01
_POOR_FIT = 0.75
_FAR_BETTER = 0.15


def check_units(run: RunForces, log: ForceLog, settings: CompareSettings) -> Iterator[str]:
    """Forces of another scale than the run's: in another unit, or counts or volts instead of forces.

    Raises:
        CompareError: they are far from the run's, and the unit was not given.
    """
    even = run.at(np.linspace(*run.span_s, _LEVEL_SAMPLES))
    measured, simulated = _level(log.force_n), _level(even)
    if not measured > 0.0:
        raise CompareError(f"{log.source}: all forces are equal: nothing was measured")
    if not simulated > 0.0:
        return
    wrong, right = _axes_by_scale(log, even, simulated)
    if wrong and right:
        for axis, own, expected in wrong:
            yield from _axis_mistake(log, axis, own, expected, settings)
        return
    ratio = _ratio(measured, simulated)
    if ratio < _DOUBTFUL_FACTOR:
        return
    text = f"{log.source}: forces are about {_differ(measured, simulated)}"
    levels = _levels(measured, simulated)
    if ratio < _UNIT_FACTOR:
        yield f"{text} ({levels}): is the unit or the sensitivity right, and is it the same cut?"
        return
    larger_unit, smaller_unit = _OTHER_UNITS.get(log.unit, ("kN", "mN"))
    unit = larger_unit if simulated > measured else smaller_unit
    if ratio < _THOUSANDS:
        text += f" ({levels}): in {unit}? Give the unit by --unit {unit}; any makes it a warning"
    else:
        text += (
            f" ({levels}): counts, volts or another unit? Give the unit by --unit, or a factor for each column, "
            "e.g. --map x=0.001*Fx; any unit makes it a warning"
        )
    if settings.unit is None:
        raise CompareError(text)
    yield text


def _axes_by_scale(
    log: ForceLog, even: FloatArray, simulated: float
) -> tuple[list[tuple[str, float, float]], list[str]]:
    """Axes of another scale than the run's, each with its level in the log and in the run, N; and the other ones.

    An axis that hardly takes part in the run's force is one of these only where it exceeds that force.
    """
    wrong, right = [], []
    for axis in log.axes:
        i = AXES.index(axis)
        own, expected = _level(log.force_n[:, [i]]), _level(even[:, [i]])
        takes_part = expected >= _LEAST_SHARE * simulated
        if _ratio(own, expected) >= _UNIT_FACTOR and (takes_part or 0.0 < _FAR_ABOVE * simulated <= own):
            wrong.append((axis, own, expected))
        elif takes_part:
            right.append(axis)
    return wrong, right


def _axis_mistake(
    log: ForceLog, axis: str, measured: float, simulated: float, settings: CompareSettings
) -> Iterator[str]:
    """An axis of another scale than the others: an error, a warning where a unit was given or nothing was measured."""
    channel = log.channels[AXES.index(axis)]
    if not measured > 0.0:
        yield (
            f"{log.source}: F{axis} ({channel}) is constant, expected about {simulated:.4g} N: was it measured? "
            "Axes that the map omits are not compared"
        )
        return
    factor = 10.0 ** round(math.log10(max(simulated, _LEAST_LEVEL_N) / measured))
    sign, name = ("-", channel[1:]) if channel.startswith("-") else ("", channel)
    example = "" if any(mark in name for mark in "+-*") else f", e.g. {axis}={sign}{factor:g}*{name}"
    text = (
        f"{log.source}: F{axis} ({channel}) is about {_differ(measured, simulated)}, and other axes are not "
        f"({_levels(measured, simulated)}): another unit or sensitivity? Give its factor in the map{example}; any "
        "--unit makes it a warning"
    )
    if settings.unit is None:
        raise CompareError(text)
    yield text


def _ratio(one: float, two: float) -> float:
    """The larger of two levels by the smaller."""
    low, high = sorted((one, two))
    return high / low if low > 0.0 else math.inf


def _differ(measured: float, simulated: float) -> str:
    word = "smaller" if simulated > measured else "larger"
    return f"{_round(_ratio(measured, simulated))} times {word} than the run's"


def _levels(measured: float, simulated: float) -> str:
    return f"level {measured:.4g} N, expected about {simulated:.4g} N"


def _round(ratio: float) -> str:
    """A ratio in words that need no counting of zeros."""
    return f"{ratio:.0f}" if ratio < 1e5 else f"{ratio:.1e}".replace("e+0", "e").replace("e+", "e")


def _level(force_n: np.ndarray[tuple[int, int], np.dtype[np.float64]]) -> float:
    """High level of the resultant less its middle, single spikes left out; a cut may be a small part of a record."""
    moving = force_n - np.median(force_n, axis=0)
    return float(np.percentile(np.sqrt(np.sum(moving**2, axis=1)), 99.8))


def check_rate(log: ForceLog, rpm: float, teeth: int) -> Iterator[str]:
    """Enough samples for each tooth."""
    passing = abs(rpm) * teeth / 60.0
    if log.rate_hz < 2.0 * passing:
        yield (
            f"{log.source}: sampled at {log.rate_hz:g} Hz, below twice the tooth-passing frequency ({passing:g} Hz): "
            f"expected at least {2.0 * passing:g} Hz; only means are valid, not waveforms, delay and harmonics"
        )
    elif log.rate_hz < 10.0 * passing:
        yield (
            f"{log.source}: {log.rate_hz / passing:.1f} samples per tooth period ({passing:g} Hz): peaks are cut off; "
            f"expected {10.0 * passing:g} Hz or more"
        )


def check_speed(log: ForceLog, found: SpindleSpeed | None, rpm: float) -> Iterator[str]:
    """The spindle ran as programmed."""
    if found is not None and abs(found.rpm / abs(rpm) - 1.0) > _SPEED_WITHIN:
        yield (
            f"{log.source}: spindle at {found.rpm:.0f} rpm, from its {found.source}, expected the run's {abs(rpm):g} "
            "rpm: wrong run, or the override not at 100 %? Waveforms drift apart; --phase aligns each window separately"
        )


def check_overlap(run: RunForces, log: ForceLog, lag_s: float) -> Gap:
    """The time that both cover, on the run's clock.

    Raises:
        CompareError: there is none.
    """
    begin, end = run.span_s
    first, last = log.span_s
    both = (max(begin, first - lag_s), min(end, last - lag_s))
    if not both[0] < both[1]:
        raise CompareError(
            f"{log.source}: no overlap in time: the log covers {first:.4f} to {last:.4f} s, with a lag of {lag_s:.4f} "
            f"s {first - lag_s:.4f} to {last - lag_s:.4f} s of the run, which covers {begin:.4f} to {end:.4f} s; "
            "give the lag with --lag SECONDS, or --lag auto"
        )
    return both


def check_fit(run: RunForces, log: ForceLog, score: float, likeness: float, settings: CompareSettings) -> Iterator[str]:
    """A poor fit: are the axes right?

    Args:
        score: correlation, each axis less its mean.
        likeness: the same with the means included.
    """
    if min(score, likeness) >= _POOR_FIT:
        return
    axes, better = better_axes(run, log)
    if better > max(likeness, 0.0) + _FAR_BETTER and any(axes[a] != a for a in axes):
        turned = ", ".join(f"{a} = {axes[a]}" for a in AXES)
        yield (
            f"{log.source}: similarity {likeness:.2f}, means included; it would be {better:.2f} with {turned} of the "
            f"log as mapped: try {_hint(axes, log, settings)}"
        )
    elif settings.lag_s is not None and better > max(likeness, 0.0) + _FAR_BETTER:
        found = find_delay(run, log)
        yield (
            f"{log.source}: correlation {score:.2f} with the lag given, {found.score:.2f} with {found.lag_s:.6f} s: "
            "try --lag auto"
        )
    elif score < _POOR_FIT:
        yield f"{log.source}: correlation {score:.2f}: the log does not resemble the run"


def _hint(axes: dict[str, str], log: ForceLog, settings: CompareSettings) -> str:
    """The option that turns the axes as they fit."""
    if all(axes[a] == f"-{a}" for a in AXES):
        other = "workpiece" if settings.force_on == "tool" else "tool"
        return f"--force-on {other}"
    channels = dict(zip(AXES, log.channels, strict=True))
    parts = []
    for axis in AXES:
        source = axes[axis].lstrip("-")
        parts.append(f"{axis}={_turned(channels[source]) if axes[axis].startswith('-') else channels[source]}")
    return f'--map "{",".join(parts)}"'


def _turned(text: str) -> str:
    """A sum of channels with all signs turned."""
    swapped = text.translate(str.maketrans("+-", "-+"))
    return swapped.removeprefix("+") if text.startswith("-") else f"-{swapped}"


def check_delay(delay: Delay, log: ForceLog) -> Iterator[str]:
    """A delay that may be another one far from it; neighbours a tooth period away do not matter."""
    far = max((abs(r - delay.lag_s) for r in delay.rivals_s), default=0.0)
    if far > FAR_RIVALS * log.duration_s:
        yield (
            f"{log.source}: {len(delay.rivals_s)} other delays fit equally well, up to {far:.3f} s away: the cut is "
            "steady there, so only the phase of the spindle is known; of the delays that cover the windows, the one "
            "nearest to 0 is taken; --lag-within SECONDS narrows the search"
        )
