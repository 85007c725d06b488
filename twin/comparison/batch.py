"""Many runs against many logs, from one table file into one table of errors."""

from __future__ import annotations

import csv
import io
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any

from pydantic import Field

from gcode.underline import harmless
from twin.comparison.comparison import Comparison, compare_files
from twin.errors import SettingsError, TwinError
from twin.measured.settings import CompareSettings
from twin.settings.check import checked
from twin.settings.table import FilePath, Key
from twin.settings.toml_file import parse_toml, read_text

#: Former names of keys.
_FORMER = {"lag": "lag_s"}


class BatchRow(CompareSettings):
    """A row of a table: a run, a log, and the settings of their comparison."""

    name: Annotated[str, Key(unset="the log's name")] = Field(
        default="", description="name of the row in messages and results"
    )
    run: FilePath = Field(description="archive of the run, relative to the table's folder")
    measured: FilePath = Field(description="measured log, relative to the table's folder")


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
        found: None where it failed; ``message`` has the reason.
    """

    number: int
    name: str
    run: str
    measured: str
    found: Comparison | None
    message: str


def compare_batch(path: Path, base: Callable[[Path], Mapping[str, Any]]) -> Iterator[Row]:
    """Carry out a table's comparisons one after the other; a wrong row gives its message and does not stop the others.

    Args:
        path: ``.csv`` with a header, or ``.toml`` with ``[[compare]]`` tables; keys as in `BatchRow`.
        base: for a run's file, the settings that its row does not give.

    Raises:
        SettingsError: the table itself cannot be read.
    """
    for number, cells in _rows(path):
        run, measured = str(cells.get("run", "")), str(cells.get("measured", ""))
        try:
            found, message = _compared(path, cells, base), ""
        except SettingsError as error:
            found, message = None, "; ".join(error.problems)
        except TwinError as error:
            found, message = None, str(error)
        name = " ".join(str(cells.get("name") or Path(measured).stem).splitlines())
        yield Row(number=number, name=name, run=run, measured=measured, found=found, message=message)


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
                message = "; ".join(row.found.warnings)
                writer.writerow({**head, "status": "ok", **times, **values, "message": message})
    return harmless(out.getvalue())


def _compared(path: Path, cells: Mapping[str, Any], base: Callable[[Path], Mapping[str, Any]]) -> Comparison:
    inherited = base(path.parent / str(cells["run"])) if cells.get("run") else {}
    strict = None if path.suffix.lower() == ".toml" else False
    row = checked(BatchRow, {**inherited, **cells}, str(path), strict=strict)
    return compare_files(path.parent / row.run, path.parent / row.measured, row)


def _rows(path: Path) -> list[tuple[int, dict[str, Any]]]:
    """Number and cells of each row."""
    text = read_text(path, "a table of comparisons")
    rows = _toml_rows(path, text) if path.suffix.lower() == ".toml" else _csv_rows(path, text)
    if not rows:
        raise SettingsError(str(path), ["no rows, expected comparisons with run and measured"])
    return [(number, {_FORMER.get(key, key): value for key, value in cells.items()}) for number, cells in rows]


def _csv_rows(path: Path, text: str) -> list[tuple[int, dict[str, Any]]]:
    first = text.lstrip().partition("\n")[0]
    reader = csv.DictReader(io.StringIO(text), delimiter=";" if ";" in first else ",", skipinitialspace=True)
    names = [n.strip() for n in reader.fieldnames or ()]
    if missing := [n for n in ("run", "measured") if n not in names]:
        known = ", ".join(BatchRow.model_fields)
        raise SettingsError(f"{path}:1", [f"no column {missing[0]!r}; expected run, measured, and any of {known}"])
    rows = []
    for cells in reader:
        kept = {str(k).strip(): v.strip() for k, v in cells.items() if k and isinstance(v, str) and v.strip()}
        if kept:
            rows.append((reader.line_num, kept))
    return rows


def _toml_rows(path: Path, text: str) -> list[tuple[int, dict[str, Any]]]:
    tables = parse_toml(text, str(path)).get("compare")
    if not isinstance(tables, list) or not all(isinstance(t, dict) for t in tables):
        raise SettingsError(str(path), ["no [[compare]] tables, expected one for each comparison"])
    return [*enumerate(tables, 1)]
