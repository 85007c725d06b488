"""Force sums over teeth and edge elements (tri-slice paper, eq. 5); compiled.

The sum gathers an engagement map; see `twin.cutting.engagement_kernels`.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from twin.arrays import FloatArray
from twin.cutting.edge_arrays import EdgeArrays, Flutes, RowAngles
from twin.cutting.equation_kernels import (
    Coefficients,
    EdgeForce,
    edge_force,
    kienzle_force,
    normal_along_feed,
    to_machine_axes,
    uncut_chip_thickness,
)
from twin.jit import helper, njit

#: Coefficients of the linear law, the first of `Coefficients`.
LINEAR = 6


class Steps(NamedTuple):
    """Steps to be summed.

    Attributes:
        first_rad: shape (steps,), signed spindle angle of each step's first sample; the others are one row apart.
        offsets: shape (steps + 1,), where the samples of each step begin in the output.
        sense: shape (steps,), +1 for M3, -1 for M4.
        feed: shape (steps, 3), unit feed directions.
        feed_per_rev: shape (steps,), mm.
        share, turn: shape (steps, rows, elements), each step's engagement map.
    """

    first_rad: FloatArray
    offsets: NDArray[np.int64]
    sense: FloatArray
    feed: FloatArray
    feed_per_rev: FloatArray
    share: FloatArray
    turn: FloatArray


class Step(NamedTuple):
    """Numbers of one step; see `Steps`.

    Attributes:
        feed_x, feed_y, feed_z: unit feed direction.
        period: number of samples after which they repeat.
        least_chip: chips thinner than this do not count, mm.
    """

    first_rad: float
    sense: float
    feed_x: float
    feed_y: float
    feed_z: float
    feed_per_rev: float
    period: int
    least_chip: float


@njit
def sum_forces_of_steps(
    steps: Steps,
    flutes: Flutes,
    edges: EdgeArrays,
    rows: RowAngles,
    k: Coefficients,
    period: int,
    least_chip: float,
    out: FloatArray,
) -> None:
    """Forces on the tool and torques of several steps, each with its own map; see `sum_forces`.

    Args:
        least_chip: as a fraction of the feed per revolution.
        out: shape (samples of all steps, 4).
    """
    first_rad, offsets, sense, feed, feed_per_rev, share, turn = steps
    for s in range(len(first_rad)):
        step = Step(
            first_rad[s],
            sense[s],
            feed[s, 0],
            feed[s, 1],
            feed[s, 2],
            feed_per_rev[s],
            period,
            least_chip * feed_per_rev[s],
        )
        sum_forces(step, share[s], turn[s], flutes, edges, rows, k, out[offsets[s] : offsets[s + 1]])


@helper
def sum_forces(
    step: Step,
    share: FloatArray,
    turn: FloatArray,
    flutes: Flutes,
    edges: EdgeArrays,
    rows: RowAngles,
    k: Coefficients,
    out: FloatArray,
) -> None:
    """Force on the tool and torque at spindle angles, summed over teeth and elements (tri-slice paper, eq. 5).

    Samples are one row of the map apart, so an element of a tooth is at the same fraction between two rows in all of
    them, one row farther in each: the map is gathered with a shift.

    Args:
        share, turn: the engagement map, shape (rows, elements).
        out: shape (samples, 4): Fx, Fy, Fz in N and torque in N mm.
    """
    count, elements = share.shape
    teeth, backs = flutes.feed_part.shape
    angle, feed_part, runout_step_mm = flutes.angle, flutes.feed_part, flutes.runout_step_mm
    cos_row, sin_row = rows.cos, rows.sin
    cos_kappa, sin_kappa, radius, length = edges.cos_kappa, edges.sin_kappa, edges.radius, edges.length
    kienzle = k.mt != 0.0 or k.mr != 0.0 or k.ma != 0.0
    samples = min(len(out), step.period)
    shift = 1 if step.sense > 0.0 else -1
    column = np.empty(count + 1)
    for s in range(samples):
        out[s, 0], out[s, 1], out[s, 2], out[s, 3] = 0.0, 0.0, 0.0, 0.0
    for i in range(elements):
        if not _gather(share, i, column):
            continue
        cos_k, sin_k = cos_kappa[i], sin_kappa[i]
        for m in range(teeth):
            theta = -step.first_rad + step.sense * angle[m, i]
            row, fraction = _row_of(theta, count)
            cos_0, sin_0 = math.cos(theta), math.sin(theta)
            turned = 0
            for s in range(samples):
                engaged = _between_rows(column[row], column[row + 1], fraction, turn[row, i])
                if engaged > 0.0:
                    cos_s, sin_s = cos_row[turned], -step.sense * sin_row[turned]
                    cos_t = cos_0 * cos_s - sin_0 * sin_s
                    sin_t = sin_0 * cos_s + cos_0 * sin_s
                    n_dot_f = normal_along_feed(cos_t * step.feed_x + sin_t * step.feed_y, step.feed_z, sin_k, cos_k)
                    chip = math.inf
                    for back in range(backs):
                        feed_per_tooth = feed_part[m, back] * step.feed_per_rev
                        out_by = runout_step_mm[m, back, i] * sin_k
                        chip = min(chip, uncut_chip_thickness(feed_per_tooth, n_dot_f, out_by))
                    if chip > step.least_chip:
                        db = engaged * length[i]
                        force = kienzle_force(k, chip, db) if kienzle else edge_force(k, chip, db)
                        x, y, z = to_machine_axes(force, step.sense, cos_t, sin_t, cos_k, sin_k)
                        out[s, 0] += x
                        out[s, 1] += y
                        out[s, 2] += z
                        out[s, 3] += force.tangential * radius[i]
                turned = turned + 1 if turned + 1 < count else 0
                row = _next_row(row, shift, count)
    for s in range(samples, len(out)):
        for c in range(4):
            out[s, c] = out[s - step.period, c]


@njit
def sum_unit_forces(
    step: Step,
    share: FloatArray,
    turn: FloatArray,
    flutes: Flutes,
    edges: EdgeArrays,
    rows: RowAngles,
    out: FloatArray,
) -> None:
    """Forces on the tool under the linear law when one coefficient is 1 and the others are 0, all in one pass.

    Args:
        share, turn: the engagement map, shape (rows, elements).
        out: shape (samples, 3, 6): Fx, Fy, Fz, for each coefficient in the order of `Coefficients`.
    """
    count, elements = share.shape
    teeth, backs = flutes.feed_part.shape
    samples = min(len(out), step.period)
    shift = 1 if step.sense > 0.0 else -1
    column = np.empty(count + 1)
    for s in range(samples):
        for axis in range(3):
            for c in range(LINEAR):
                out[s, axis, c] = 0.0
    for i in range(elements):
        if not _gather(share, i, column):
            continue
        cos_k, sin_k = edges.cos_kappa[i], edges.sin_kappa[i]
        for m in range(teeth):
            theta = -step.first_rad + step.sense * flutes.angle[m, i]
            row, fraction = _row_of(theta, count)
            cos_0, sin_0 = math.cos(theta), math.sin(theta)
            for s in range(samples):
                engaged = _between_rows(column[row], column[row + 1], fraction, turn[row, i])
                row = _next_row(row, shift, count)
                if engaged > 0.0:
                    cos_s, sin_s = rows.cos[s % count], -step.sense * rows.sin[s % count]
                    cos_t = cos_0 * cos_s - sin_0 * sin_s
                    sin_t = sin_0 * cos_s + cos_0 * sin_s
                    n_dot_f = normal_along_feed(cos_t * step.feed_x + sin_t * step.feed_y, step.feed_z, sin_k, cos_k)
                    chip = math.inf
                    for back in range(backs):
                        feed_per_tooth = flutes.feed_part[m, back] * step.feed_per_rev
                        out_by = flutes.runout_step_mm[m, back, i] * sin_k
                        chip = min(chip, uncut_chip_thickness(feed_per_tooth, n_dot_f, out_by))
                    if chip > step.least_chip:
                        db = engaged * edges.length[i]
                        for c in range(LINEAR):
                            size = db if c % 2 else chip * db
                            force = EdgeForce(
                                size if c < 2 else 0.0, size if 1 < c < 4 else 0.0, size if c > 3 else 0.0
                            )
                            x, y, z = to_machine_axes(force, step.sense, cos_t, sin_t, cos_k, sin_k)
                            out[s, 0, c] += x
                            out[s, 1, c] += y
                            out[s, 2, c] += z
    for s in range(samples, len(out)):
        for axis in range(3):
            for c in range(LINEAR):
                out[s, axis, c] = out[s - step.period, axis, c]


@helper
def _gather(share: FloatArray, i: int, column: FloatArray) -> bool:
    """Copy an element's shares at all rows, the first again at the end; returns whether any is above 0."""
    any_share = False
    for j in range(len(share)):
        column[j] = share[j, i]
        if column[j] > 0.0:
            any_share = True
    column[len(share)] = column[0]
    return any_share


@helper
def _row_of(theta: float, rows: int) -> tuple[int, float]:
    """The row at or before an angle, and the fraction of a row from there to it."""
    position = theta * (rows / (2.0 * math.pi))
    whole = math.floor(position)
    return int(whole) % rows, position - whole


@helper
def _between_rows(a: float, b: float, fraction: float, turn: float) -> float:
    """Engaged share of an element between two rows: it changes at ``turn``, or is interpolated."""
    if a + b == 1.0 and a * b == 0.0:
        return a if fraction < turn else b
    return (1.0 - fraction) * a + fraction * b


@helper
def _next_row(row: int, shift: int, rows: int) -> int:
    """The row of the next sample: one earlier for M3 (shift 1), one later for M4 (shift -1)."""
    row -= shift
    if row < 0:
        row += rows
    elif row >= rows:
        row -= rows
    return row
