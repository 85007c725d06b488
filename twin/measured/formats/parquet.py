"""Parquet files."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from twin.errors import MeasuredError
from twin.measured.formats.bounds import check_size
from twin.measured.table import Table, few, table
from twin.measured.units import LOGICAL


def read_parquet(path: Path) -> Table:
    """Columns of numbers and of time; a column's unit may be in its metadata as ``unit``.

    Raises:
        MeasuredError: no Parquet file, or no columns of numbers.
    """
    import pyarrow as pa
    from pyarrow import parquet

    try:
        file = parquet.ParquetFile(path)
        _check_sizes(path, file.metadata)
        read = file.read()
        read.validate(full=True)
        names = read.schema.names
    except (OSError, pa.ArrowException, UnicodeDecodeError) as error:
        raise MeasuredError(f"{path}: no Parquet file that can be read: {_reason(error)}") from error
    columns, left = [], []
    for index, name in enumerate(names):
        field = read.schema.field(index)
        values, unit = _numbers(read.column(index), field.type)
        if values is None:
            left.append(f"{name} ({field.type})")
        else:
            columns.append((name, unit or _unit(field.metadata), values))
    notes = [f"columns not read: {few(left)}"] if left else []
    rate = (read.schema.metadata or {}).get(b"rate_hz")
    return table(path, "Parquet", columns, rate_hz=_number(rate), row_word="row", notes=notes, not_read=left)


def _reason(error: Exception) -> str:
    """The libraries' message; a column's name in another code than UTF-8 by itself."""
    return "a name that is not UTF-8" if isinstance(error, UnicodeDecodeError) else str(error)


def _check_sizes(path: Path, metadata: Any) -> None:
    """Refuse a table that is larger unpacked than measured forces can be."""
    check_size(path, 8.0 * metadata.num_rows * metadata.num_columns, "its columns")
    check_size(path, sum(metadata.row_group(i).total_byte_size for i in range(metadata.num_row_groups)), "its columns")


def _numbers(column: Any, kind: Any) -> tuple[Any, str]:
    """Values as floats, and the unit where the type states it; None for text."""
    import pyarrow as pa
    import pyarrow.compute as pc

    if pa.types.is_timestamp(kind) or pa.types.is_duration(kind):
        whole = column.cast(pa.int64())
        scale = {"s": 1.0, "ms": 1e-3, "us": 1e-6, "ns": 1e-9}[kind.unit]
        first = pc.min(whole).as_py() if pa.types.is_timestamp(kind) else 0
        return (whole.to_numpy() - (first or 0)) * scale, "s"
    if pa.types.is_time(kind):
        scale = {"s": 1.0, "ms": 1e-3, "us": 1e-6, "ns": 1e-9}[kind.unit]
        return column.cast(pa.int32() if pa.types.is_time32(kind) else pa.int64()).to_numpy() * scale, "s"
    if pa.types.is_floating(kind) or pa.types.is_integer(kind) or pa.types.is_decimal(kind):
        return column.cast(pa.float64()).to_numpy().astype(np.float64), ""
    if pa.types.is_boolean(kind):
        return column.cast(pa.int8()).cast(pa.float64()).to_numpy(), LOGICAL
    return None, ""


def _unit(metadata: Any) -> str:
    found = (metadata or {}).get(b"unit") or (metadata or {}).get(b"units") or b""
    return str(found.decode(errors="replace"))


def _number(text: bytes | None) -> float | None:
    try:
        return float(text) if text is not None else None
    except ValueError:
        return None
