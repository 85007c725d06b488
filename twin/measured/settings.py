"""Reading, correction and comparison of a measured log: the one declaration of these keys.

The job's ``[measured]``, files of test cuts, the options and batch tables of ``twin compare``, and the functions that
read logs take these tables. Texts stay as written; the properties have their values.
"""

from __future__ import annotations

import re
from collections.abc import Callable
from typing import TYPE_CHECKING, Annotated, Any, Literal

from pydantic import BeforeValidator, Field, Strict

from twin.errors import MeasuredError
from twin.settings.force_on import ForceOn
from twin.settings.table import FilePath, Key, Table

if TYPE_CHECKING:
    from twin.measured.axes import AxisMap
    from twin.measured.filters import Filter
    from twin.measured.log import Gap
    from twin.measured.spans import Offset

#: Words for delimiters that are hard to write.
_DELIMITERS = {"tab": "\t", "\\t": "\t", "space": "", "semicolon": ";", "comma": ","}


def _understood(text: str, parse: Callable[[str], object]) -> str:
    """The text, when it can be parsed."""
    try:
        parse(text)
    except MeasuredError as error:
        raise ValueError(str(error)) from None
    return text


def _axis_map(value: Any) -> Any:
    from twin.measured.axes import AxisMap

    return _understood(value, AxisMap.parse) if isinstance(value, str) else value


def _window(value: Any) -> Any:
    from twin.measured.spans import parse_window

    text = _joined(value, ":")
    return _understood(text, parse_window) if isinstance(text, str) else value


def _offset(value: Any) -> Any:
    from twin.measured.spans import parse_offset

    text = _joined(value, ":" if isinstance(value, list | tuple) and len(value) == 2 else ",")
    return _understood(text, parse_offset) if isinstance(text, str) else value


def _notch(value: Any) -> Any:
    from twin.measured.filters import parse_notch

    text = f"{value:g}" if isinstance(value, int | float) and not isinstance(value, bool) else value
    return _understood(text, parse_notch) if isinstance(text, str) else value


def _joined(value: Any, mark: str) -> Any:
    """A list of numbers as one text."""
    return mark.join(map(repr, value)) if isinstance(value, list | tuple) else value


def _lag(value: Any) -> Any:
    if not isinstance(value, str):
        return value
    if value.strip().lower() == "auto":
        return None
    try:
        return float(value.strip().removesuffix("s"))
    except ValueError:
        raise ValueError(f"lag {value!r}: expected auto or seconds, e.g. 0.0123") from None


def _names(value: Any) -> Any:
    return tuple(name.strip() for name in value.split(",")) if isinstance(value, str) else value


def _listed(value: Any) -> Any:
    return tuple(re.split(r"[\s,]+", value.strip())) if isinstance(value, str) else value


def _delimiter(value: Any) -> Any:
    return _DELIMITERS.get(value.lower(), value) if isinstance(value, str) else value


class LogReading(Table):
    """Reading of a log as forces on the tool in machine axes."""

    map: Annotated[str | None, BeforeValidator(_axis_map), Key(metavar="MAP", unset="by the column names")] = Field(
        default=None, description="column and sign for each machine axis, e.g. x=-Fy,y=-Fx,z=Fz"
    )
    force_on: ForceOn = Field(default="tool", description="body on which the mapped force acts")
    columns: Annotated[
        Annotated[tuple[str, ...], Strict(False), BeforeValidator(_names)] | None,
        Key(as_text=True, metavar="NAMES", unset="those of the file"),
    ] = Field(default=None, description="names of all columns in order, with units, e.g. t_s,Fx_N,Fy_N,Fz_N")
    unit: Annotated[str | None, Key(metavar="UNIT", unset="from the column names")] = Field(
        default=None, min_length=1, description="unit of the forces: N, kN, lbf"
    )
    rate_hz: Annotated[float | None, Key(unset="from the file")] = Field(
        default=None, gt=0.0, description="sampling rate, Hz"
    )
    rpm: Annotated[float | None, Key(metavar="RPM", unset="none")] = Field(
        default=None,
        gt=0.0,
        description="spindle speed, rpm; converts spindle angle to time in a log without a time column",
    )
    delimiter: Annotated[str | None, BeforeValidator(_delimiter), Key(metavar="CHAR", unset="detected")] = Field(
        default=None, description="delimiter of a text file: the character, or tab, space, comma, semicolon"
    )
    decimal: Annotated[Literal[".", ","] | None, Key(unset="detected")] = Field(
        default=None, description="decimal mark of a text file"
    )
    group: Annotated[str | None, Key(metavar="NAME", unset="detected")] = Field(
        default=None,
        min_length=1,
        description="group to read from a TDMS or HDF5 file, variable of a MATLAB file, topic of an MCAP file",
    )
    angle_column: Annotated[str | None, Key(metavar="NAME", unset="by its name")] = Field(
        default=None, min_length=1, description="column that holds the spindle angle"
    )
    trigger_column: Annotated[str | None, Key(metavar="NAME", unset="by its name")] = Field(
        default=None, min_length=1, description="column that holds a once-per-revolution pulse"
    )

    @property
    def axis_map(self) -> AxisMap | None:
        """The map; None takes the columns that are named after the axes."""
        from twin.measured.axes import AxisMap

        return None if self.map is None else AxisMap.parse(self.map)


