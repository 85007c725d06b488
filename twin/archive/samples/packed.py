"""Force samples of many steps in one message, ``twin.PackedForces``.

Times and angles are exact: their columns hold the 64 bits of each double. Forces and torque are whole multiples of a
unit, the power of two that is 2**-20 of the power of two above the largest one of the step. So a value is wrong by less
than a millionth of the largest component of the step, whatever the steps are packed with. The power follows from the
torque and the spindle speed, and has a column of its own only where it does not.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any, cast

import numpy as np
from numpy.typing import NDArray

from twin.archive import schemas
from twin.archive.samples.columns import pack, unpack
from twin.arrays import FloatArray
from twin.record import ForceSamples, Step

#: Bits of the largest component of a step.
BITS = 20
#: Differences taken of times, angles, forces and torques.
_ORDER = 2
#: Values from here on are stored as doubles.
_HUGE = 2.0**1000
_AXES = ("fx_n", "fy_n", "fz_n")
_RAD_S = 2.0 * math.pi / 60.0


def encode(steps: Sequence[Step]) -> bytes:
    """All samples of some steps, each of which has some, as a protobuf message."""
    samples = [step.samples for step in steps]
    counts = np.array([len(s.t_s) for s in samples])
    force = np.concatenate([s.force_n for s in samples])
    torque = np.concatenate([s.torque_nm for s in samples])
    power = np.concatenate([s.power_w for s in samples])
    values: dict[str, Any] = {
        "samples": counts.tolist(),
        "nc_line": [step.nc_line for step in steps],
        "tool": [step.tool for step in steps],
        "t_s": _exact(np.concatenate([s.t_s for s in samples])),
        "spindle_angle_rad": _exact(np.concatenate([s.spindle_angle_rad for s in samples])),
    }
    exponents, columns = _scaled(force, counts)
    values |= dict(zip(_AXES, columns, strict=True)) | {"force_exponent": exponents}
    values["torque_exponent"], (values["torque_nm"],) = _scaled(torque[:, None], counts)
    rpm = np.array([step.spindle_rpm for step in steps])
    if not np.array_equal(power, _power(torque, rpm, counts)):
        values["power_exponent"], (values["power_w"],) = _scaled(power[:, None], counts)
    return cast(bytes, schemas.message_class(schemas.PACKED)(**values).SerializeToString())


def decode(message: Any, spindle_rpm: Sequence[float]) -> list[ForceSamples]:
    """The samples of each step; the arrays are read-only.

    Args:
        message: a ``twin.PackedForces``.
        spindle_rpm: spindle speed in each of its steps.

    Raises:
        ValueError: a column has a wrong length.
    """
    counts = np.array(message.samples, np.int64)
    count = int(counts.sum())
    if count > len(message.t_s):
        raise ValueError(f"{count} force samples with the times of {len(message.t_s)} at most")
    t_s, angle = (unpack(data, count, _ORDER).view(np.float64) for data in (message.t_s, message.spindle_angle_rad))
    axes = [getattr(message, name) for name in _AXES]
    force = _unscaled(axes, message.force_exponent, counts)
    torque = _unscaled([message.torque_nm], message.torque_exponent, counts)[:, 0]
    if message.power_w:
        power = _unscaled([message.power_w], message.power_exponent, counts)[:, 0]
    else:
        power = _power(torque, np.array(spindle_rpm), counts)
    for array in (t_s, angle, force, torque, power):
        array.flags.writeable = False
    ends = np.cumsum(counts).tolist()
    return [
        ForceSamples(
            t_s=t_s[first:end],
            spindle_angle_rad=angle[first:end],
            force_n=force[first:end],
            torque_nm=torque[first:end],
            power_w=power[first:end],
        )
        for first, end in zip([0, *ends[:-1]], ends, strict=True)
    ]


def _exact(values: FloatArray) -> bytes:
    """The bit patterns of doubles as a column."""
    return pack(np.ascontiguousarray(values).view(np.int64), _ORDER)


def _scaled(values: FloatArray, counts: NDArray[np.int64]) -> tuple[list[int], list[bytes]]:
    """Columns of whole multiples of each step's unit.

    Args:
        values: shape (n, m).
        counts: samples of each step.

    Returns:
        The exponent of two of each step's largest value, and the m columns; no exponents where the columns are exact
        instead, since a value is huge or not a number.
    """
    largest = np.abs(values).max(axis=1)
    if not largest.max() < _HUGE:
        return [], [_exact(column) for column in values.T]
    _, exponents = np.frexp(np.maximum.reduceat(largest, np.cumsum(counts) - counts))
    whole = np.rint(np.ldexp(values, np.repeat(BITS - exponents, counts)[:, None])).astype(np.int64)
    return exponents.tolist(), [pack(column, _ORDER) for column in whole.T]


def _unscaled(columns: Sequence[bytes], exponents: Sequence[int], counts: NDArray[np.int64]) -> FloatArray:
    """The values of `_scaled`, shape (n, m).

    Raises:
        ValueError: a column has a wrong length.
    """
    count = int(counts.sum())
    whole = np.column_stack([unpack(column, count, _ORDER) for column in columns])
    if not len(exponents):
        return whole.view(np.float64)
    return np.asarray(np.ldexp(whole.astype(np.float64), np.repeat(np.array(exponents) - BITS, counts)[:, None]))


def _power(torque_nm: FloatArray, spindle_rpm: FloatArray, counts: NDArray[np.int64]) -> FloatArray:
    """Power as the replay computes it, W."""
    with np.errstate(over="ignore", invalid="ignore"):
        return np.asarray(torque_nm * np.repeat(np.abs(spindle_rpm), counts) * _RAD_S)
