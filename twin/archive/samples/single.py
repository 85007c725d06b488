"""Force samples with a message each, ``twin.CuttingForce``, as versions up to 0.1.0 wrote them."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from twin.archive import schemas
from twin.archive.samples.fixed_records import record_type
from twin.record import ForceSamples

_FIELDS = schemas.MESSAGES[schemas.FORCE]
_RECORD = record_type(schemas.FORCE)
#: The doubles of a record follow one another, each after its tag: t_s, angle, fx, fy, fz, torque, power.
_DOUBLES = sum(kind == "double" for _, _, kind in _FIELDS)
_DOUBLE_STRIDE = 9
_FIRST_DOUBLE = _RECORD.itemsize - len(_FIELDS) - 8 * _DOUBLES - 4 * (len(_FIELDS) - _DOUBLES) + 1
#: No force messages.
NO_RECORDS: NDArray[np.void] = np.empty(0, _RECORD)


def row(message: Any) -> NDArray[np.void]:
    """One decoded protobuf message as a record array of length 1, for the payloads of other writers."""
    record = np.zeros(1, _RECORD)
    for name, _, _ in _FIELDS:
        record[name] = getattr(message, name)
    return record


def to_samples(blocks: Sequence[NDArray[np.void]]) -> ForceSamples:
    """Force records as the samples of one step; the arrays are copies and read-only."""
    columns = np.concatenate([_doubles(b) for b in blocks] or [np.empty((_DOUBLES, 0))], axis=1)
    force = np.ascontiguousarray(columns[2:5].T)
    columns.flags.writeable = force.flags.writeable = False
    t_s, angle, _, _, _, torque, power = columns
    return ForceSamples(t_s=t_s, spindle_angle_rad=angle, force_n=force, torque_nm=torque, power_w=power)


def _doubles(block: NDArray[np.void]) -> NDArray[np.float64]:
    """View of the doubles of n > 0 records, shape (`_DOUBLES`, n)."""
    strides = (_DOUBLE_STRIDE, _RECORD.itemsize)
    return np.ndarray((_DOUBLES, len(block)), "<f8", block.data, _FIRST_DOUBLE, strides)
