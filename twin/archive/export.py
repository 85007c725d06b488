"""Forces out of an archive: as an Arrow table, as CSV, as Parquet."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import AbstractContextManager, contextmanager
from itertools import chain
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING, Any, BinaryIO, get_args

from twin.archive.container.partial import replacing
from twin.archive.force_table import force_schema, force_tables
from twin.archive.reader import read_run
from twin.archive.run_metadata import without_samples
from twin.errors import ArchiveError
from twin.record import Record, RunHeader
from twin.settings.force_on import ForceOn

if TYPE_CHECKING:
    import pyarrow as pa


def read_forces(path: str | PathLike[str], on: ForceOn = "tool") -> pa.Table:
    """All force samples of a run.

    Args:
        on: the body that feels the force, ``"tool"`` or ``"workpiece"`` (opposite sign).

    Returns:
        columns t_s, spindle_angle_rad, fx_n, fy_n, fz_n, torque_nm, power_w, nc_line, tool (names have the unit).

    Raises:
        ArchiveError: see `twin.archive.read_run`; or an unknown ``on``.
    """
    import pyarrow as pa

    _check_on(on)
    return pa.concat_tables(force_tables(force_records(path), on))


def force_records(path: str | PathLike[str]) -> Iterator[Record]:
    """The records of a run whose force samples are wanted.

    Raises:
        ArchiveError: see `twin.archive.read_run`; or the archive keeps the values of each revolution only.
    """
    for record in read_run(path):
        if isinstance(record, RunHeader) and (reason := without_samples(record)):
            raise ArchiveError(f"{path}: {reason}")
        yield record


def export_forces(run: str | PathLike[str], out: str | PathLike[str], on: ForceOn = "tool", force: bool = False) -> int:
    """Write all force samples of a run to a ``.csv`` or ``.parquet`` file, with flat memory.

    Args:
        on: see `read_forces`.
        force: replace ``out`` if it exists.

    Returns:
        number of rows written.

    Raises:
        ArchiveError: unknown suffix or ``on``; ``out`` exists; the run cannot be read; ``out`` cannot be written.
            There is no file of the name ``out`` then.
    """
    target = Path(out)
    writer = _WRITERS.get(target.suffix.lower())
    if writer is None:
        raise ArchiveError(f"{target}: suffix {target.suffix!r} is not known, expected {' or '.join(_WRITERS)}")
    _check_on(on)
    if target.exists() and not force:
        raise ArchiveError(f"{target}: already exists; replace it with --force")
    tables = force_tables(force_records(run), on)
    first = next(tables)
    rows = 0
    with replacing(target) as partial, writer(partial, force_schema(on)) as sink:
        for table in chain([first], tables):
            sink.write_table(table)
            rows += table.num_rows
    return rows


def write_csv(run: str | PathLike[str], stream: BinaryIO, on: ForceOn = "tool") -> None:
    """Write all force samples of a run as CSV to a stream, with flat memory.

    Raises:
        ArchiveError: unknown ``on``, or a run that cannot be read.
        OSError: the stream cannot be written, or its reader is gone.
    """
    _check_on(on)
    tables = force_tables(force_records(run), on)
    first = next(tables)
    with _csv_to(stream, force_schema(on)) as sink:
        for table in chain([first], tables):
            sink.write_table(table)


def _check_on(on: str) -> None:
    if on not in get_args(ForceOn):
        raise ArchiveError(f"forces on {on!r} are not known, expected {' or '.join(map(repr, get_args(ForceOn)))}")


@contextmanager
def _csv(path: Path, schema: pa.Schema) -> Iterator[Any]:
    with path.open("wb") as file, _csv_to(file, schema) as sink:
        yield sink


@contextmanager
def _csv_to(stream: BinaryIO, schema: pa.Schema) -> Iterator[Any]:
    from pyarrow import csv

    stream.write(f"{','.join(schema.names)}\n".encode())
    with csv.CSVWriter(stream, schema, write_options=csv.WriteOptions(include_header=False)) as sink:
        yield sink


@contextmanager
def _parquet(path: Path, schema: pa.Schema) -> Iterator[Any]:
    from pyarrow import parquet

    with parquet.ParquetWriter(path, schema) as sink:
        yield sink


_WRITERS: dict[str, Callable[[Path, Any], AbstractContextManager[Any]]] = {".csv": _csv, ".parquet": _parquet}
