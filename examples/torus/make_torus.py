"""Makes torus.stl: half a torus on a square plate, with a fillet of 4 mm around it and one of 3 mm inside.

    python examples/torus/make_torus.py [torus.stl]

The part is a body of revolution about the z axis on a square plate; z = 0 is the plate's top. `PROFILE` has the sizes,
`meridian` the curve that is revolved: inner plate, inner fillet, tube, outer fillet.
"""

from __future__ import annotations

import math
import sys
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

_RECORD = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("attribute", "<u2")])


@dataclass(frozen=True, slots=True, kw_only=True)
class Profile:
    """Sizes of the part, mm.

    Attributes:
        ring_mm: distance of the tube's centre from the axis.
        tube_mm: radius of the tube; its centre lies in the plate's top face, so half of it is above the plate.
        outer_mm, inner_mm: radii of the fillets between tube and plate.
        half_mm: half the side of the plate.
        thick_mm: thickness of the plate.
    """

    ring_mm: float = 18.0
    tube_mm: float = 6.0
    outer_mm: float = 4.0
    inner_mm: float = 3.0
    half_mm: float = 30.0
    thick_mm: float = 10.0

    def fillet(self, radius_mm: float, side: int) -> tuple[float, float]:
        """Centre of a ball that touches plate and tube: distance from the axis, and angle above the plate of the line
        from the tube's centre to it, rad.

        Args:
            side: +1 outside of the tube, -1 inside.
        """
        reach = self.tube_mm + radius_mm
        return self.ring_mm + side * math.sqrt(reach**2 - radius_mm**2), math.asin(radius_mm / reach)


PROFILE = Profile()


def meridian(steps: int, profile: Profile = PROFILE) -> NDArray[np.float64]:
    """The curve that is revolved about the axis, from the inner fillet's foot to the outer one's.

    Args:
        steps: total number of segments, of about equal angle.

    Returns:
        shape (steps + 1, 2): distance from the axis, and height.
    """
    (inner, low), (outer, high) = profile.fillet(profile.inner_mm, -1), profile.fillet(profile.outer_mm, 1)
    arcs = (
        (inner, profile.inner_mm, profile.inner_mm, -0.5 * math.pi, -low),
        (profile.ring_mm, 0.0, profile.tube_mm, math.pi - low, high),
        (outer, profile.outer_mm, profile.outer_mm, math.pi + high, 1.5 * math.pi),
    )
    total = sum(abs(end - begin) for *_, begin, end in arcs)
    bounds = np.rint(np.cumsum([0.0] + [abs(e - b) for *_, b, e in arcs]) / total * steps).astype(int)
    points = []
    for (u, v, radius, begin, end), count in zip(arcs, np.diff(bounds), strict=True):
        angles = np.linspace(begin, end, count + 1)[:-1]
        points.append(np.column_stack((u + radius * np.cos(angles), v + radius * np.sin(angles))))
    points.append(np.array([[outer, 0.0]]))
    curve = np.concatenate(points)
    curve[0, 1] = 0.0
    return curve


def torus(around: int = 512, along: int = 160, profile: Profile = PROFILE) -> NDArray[np.float64]:
    """The part's triangles; 2 around (along + 1) + 14 of them, 164,878 with the defaults.

    Args:
        around: segments about the axis, a multiple of 4.
        along: segments of the meridian.

    Returns:
        shape (m, 3, 3), counter-clockwise seen from outside, closed.
    """
    curve = meridian(along, profile)
    angles = 2.0 * math.pi * np.arange(around) / around
    turned = np.stack((np.cos(angles), np.sin(angles)), axis=1)
    turned[np.abs(turned) < 1e-12] = 0.0
    grid = np.empty((along + 1, around, 3))
    grid[:, :, :2] = curve[:, None, :1] * turned
    grid[:, :, 2] = curve[:, None, 1]
    after = np.roll(grid, -1, axis=1)
    a, b, c, d = grid[:-1], after[:-1], after[1:], grid[1:]
    ring = np.concatenate((_triangles(a, d, c), _triangles(a, c, b)))
    disc = _triangles(np.zeros_like(grid[0]), grid[0], after[0])
    return np.concatenate((ring, disc, _plate_top(grid[-1], profile), _plate_rest(profile)))


def _plate_top(circle: NDArray[np.float64], profile: Profile) -> NDArray[np.float64]:
    """The plate's top from the outer fillet's foot to its sides."""
    around, half = len(circle), profile.half_mm
    corners = np.array([(half, half, 0.0), (-half, half, 0.0), (-half, -half, 0.0), (half, -half, 0.0)])
    after = np.roll(circle, -1, axis=0)
    fans = _triangles(circle, np.repeat(corners, around // 4, axis=0), after)
    between = _triangles(np.roll(corners, 1, axis=0), corners, circle[:: around // 4])
    return np.concatenate((fans, between))


def _plate_rest(profile: Profile) -> NDArray[np.float64]:
    """The plate's sides and bottom."""
    half, deep = profile.half_mm, -profile.thick_mm
    top = np.array([(half, half, 0.0), (-half, half, 0.0), (-half, -half, 0.0), (half, -half, 0.0)])
    bottom = top + np.array([0.0, 0.0, deep])
    next_top, next_bottom = np.roll(top, -1, axis=0), np.roll(bottom, -1, axis=0)
    sides = np.concatenate((_triangles(top, bottom, next_bottom), _triangles(top, next_bottom, next_top)))
    floor = np.array([[bottom[0], bottom[2], bottom[1]], [bottom[0], bottom[3], bottom[2]]])
    return np.concatenate((sides, floor))


def _triangles(a: NDArray[np.float64], b: NDArray[np.float64], c: NDArray[np.float64]) -> NDArray[np.float64]:
    return np.stack((a.reshape(-1, 3), b.reshape(-1, 3), c.reshape(-1, 3)), axis=1)


def write_stl(path: Path | str, triangles: NDArray[np.float64]) -> None:
    """Write triangles (m, 3, 3) as binary STL."""
    records = np.zeros(len(triangles), dtype=_RECORD)
    records["corners"] = triangles
    cross = np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0])
    records["normal"] = cross / np.maximum(np.linalg.norm(cross, axis=1, keepdims=True), 1e-300)
    header = b"torus on a plate, mm".ljust(80, b" ") + np.uint32(len(triangles)).tobytes()
    Path(path).write_bytes(header + records.tobytes())


if __name__ == "__main__":
    target = Path(sys.argv[1]) if len(sys.argv) > 1 else Path(__file__).parent / "torus.stl"
    part = torus()
    write_stl(target, part)
    print(f"{target.name}: {len(part)} triangles")
