"""Coordinate frames: program coordinates to machine coordinates and back.

    machine = zero + M (program)

`M` is None for the identity, which is what nearly every program has; then a coordinate is exactly zero + value.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TypeAlias

from gcode.events import NO_EXTRA, PLANE_AXES, Extra, Point

Matrix: TypeAlias = tuple[Point, Point, Point]

ORIGIN: Point = (0.0, 0.0, 0.0)
_IDENTITY: Matrix = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))
#: Two positions nearer than this are one. No control resolves better than 1e-4 mm, and sums of a program's numbers in
#: doubles stay within 1e-9 mm over a machine's travel.
SAME_POSITION_MM = 1e-6
#: Relative difference of two scale factors that counts as none.
_SAME_SCALE = 1e-9


@dataclass(frozen=True, slots=True, kw_only=True)
class CoordinateFrame:
    """Program coordinates in machine coordinates: a zero, and a matrix where they are transformed.

    Attributes:
        zero_mm: program zero in machine coordinates.
        matrix: rotation, scaling and mirror image, by rows; None for none.
        inverse: its inverse, None with it.
        extra: zero of the further axes in machine coordinates.
    """

    zero_mm: Point = ORIGIN
    matrix: Matrix | None = None
    inverse: Matrix | None = None
    extra: Extra = NO_EXTRA

    def to_machine(self, point: Point) -> Point:
        """Machine coordinates of a point given in program coordinates, mm."""
        x, y, z = point if self.matrix is None else _times(self.matrix, point)
        return (self.zero_mm[0] + x, self.zero_mm[1] + y, self.zero_mm[2] + z)

    def to_program(self, point: Point) -> Point:
        """Program coordinates of a point given in machine coordinates, mm."""
        x, y, z = (point[0] - self.zero_mm[0], point[1] - self.zero_mm[1], point[2] - self.zero_mm[2])
        return (x, y, z) if self.inverse is None else _times(self.inverse, (x, y, z))

    def vector_to_machine(self, vector: Point) -> Point:
        """A difference of two program points, in machine axes."""
        return vector if self.matrix is None else _times(self.matrix, vector)

    @property
    def keeps_lengths(self) -> bool:
        """Whether program lengths are lengths of the machine: no scaling, but perhaps rotation or mirror image."""
        columns = zip(*self.matrix, strict=True) if self.matrix is not None else ()
        return all(abs(math.hypot(*column) - 1.0) <= _SAME_SCALE for column in columns)

    def plane_scale(self, plane: int) -> float | None:
        """Signed scale of the plane, negative where it is mirrored; None where the scale is not uniform.

        Raises nothing: a frame that tilts the plane does not exist here.
        """
        if self.matrix is None:
            return 1.0
        i, j, _ = PLANE_AXES[plane]
        m = self.matrix
        a, b, c, d = m[i][i], m[i][j], m[j][i], m[j][j]
        first, second = math.hypot(a, c), math.hypot(b, d)
        if abs(first - second) > _SAME_SCALE * max(first, second) or abs(a * b + c * d) > _SAME_SCALE * first * second:
            return None
        return math.copysign(first, a * d - b * c)


def plus(a: Point, b: Point) -> Point:
    """A + b."""
    return (a[0] + b[0], a[1] + b[1], a[2] + b[2])


def difference(a: Point, b: Point) -> Point:
    """A - b."""
    return (a[0] - b[0], a[1] - b[1], a[2] - b[2])


def _times(m: Matrix, p: Point) -> Point:
    return (
        m[0][0] * p[0] + m[0][1] * p[1] + m[0][2] * p[2],
        m[1][0] * p[0] + m[1][1] * p[1] + m[1][2] * p[2],
        m[2][0] * p[0] + m[2][1] * p[1] + m[2][2] * p[2],
    )


def _product(a: Matrix, b: Matrix) -> Matrix:
    columns = [_times(a, (b[0][k], b[1][k], b[2][k])) for k in range(3)]
    x, y, z = ((columns[0][r], columns[1][r], columns[2][r]) for r in range(3))
    return (x, y, z)


@dataclass(frozen=True, slots=True, kw_only=True)
class Transform:
    """A map of program coordinates onto program coordinates: p -> centre + M (p - centre)."""

    matrix: Matrix
    inverse: Matrix
    centre_mm: Point

    def of(self, point: Point) -> Point:
        """The image of a point."""
        return plus(self.centre_mm, _times(self.matrix, difference(point, self.centre_mm)))


def rotation(plane: int, angle_deg: float, centre_mm: Point = ORIGIN) -> Transform:
    """Rotation of a plane about a point, counter-clockwise seen from the plane's positive normal."""
    return Transform(matrix=_rotated(plane, angle_deg), inverse=_rotated(plane, -angle_deg), centre_mm=centre_mm)


def _rotated(plane: int, angle_deg: float) -> Matrix:
    i, j, _ = PLANE_AXES[plane]
    c, s = _exact_cos_sin(angle_deg)
    m = [list(row) for row in _IDENTITY]
    m[i][i], m[i][j], m[j][i], m[j][j] = c, -s, s, c
    return _matrix(m)


def _exact_cos_sin(angle_deg: float) -> tuple[float, float]:
    """Cosine and sine, exact at multiples of a right angle, where programs expect exact coordinates."""
    quarter, rest = divmod(angle_deg, 90.0)
    if rest == 0.0:
        return ((1.0, 0.0), (0.0, 1.0), (-1.0, 0.0), (0.0, -1.0))[int(quarter) % 4]
    return math.cos(math.radians(angle_deg)), math.sin(math.radians(angle_deg))


def _matrix(rows: list[list[float]]) -> Matrix:
    x, y, z = ((row[0], row[1], row[2]) for row in rows)
    return (x, y, z)


def scaling(factors: Point, centre_mm: Point = ORIGIN) -> Transform:
    """Scaling along the axes about a point; a factor of -1 is a mirror image. No factor may be 0."""
    forward = _matrix([[factors[r] if r == k else 0.0 for k in range(3)] for r in range(3)])
    back = _matrix([[1.0 / factors[r] if r == k else 0.0 for k in range(3)] for r in range(3)])
    return Transform(matrix=forward, inverse=back, centre_mm=centre_mm)


def coordinate_frame(
    zero_mm: Point, transforms: tuple[Transform, ...], *, shift_mm: Point = ORIGIN, extra: Extra = NO_EXTRA
) -> CoordinateFrame:
    """The frame of a zero and of maps within it.

    Args:
        zero_mm: zero of the work offset in machine coordinates.
        transforms: maps of program coordinates in the order in which they act on a point.
        shift_mm: added to program coordinates before the maps.
        extra: zero of the further axes.
    """
    if not transforms:
        x, y, z = zero_mm
        a, b, c = shift_mm
        return CoordinateFrame(zero_mm=(x + a, y + b, z + c), extra=extra)
    matrix, inverse, offset = _IDENTITY, _IDENTITY, shift_mm
    for transform in transforms:
        matrix, inverse = _product(transform.matrix, matrix), _product(inverse, transform.inverse)
        offset = transform.of(offset)
    x, y, z = (zero + o for zero, o in zip(zero_mm, offset, strict=True))
    return CoordinateFrame(zero_mm=(x, y, z), matrix=matrix, inverse=inverse, extra=extra)
