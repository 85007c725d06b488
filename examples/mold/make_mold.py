"""Makes the mold of this example: a freeform cavity with bosses, ribs and small details, as a closed STL file.

    python examples/mold/make_mold.py mold.stl --triangles 195000

The block is 100 x 80 x 35 mm, its highest point at z = 0. Walls have a draft of 5 degrees, fillets of 1.5 to 4 mm
at their foot and rounded upper edges. The surface is a height field over the plan, without undercuts. A grid of points
is laid over it and relaxed, so that triangles have about the same size on walls as on floors.
"""

from __future__ import annotations

import argparse
import math
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

SIZE_MM = (100.0, 80.0, 35.0)
DRAFT_DEG = 5.0
#: Rounds of relaxation of the coarsest grid, and of each finer one.
FIRST_ROUNDS, FINER_ROUNDS = 200, 25
#: Cells across the coarsest grid.
COARSEST = 60


def wall(out: Array, height: Array | float, foot_mm: float, head_mm: float, draft_deg: float = DRAFT_DEG) -> Array:
    """Height of a drafted wall above its foot.

    Args:
        out: distance outside the line where wall and floor would meet without a fillet.
        height: of the wall.
        foot_mm: radius of the fillet at its foot.
        head_mm: radius at its head.
    """
    angle = math.radians(90.0 - draft_deg)
    raised = _rounded(out, angle, foot_mm)
    lowered = height - _rounded(-out - height / math.tan(angle), angle, head_mm)
    return np.where(out > -0.5 * height / math.tan(angle), raised, lowered)


def _rounded(out: Array, angle: float, radius: float) -> Array:
    """A floor and a slope that begins at 0 and rises to the left, with an arc of a radius between them."""
    tangent = radius * math.tan(0.5 * angle)
    arc = radius - np.sqrt(np.maximum(0.0, radius**2 - (tangent - out) ** 2))
    return np.where(out >= tangent, 0.0, np.where(out <= -tangent * math.cos(angle), -out * math.tan(angle), arc))


def rectangle(x: Array, y: Array, width: float, height: float, corner: float) -> Array:
    """Signed distance outside a rectangle about the origin with round corners."""
    qx, qy = np.abs(x) - 0.5 * width + corner, np.abs(y) - 0.5 * height + corner
    return np.hypot(np.maximum(qx, 0.0), np.maximum(qy, 0.0)) + np.minimum(np.maximum(qx, qy), 0.0) - corner


def capsule(x: Array, y: Array, a: tuple[float, float], b: tuple[float, float], radius: float) -> Array:
    """Signed distance outside a straight rib from a to b with round ends."""
    dx, dy = b[0] - a[0], b[1] - a[1]
    t = np.clip(((x - a[0]) * dx + (y - a[1]) * dy) / (dx * dx + dy * dy), 0.0, 1.0)
    return np.hypot(x - a[0] - t * dx, y - a[1] - t * dy) - radius


def circle(x: Array, y: Array, centre: tuple[float, float], radius: float) -> Array:
    """Signed distance outside a circle."""
    return np.hypot(x - centre[0], y - centre[1]) - radius


def mold_height(x: Array, y: Array) -> Array:
    """Height of the mold's surface over the plan; the plan's origin is the middle."""
    land = -0.8 * (1.0 - np.cos(0.06 * x)) * (0.5 + 0.5 * np.cos(0.05 * y))
    floor = -21.0 + 1.6 * np.sin(x / 9.0) * np.cos(y / 11.0) + 2.2 * np.cos(np.hypot(x + 8.0, y - 4.0) / 17.0)
    z = floor + wall(-rectangle(x, y, 84.0, 64.0, 15.0), land - floor, 4.0, 1.0)
    z += wall(circle(x, y, (-22.0, 10.0), 8.0), 13.0 + 0.04 * (x + 22.0) ** 2 - 0.02 * (y - 10.0) ** 2, 3.0, 1.5)
    z += wall(capsule(x, y, (2.0, -16.0), (24.0, -10.0), 4.0), 8.0 + 0.5 * np.sin(x / 3.0), 2.0, 1.2)
    z += wall(np.abs(circle(x, y, (18.0, 12.0), 9.0)) - 1.6, 3.5, 1.5, 0.8)
    for angle in np.deg2rad([90.0, 210.0, 330.0]):
        z += wall(circle(x, y, (18.0 + 4.5 * np.cos(angle), 12.0 + 4.5 * np.sin(angle)), 1.2), 2.5, 0.5, 0.4)
    dome = np.hypot(x + 14.0, y + 16.0)
    z += np.maximum(0.0, np.sqrt(np.maximum(0.0, 12.0**2 - dome**2)) - 7.0)
    for column in range(4):
        pit = np.hypot(x - 33.0, y - 4.0 + 5.0 * column)
        z -= np.maximum(0.0, np.sqrt(np.maximum(0.0, 2.0**2 - pit**2)) - 0.8)
    runner = np.where((np.abs(y - 6.0) < 3.0) & (x < 0.0), 0.4 - np.sqrt(np.maximum(0.0, 9.0 - (y - 6.0) ** 2)), 1.0)
    return np.minimum(z, np.minimum(runner + land, 0.0))


