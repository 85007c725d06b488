"""What a comparison is asked to do."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Literal, TypeAlias

from twin.errors import CompareError
from twin.measured.axes import AxisMap
from twin.measured.filters import Filter
from twin.measured.log import Gap
from twin.measured.spans import Offset
from twin.record import ForceOn

#: ``auto``: found by cross-correlation.
Lag: TypeAlias = float | Literal["auto"]


@dataclass(frozen=True, slots=True, kw_only=True)
class ReadSettings:
    """How a log is read.

    Attributes:
        axis_map: None takes the columns that are named after the axes.
        force_on: the body that the mapped force acts on.
        columns, delimiter, decimal, group, rate_hz, rpm: see `twin.measured.read_log`.
        unit: of the force columns.
    """

    axis_map: AxisMap | None = None
    force_on: ForceOn = "tool"
    columns: tuple[str, ...] | None = None
    delimiter: str | None = None
    decimal: str | None = None
    group: str | None = None
    rate_hz: float | None = None
    rpm: float | None = None
    unit: str | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class CompareSettings:
    """What is done to the log, and where the two are compared.

    Attributes:
        windows: on the run's clock, s; none compares the whole overlap.
        lag: run time = log time - lag.
        lag_within_s: ``auto`` looks at delays up to this size only.
        phase: shift each window within half a revolution, for spindles that do not keep the programmed speed.
        offset: what is subtracted as the amplifier's zero.
        drift: subtract a line through the air segments (the offset is in it).
        resample_hz: rate of the comparison; None keeps the log's.
        filters: put on the log, and on the simulation when ``filter_both``.
    """

    windows: tuple[Gap, ...] = ()
    lag: Lag = "auto"
    lag_within_s: float | None = None
    phase: bool = False
    offset: Offset = "none"
    drift: bool = False
    resample_hz: float | None = None
    filters: tuple[Filter, ...] = ()
    filter_both: bool = True
    read: ReadSettings = field(default_factory=ReadSettings)


def parse_lag(text: str) -> Lag:
    """``auto`` or seconds.

    Raises:
        CompareError: neither.
    """
    if text.strip().lower() == "auto":
        return "auto"
    try:
        return float(text.strip().removesuffix("s"))
    except ValueError:
        raise CompareError(f"lag {text!r}: expected auto or seconds, e.g. 0.0123") from None


def parse_notch(text: str, phase: Literal["zero", "causal"] = "zero") -> Filter:
    """``700`` or ``700:20``: middle, and quality (middle by width).

    Raises:
        CompareError: no numbers above 0.
    """
    middle, _, quality = text.partition(":")
    try:
        made = Filter(kind="notch", hz=float(middle), quality=float(quality or 30.0), phase=phase)
    except ValueError:
        raise CompareError(f"notch {text!r}: expected HZ or HZ:QUALITY, e.g. 700:30") from None
    if not made.hz > 0.0 or not made.quality > 0.0:
        raise CompareError(f"notch {text!r}: expected numbers above 0, e.g. 700:30")
    return made
