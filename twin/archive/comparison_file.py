"""Comparisons of a run with a measured log in MCAP files: both forces sample by sample, and the results as JSON."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass
from os import PathLike
from pathlib import Path
from typing import Any

import numpy as np
from mcap.opcode import Opcode

from twin.archive import schemas
from twin.archive.container.chunk import to_ns
from twin.archive.container.container import Container
from twin.archive.container.frames import DAMAGE, McapFile
from twin.archive.container.partial import PartialFile
from twin.arrays import FloatArray
from twin.errors import ArchiveError

#: Attachment that holds the result.
RESULT = "comparison.json"
_METADATA = "twin.comparison"
_NAMES = tuple(name for name, _, _ in schemas.MESSAGES[schemas.COMPARISON])
_FLUSH_BYTES = 1 << 20


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class ComparedForces:
    """Both forces at the log's samples.

    Attributes:
        t_s: shape (n,), on the run's clock.
        spindle_angle_rad: shape (n,), of the run.
        measured_n, simulated_n: shape (n, 3), force on the tool in machine axes.
    """

    t_s: FloatArray
    spindle_angle_rad: FloatArray
    measured_n: FloatArray
    simulated_n: FloatArray


def write_comparison(
    path: str | PathLike[str],
    forces: ComparedForces,
    result: Mapping[str, Any],
    heads: Mapping[str, str],
    library: str,
    *,
    force: bool = False,
) -> None:
    """Write a comparison; the file has its name only when it is complete.

    Args:
        result: JSON object of all results.
        heads: a few of its values as text, for any MCAP tool to show.
        force: replace a file that exists.

    Raises:
        ArchiveError: the file exists already, or cannot be written; nothing is left then.
    """
    partial = PartialFile(Path(path), force=force)
    try:
        file = Container(partial.write, library, schemas.COMPARISON_PROFILE)
        file.start()
        file.add_attachment(RESULT, "application/json", json.dumps(result, ensure_ascii=False, indent=1).encode())
        file.add_metadata(_METADATA, dict(heads))
        rows = _encoded(forces)
        for t_s, row in zip(forces.t_s.tolist(), rows, strict=True):
            file.add_message(schemas.COMPARISON_TOPIC, to_ns(max(t_s, 0.0)), row.tobytes())
            if file.pending_bytes > _FLUSH_BYTES:
                file.flush()
        file.finish()
        partial.commit()
    except BaseException:
        partial.discard()
        raise


def is_comparison(path: str | PathLike[str]) -> bool:
    """Whether a file is a comparison."""
    try:
        with Path(path).open("rb") as file:
            return schemas.COMPARISON_PROFILE.encode() in file.read(64)
    except OSError:
        return False


def read_comparison(path: str | PathLike[str]) -> tuple[ComparedForces, dict[str, Any]]:
    """The forces in a comparison's file, and its results.

    Raises:
        ArchiveError: no such file, or not the file of a comparison.
    """
    from twin.archive.foreign import read_numbers

    columns = read_numbers(path, schemas.COMPARISON_TOPIC).columns
    if missing := [name for name in _NAMES if name not in columns]:
        raise ArchiveError(f"{path}: messages without {', '.join(missing)}, expected a comparison's file")
    values = [columns[name] for name in _NAMES]
    forces = ComparedForces(
        t_s=values[0],
        spindle_angle_rad=values[1],
        measured_n=np.column_stack(values[2:5]),
        simulated_n=np.column_stack(values[5:8]),
    )
    return forces, _result(path)


def _result(path: str | PathLike[str]) -> dict[str, Any]:
    """The attached results.

    Raises:
        ArchiveError: there are none, or they are damaged.
    """
    with McapFile(path) as file:
        for frame in file.frames():
            try:
                if frame.opcode == Opcode.ATTACHMENT and (found := file.attachment(frame)).name == RESULT:
                    return dict(json.loads(found.data))
            except DAMAGE as error:
                raise file.damaged(frame.offset, f"{RESULT} cannot be read") from error
    raise ArchiveError(f"{path}: holds no {RESULT}, expected a comparison's file")


def _encoded(forces: ComparedForces) -> np.ndarray[tuple[int], np.dtype[np.void]]:
    """Every sample as the bytes of one message: a tag and a double for each field, zeros too."""
    numbers = {name: number for name, number, _ in schemas.MESSAGES[schemas.COMPARISON]}
    kind = np.dtype([pair for name in _NAMES for pair in ((f"tag_{name}", "u1"), (name, "<f8"))])
    rows = np.zeros(len(forces.t_s), kind)
    columns = [forces.t_s, forces.spindle_angle_rad, *forces.measured_n.T, *forces.simulated_n.T]
    for name, values in zip(_NAMES, columns, strict=True):
        rows[f"tag_{name}"] = numbers[name] << 3 | 1
        rows[name] = values
    return rows