def mold_triangles(count: int) -> Array:
    """Triangles of the mold, shape (m, 3, 3), m near ``count``, counter-clockwise seen from outside.

    The plan's low corner is the origin, the top lies at z = 0.
    """
    width, depth, height = SIZE_MM
    across = max(8, round(math.sqrt(0.5 * count * width / depth)))
    along = max(6, round(across * depth / width))
    x, y = relaxed_net(across, along)
    net = np.stack((x, y, mold_height(x - 0.5 * width, y - 0.5 * depth)), axis=-1)
    net = net.astype(np.float32).astype(np.float64)
    rim = np.concatenate((net[:-1, 0], net[-1, :-1], net[:0:-1, -1], net[0, :0:-1]))
    low = rim * (1.0, 1.0, 0.0) - (0.0, 0.0, height)
    middle = np.broadcast_to(np.array([0.5 * width, 0.5 * depth, -height]), rim.shape)
    after, low_after = np.roll(rim, -1, axis=0), np.roll(low, -1, axis=0)
    sides = [np.stack(t, axis=1) for t in ((low, low_after, after), (low, after, rim), (low_after, low, middle))]
    return np.concatenate((_top(net), *sides))


def _top(net: Array) -> Array:
    """Two triangles for each cell of the grid, split along the diagonal that is closer to the surface."""
    a, b, c, d = net[:-1, :-1], net[1:, :-1], net[1:, 1:], net[:-1, 1:]
    short = np.linalg.norm(c - a, axis=-1) <= np.linalg.norm(d - b, axis=-1)
    pick = short[..., None, None]
    one = np.where(pick, np.stack((a, b, c), axis=-2), np.stack((a, b, d), axis=-2))
    two = np.where(pick, np.stack((a, c, d), axis=-2), np.stack((b, c, d), axis=-2))
    return np.concatenate((one.reshape(-1, 3, 3), two.reshape(-1, 3, 3)))


def relaxed_net(across: int, along: int) -> tuple[Array, Array]:
    """Plan positions of the grid points, shape (across + 1, along + 1) each, relaxed on successively finer grids."""
    width, depth, _ = SIZE_MM
    halvings = max(0, math.ceil(math.log2(across / COARSEST)))
    x, y = np.meshgrid(np.array([0.0, width]), np.array([0.0, depth]), indexing="ij")
    for level in range(halvings, -1, -1):
        shape = (max(8, across >> level) + 1, max(6, along >> level) + 1) if level else (across + 1, along + 1)
        x, y = resampled(x, shape), resampled(y, shape)
        relax(x, y, FIRST_ROUNDS if level == halvings else FINER_ROUNDS)
    return x, y


def resampled(net: Array, shape: tuple[int, int]) -> Array:
    """A grid with another number of points, interpolated through the old ones."""
    for axis, points in enumerate(shape):
        place = np.linspace(0.0, net.shape[axis] - 1.0, points)
        low = np.minimum(place.astype(np.int64), net.shape[axis] - 2)
        part = (place - low).reshape(-1, 1) if axis == 0 else place - low
        net = np.take(net, low, axis) * (1.0 - part) + np.take(net, low + 1, axis) * part
    return net


def relax(x: Array, y: Array, rounds: int) -> None:
    """Move grid points to the mean of their neighbours, weighted by distance, so that walls get enough points."""
    width, depth, _ = SIZE_MM
    for _ in range(rounds):
        z = mold_height(x - 0.5 * width, y - 0.5 * depth)
        right = np.sqrt(np.diff(x, axis=0) ** 2 + np.diff(y, axis=0) ** 2 + np.diff(z, axis=0) ** 2)
        up = np.sqrt(np.diff(x, axis=1) ** 2 + np.diff(y, axis=1) ** 2 + np.diff(z, axis=1) ** 2)
        pulls = (right[:-1, 1:-1], right[1:, 1:-1], up[1:-1, :-1], up[1:-1, 1:])
        total = pulls[0] + pulls[1] + pulls[2] + pulls[3]
        for net in (x, y):
            near = (net[:-2, 1:-1], net[2:, 1:-1], net[1:-1, :-2], net[1:-1, 2:])
            goal = sum(p * n for p, n in zip(pulls, near, strict=True)) / total
            net[1:-1, 1:-1] += 0.5 * (goal - net[1:-1, 1:-1])
        x[1:-1, 0], x[1:-1, -1] = x[1:-1, 1], x[1:-1, -2]
        y[0, 1:-1], y[-1, 1:-1] = y[1, 1:-1], y[-2, 1:-1]


def write_stl(path: Path, triangles: Array) -> None:
    """Write a binary STL file; normals are 0, as readers compute them from the corners."""
    records = np.zeros(len(triangles), dtype=[("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("spare", "<u2")])
    records["corners"] = triangles
    path.write_bytes(b"mold".ljust(80) + len(triangles).to_bytes(4, "little") + records.tobytes())


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("path", type=Path, help="STL file to write")
    parser.add_argument("--triangles", type=int, default=195_000, help="about how many")
    options = parser.parse_args()
    triangles = mold_triangles(options.triangles)
    write_stl(options.path, triangles)
    print(f"{options.path}: {len(triangles)} triangles")


if __name__ == "__main__":
    main()
