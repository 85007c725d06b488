"""Sections of sweeps by a plane across the tool axis, as pairs of discs; compiled.

A sweep is a row (w, dw, u, du, v, dv) of which w is the height; see `twin.motion.swept_kernels`.
"""

from __future__ import annotations

from twin.arrays import FloatArray
from twin.jit import helper
from twin.motion.swept_kernels import BodyShape
from twin.tools.meridian_kernels import profile_radius


@helper
def disc_parts(body: BodyShape, chords: FloatArray, z: float, chord: float, most_discs: int, parts: FloatArray) -> int:
    """Sections of the chords at a height, as discs at two ends of each or of pieces of it; returns their number.

    Between the two discs the radius is taken to grow evenly, so chords at which it does not are divided.

    Args:
        chord: how far the radius may be off that, mm.
        most_discs: by which the section of a chord is described at most.
    """
    tool, n = body.meridian, 0
    for i in range(len(chords)):
        tip, dz = chords[i, 0], chords[i, 1]
        first, last = _times_between(tip, dz, z - tool.height + body.drop, z)
        if first > last:
            continue
        shallow, deep = (first, last) if dz <= 0.0 else (last, first)
        pieces, most = 1, min(most_discs, (len(parts) - n) // (2 * (len(chords) - i)))
        while 2 * pieces <= most and not _grows_evenly(body, z - tip, dz, shallow, deep, pieces, chord):
            pieces *= 2
        for j in range(pieces):
            for e in range(2):
                t = shallow + (deep - shallow) * ((j + e) / pieces) ** 2
                parts[n, 3 * e] = chords[i, 2] + t * chords[i, 3]
                parts[n, 3 * e + 1] = chords[i, 4] + t * chords[i, 5]
                parts[n, 3 * e + 2] = radius_at(body, z - tip - t * dz)
            n += 1
    return n


@helper
def radius_at(body: BodyShape, above_tip: float) -> float:
    """Radius of the body's section at a height above the tool tip."""
    return profile_radius(body.meridian, min(max(0.0, above_tip + body.drop), body.meridian.height))


@helper
def _grows_evenly(
    body: BodyShape, height: float, dz: float, shallow: float, deep: float, pieces: int, chord: float
) -> bool:
    """Whether the radius in the middle of the first and of the last piece of a chord is about the mean of their ends.

    The radius grows fastest at the tip, where the first piece may begin; the last one is longest.
    """
    span = deep - shallow
    for piece in (0, pieces - 1):
        a, b = shallow + span * (piece / pieces) ** 2, shallow + span * ((piece + 1) / pieces) ** 2
        mean = 0.5 * (radius_at(body, height - a * dz) + radius_at(body, height - b * dz))
        if abs(radius_at(body, height - 0.5 * (a + b) * dz) - mean) > chord:
            return False
    return True


@helper
def _times_between(tip: float, dz: float, low: float, high: float) -> tuple[float, float]:
    """Interval of t in [0, 1] with low <= tip + t dz <= high; empty when first > last."""
    if dz == 0.0:
        return (0.0, 1.0) if low <= tip <= high else (1.0, 0.0)
    a, b = (low - tip) / dz, (high - tip) / dz
    return max(0.0, min(a, b)), min(1.0, max(a, b))


@helper
def reached_by_all(body: BodyShape, chords: FloatArray) -> float:
    """Height up to which the body reaches all along the chain."""
    end = len(chords) - 1
    return float(min(chords[0, 0], chords[end, 0] + chords[end, 1]) + body.meridian.height - body.drop)
