"""Many runs against many logs, from one table file into one table of errors."""

from __future__ import annotations

import csv
import io
import tomllib
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from twin.comparison.comparison import Comparison, compare_files
from twin.comparison.settings import CompareSettings, parse_lag
from twin.errors import CompareError, TwinError
from twin.measured.axes import AxisMap
from twin.measured.filters import Filter
from twin.measured.spans import parse_offset, parse_window

#: Columns of a table, and what each does to the settings of its row.
_KEYS: dict[str, Callable[[CompareSettings, str], CompareSettings]] = {
    "windows": lambda s, t: replace(s, windows=tuple(parse_window(w) for w in t.replace(",", " ").split())),
    "lag": lambda s, t: replace(s, lag=parse_lag(t)),
    "lag_within_s": lambda s, t: replace(s, lag_within_s=_number("lag_within_s", t)),
    "offset": lambda s, t: replace(s, offset=parse_offset(t)),
    "drift": lambda s, t: replace(s, drift=_truth("drift", t)),
    "phase": lambda s, t: replace(s, phase=_truth("phase", t)),
    "lowpass_hz": lambda s, t: replace(s, filters=(*s.filters, Filter(kind="lowpass", hz=_number("lowpass_hz", t)))),
    "resample_hz": lambda s, t: replace(s, resample_hz=_number("resample_hz", t)),
    "map": lambda s, t: replace(s, read=replace(s.read, axis_map=AxisMap.parse(t))),
    "force_on": lambda s, t: replace(s, read=replace(s.read, force_on=_body(t))),
    "unit": lambda s, t: replace(s, read=replace(s.read, unit=t)),
    "rate_hz": lambda s, t: replace(s, read=replace(s.read, rate_hz=_number("rate_hz", t))),
    "rpm": lambda s, t: replace(s, read=replace(s.read, rpm=_number("rpm", t))),
    "columns": lambda s, t: replace(s, read=replace(s.read, columns=tuple(c.strip() for c in t.split(",")))),
    "group": lambda s, t: replace(s, read=replace(s.read, group=t)),
}
_NEEDED = ("run", "measured")
_OTHER = ("name", *_NEEDED)

#: Columns of the table of errors that comes out.
OUT_COLUMNS = (
    *("row", "name", "run", "measured", "status", "begin_s", "end_s", "axis", "mean_abs_n", "max_n", "rms_n", "bias_n"),
    *("rms_by_rms", "rms_by_peak", "ratio_of_means", "ratio_of_peaks", "correlation", "lag_s", "message"),
)


@dataclass(frozen=True, slots=True, kw_only=True)
class Row:
    """One row of a table of comparisons.

    Attributes:
        number: line of a CSV file, or number of the table in a TOML file, from 1.
        found: None where it failed: ``message`` says why.
    """

    number: int
    name: str
    run: str
    measured: str
    found: Comparison | None
    message: str


def compare_batch(path: Path, settings: Callable[[Path], CompareSettings]) -> Iterator[Row]:
    """Carry out a table's comparisons one after the other; a bad row gives its message and does not stop the others.

    Args:
        path: ``.csv`` with a header, or ``.toml`` with ``[[compare]]`` tables: ``run``, ``measured``, optional ``name``
            and the settings of the row. Files are relative to the table's folder.
        settings: for a run's file, what its row does not say.

    Raises:
        CompareError: the table itself cannot be read.
    """
    for number, cells in _rows(path):
        name = cells.get("name") or Path(cells.get("measured", "")).stem
        try:
            found = _compared(path, cells, settings)
            message = ""
        except TwinError as error:
            found, message = None, str(error)
        yield Row(
            number=number,
            name=name,
            run=cells.get("run", ""),
            measured=cells.get("measured", ""),
            found=found,
            message=message,
        )