class LogCorrections(Table):
    """Corrections of a log before it is compared with a run."""

    lag_s: Annotated[
        float | None,
        BeforeValidator(_lag),
        Key(as_text=True, metavar="auto|SECONDS", unset="found by cross-correlation"),
    ] = Field(default=None, description="delay of the log, s, or auto: run time = log time - lag")
    lag_within_s: Annotated[float | None, Key(unset="any")] = Field(
        default=None, gt=0.0, description="largest delay to search, either sign, s"
    )
    phase: bool = Field(default=False, description="shift the run in each window to match the spindle phase of the log")
    offset: Annotated[str, BeforeValidator(_offset), Key(metavar="none|air|BEGIN:END|X,Y,Z")] = Field(
        default="none",
        description="amplifier zero to subtract: none, mean in air, mean over BEGIN:END on the log's clock, X,Y,Z in N",
    )
    drift: bool = Field(
        default=False, description="subtract a straight line fitted to the air segments; it removes the offset too"
    )
    resample_hz: Annotated[float | None, Key(unset="the log's rate")] = Field(
        default=None, gt=0.0, description="sampling rate of the comparison, Hz"
    )
    lowpass_hz: Annotated[float | None, Key(unset="none")] = Field(
        default=None, gt=0.0, description="cut-off frequency of a low-pass filter on log and run, Hz"
    )
    notches: Annotated[
        tuple[Annotated[str, BeforeValidator(_notch)], ...],
        Strict(False),
        BeforeValidator(_listed),
        Key(options=("--notch",), metavar="HZ[:Q]", unset="none"),
    ] = Field(default=(), description="notch filter on log and run: HZ or HZ:QUALITY")
    causal: bool = Field(default=False, description="run filters forwards only, not forwards and backwards")
    filter_both: Annotated[bool, Key(options=("--filter-both/--filter-log-only",))] = Field(
        default=True, description="filter the run as well as the log"
    )

    @property
    def zero(self) -> Offset:
        """The amplifier's zero."""
        from twin.measured.spans import parse_offset

        return parse_offset(self.offset)

    @property
    def filters(self) -> tuple[Filter, ...]:
        """The notches, then the low-pass."""
        from twin.measured.filters import Filter, Phase, parse_notch

        phase: Phase = "causal" if self.causal else "zero"
        lowpass = [] if self.lowpass_hz is None else [Filter(kind="lowpass", hz=self.lowpass_hz, phase=phase)]
        return (*(parse_notch(text, phase) for text in self.notches), *lowpass)


class CompareSettings(LogCorrections, LogReading):
    """Reading and correction of a log, and the windows in which it is compared with a run."""

    windows: Annotated[
        tuple[Annotated[str, BeforeValidator(_window)], ...],
        Strict(False),
        BeforeValidator(_listed),
        Key(options=("--window",), metavar="BEGIN:END", unset="the whole overlap"),
    ] = Field(default=(), description="window to compare, on the run's clock: BEGIN:END, s")

    @property
    def spans(self) -> tuple[Gap, ...]:
        """Begin and end of each window."""
        from twin.measured.spans import parse_window

        return tuple(map(parse_window, self.windows))


class LogFile(Table):
    """File of a log."""

    file: Annotated[FilePath | None, Key(unset="none")] = Field(
        default=None, description="the log, relative to the job file's folder"
    )


#: Nothing given: a log is read as its file states.
AS_IN_FILE = LogReading()