def batch_csv(rows: list[Row]) -> str:
    """The table of errors: a line for each row, window and axis; a failed row has one line with its message."""
    out = io.StringIO()
    writer = csv.DictWriter(out, OUT_COLUMNS, lineterminator="\n")
    writer.writeheader()
    for row in rows:
        head = {"row": row.number, "name": row.name, "run": row.run, "measured": row.measured}
        if row.found is None:
            writer.writerow({**head, "status": "failed", "message": row.message})
            continue
        for window in row.found.windows:
            for errors in window.errors:
                values = {c: getattr(errors, c) for c in OUT_COLUMNS if c in type(errors).__slots__}
                times = {"begin_s": window.span_s[0], "end_s": window.span_s[1], "lag_s": row.found.lag_s}
                told = "; ".join(row.found.warnings)
                writer.writerow({**head, "status": "ok", **times, **values, "message": told})
    return out.getvalue()


def _compared(path: Path, cells: Mapping[str, str], settings: Callable[[Path], CompareSettings]) -> Comparison:
    for key in cells:
        if key not in _KEYS and key not in _OTHER:
            known = ", ".join((*_OTHER, *_KEYS))
            raise CompareError(f"unknown column {key!r}; expected some of {known}")
    for key in _NEEDED:
        if not cells.get(key):
            raise CompareError(f"{key} is missing; expected a file name, relative to {path.parent}")
    run = path.parent / cells["run"]
    made = settings(run)
    for key, take in _KEYS.items():
        if cells.get(key):
            made = take(made, cells[key])
    return compare_files(run, path.parent / cells["measured"], made)


def _rows(path: Path) -> list[tuple[int, dict[str, str]]]:
    """Number and cells of each row."""
    try:
        text = path.read_bytes().decode("utf-8-sig")
    except (OSError, UnicodeDecodeError) as error:
        why = getattr(error, "strerror", None) or "is no UTF-8 text"
        raise CompareError(f"{path}: cannot be read: {why.lower()}; expected a table of comparisons") from error
    rows = _toml_rows(path, text) if path.suffix.lower() == ".toml" else _csv_rows(path, text)
    if not rows:
        raise CompareError(f"{path}: no rows, expected comparisons with run and measured")
    return rows


def _csv_rows(path: Path, text: str) -> list[tuple[int, dict[str, str]]]:
    first = text.lstrip().partition("\n")[0]
    reader = csv.DictReader(io.StringIO(text), delimiter=";" if ";" in first else ",", skipinitialspace=True)
    names = [n.strip() for n in reader.fieldnames or ()]
    if missing := [n for n in _NEEDED if n not in names]:
        raise CompareError(
            f"{path}:1: no column {missing[0]!r}; expected {', '.join(_NEEDED)} and some of {', '.join(_KEYS)}"
        )
    rows = []
    for cells in reader:
        kept = {str(k).strip(): v.strip() for k, v in cells.items() if k and isinstance(v, str) and v.strip()}
        if kept:
            rows.append((reader.line_num, kept))
    return rows


def _toml_rows(path: Path, text: str) -> list[tuple[int, dict[str, str]]]:
    try:
        data = tomllib.loads(text)
    except tomllib.TOMLDecodeError as error:
        raise CompareError(f"{path}: no valid TOML: {error}") from error
    tables = data.get("compare")
    if not isinstance(tables, list) or not all(isinstance(t, dict) for t in tables):
        raise CompareError(f"{path}: no [[compare]] tables, expected one for each comparison")
    return [(n, {k: _text(v) for k, v in table.items()}) for n, table in enumerate(tables, 1)]


def _text(value: Any) -> str:
    """A TOML value as a cell."""
    if isinstance(value, list):
        return ",".join(map(str, value))
    return str(value).lower() if isinstance(value, bool) else str(value)


def _number(key: str, text: str) -> float:
    try:
        return float(text)
    except ValueError:
        raise CompareError(f"{key} = {text!r}: expected a number") from None


def _truth(key: str, text: str) -> bool:
    if text.lower() not in ("true", "false", "yes", "no", "1", "0"):
        raise CompareError(f"{key} = {text!r}: expected true or false")
    return text.lower() in ("true", "yes", "1")


def _body(text: str) -> Any:
    if text not in ("tool", "workpiece"):
        raise CompareError(f"force_on = {text!r}: expected tool or workpiece")
    return text
