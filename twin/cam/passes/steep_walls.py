"""Level lines on steep surfaces, where rows in the plan would lie too far apart on the wall.

Where the tip may go down to a height z is bounded by a line on which the exact height of the drop-cutter is z. Lines
are traced on a grid, and each of their points is then moved onto the exact boundary by halving. Steepness is that of
the surface that the tip moves on, whose normals are those of the contacts.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from itertools import pairwise

import contourpy
import numpy as np
from numpy.typing import NDArray
from scipy import ndimage

from twin.arrays import FloatArray
from twin.cam.surface.drop_cutter import DropCutter

#: Halvings of a grid cell: 0.25 mm to 0.1 um.
_HALVINGS = 12
#: Rounds of further points between those of the grid.
_ROUNDS = 4
#: Cells by which steep areas are widened: for level lines, and less where rows are omitted, so that both overlap.
_WIDER, _LESS = 2, 1
#: Areas of fewer cells than this are noise, not a face.
_LEAST_CELLS = 4
#: Highest and lowest line of a face lie this part of the step within it.
_INSET = 0.1
#: A line goes on the one above it where they begin no further apart than this, in cells.
_SAME_WALL = 4.0


@dataclass(frozen=True, slots=True, eq=False)
class SteepMap:
    """Heights of the tip on a grid, and where they change steeply.

    Attributes:
        x_mm, y_mm: of the grid, even, shape (nx,) and (ny,).
        z_mm: tip heights, shape (nx, ny).
        steep: shape (nx, ny).
        wider, inner: steep areas with a margin, and without their rim.
    """

    x_mm: FloatArray
    y_mm: FloatArray
    z_mm: FloatArray
    steep: NDArray[np.bool_]
    wider: NDArray[np.bool_]
    inner: NDArray[np.bool_]

    @classmethod
    def of(
        cls, cutter: DropCutter, low_mm: FloatArray, high_mm: FloatArray, pitch_mm: float, angle_deg: float
    ) -> SteepMap:
        """Of a rectangle of the plan.

        Args:
            angle_deg: angle against the level above which a surface is steep.
        """
        x, y = (
            np.linspace(low_mm[i], high_mm[i], max(2, math.ceil((high_mm[i] - low_mm[i]) / pitch_mm) + 1))
            for i in (0, 1)
        )
        gx, gy = np.meshgrid(x, y, indexing="ij")
        z = cutter.drop(np.column_stack((gx.ravel(), gy.ravel()))).reshape(gx.shape)
        along = np.abs(np.diff(z, axis=0)) / (x[1] - x[0])
        across = np.abs(np.diff(z, axis=1)) / (y[1] - y[0])
        rise = np.hypot(
            np.maximum(_before(along, 0), _after(along, 0)), np.maximum(_before(across, 1), _after(across, 1))
        )
        steep = rise > math.tan(math.radians(angle_deg))
        wider = np.asarray(ndimage.binary_dilation(steep, iterations=_WIDER))
        return cls(x, y, z, steep, wider, np.asarray(ndimage.binary_erosion(steep, iterations=_LESS)))

    def at(self, mask: NDArray[np.bool_], points_mm: FloatArray) -> NDArray[np.bool_]:
        """Values of a mask of the grid at points of the plan, shape (n, 2)."""
        i = np.clip(np.rint((points_mm[:, 0] - self.x_mm[0]) / (self.x_mm[1] - self.x_mm[0])), 0, len(self.x_mm) - 1)
        j = np.clip(np.rint((points_mm[:, 1] - self.y_mm[0]) / (self.y_mm[1] - self.y_mm[0])), 0, len(self.y_mm) - 1)
        return np.asarray(mask[i.astype(np.int64), j.astype(np.int64)])


def _before(slope: FloatArray, axis: int) -> FloatArray:
    return np.concatenate((slope.take([0], axis), slope), axis=axis)


def _after(slope: FloatArray, axis: int) -> FloatArray:
    return np.concatenate((slope, slope.take([-1], axis)), axis=axis)


def level_lines(cutter: DropCutter, chart: SteepMap, step_mm: float, tolerance_mm: float) -> Iterator[list[FloatArray]]:
    """Lines of equal height on steep areas, those of a wall together from the top, the part on their right.

    Args:
        step_mm: distance of the heights.
        tolerance_mm: how far a chord may lie inside the part.

    Returns:
        for each wall its lines, shape (n, 3); closed lines end where they begin.
    """
    traced = [found for part in _faces(chart) for found in _traced(part, step_mm)]
    walls: list[list[FloatArray]] = []
    reach = _SAME_WALL * float(chart.x_mm[1] - chart.x_mm[0])
    for line in _exact([run for _, run in traced], np.array([z for z, _ in traced]), cutter, chart, tolerance_mm):
        _append(walls, line, reach)
    yield from walls


def _faces(chart: SteepMap) -> Iterator[SteepMap]:
    """Each connected steep area as a map of its own, no larger than necessary."""
    labels, _ = ndimage.label(chart.steep, structure=np.ones((3, 3), dtype=np.int8))
    margin = _WIDER + 2
    for number, found in enumerate(ndimage.find_objects(labels)):
        i, j = (
            slice(max(0, s.start - margin), min(size, s.stop + margin))
            for s, size in zip(found, labels.shape, strict=True)
        )
        own = labels[i, j] == number + 1
        if min(own.shape) < 2 or np.count_nonzero(own) < _LEAST_CELLS:
            continue
        wider = np.asarray(ndimage.binary_dilation(own, structure=np.ones((3, 3), dtype=np.bool_), iterations=_WIDER))
        yield SteepMap(chart.x_mm[i], chart.y_mm[j], np.ascontiguousarray(chart.z_mm[i, j]), own, wider, own)


def _traced(part: SteepMap, step_mm: float) -> Iterator[tuple[float, FloatArray]]:
    """Lines of a steep area on the grid, from just below its top to just above its foot, with their heights."""
    z = part.z_mm[part.wider]
    low, high = float(z.min()), float(z.max())
    count = max(1, math.ceil((high - low) / step_mm))
    inset = _INSET * (high - low) / count
    tracer = contourpy.contour_generator(part.x_mm, part.y_mm, part.z_mm.T)
    for level in np.linspace(high - inset, low + inset, count + 1).tolist():
        for line in tracer.lines(level):
            yield from ((level, run) for run in _steep_runs(np.asarray(line), part))


def _steep_runs(line: FloatArray, chart: SteepMap) -> Iterator[FloatArray]:
    """The parts of a line on steep areas."""
    if len(line) < 3:
        return
    keep = chart.at(chart.wider, line)
    if keep.all():
        yield line
        return
    if not keep.any():
        return
    if np.allclose(line[0], line[-1]):
        k = int(np.flatnonzero(~keep)[0])
        line, keep = np.concatenate((line[k:-1], line[: k + 1])), np.concatenate((keep[k:-1], keep[: k + 1]))
    edges = np.flatnonzero(np.diff(np.concatenate(([False], keep, [False])).astype(np.int8)))
    for a, b in zip(edges[::2].tolist(), edges[1::2].tolist(), strict=True):
        if b - a > 2:
            yield line[a:b]


def _exact(
    lines: list[FloatArray], heights: FloatArray, cutter: DropCutter, chart: SteepMap, tolerance: float
) -> Iterator[FloatArray]:
    """Lines moved onto the boundary, with the part on their right, and points between where chords lie off it.

    Args:
        heights: of the lines, shape (k,).
    """
    if not lines:
        return
    points = np.concatenate(lines)
    owner = np.repeat(np.arange(len(lines)), [len(ln) for ln in lines])
    points = _on_edges(points, heights[owner], cutter, chart)
    for _ in range(_ROUNDS):
        middle, normal, first = _middles(points, owner)
        level = heights[owner[first]]
        left = cutter.drop(middle + tolerance * normal) <= level
        right = cutter.drop(middle - tolerance * normal) <= level
        off = np.flatnonzero(left == right)
        if not len(off):
            break
        reach = 0.5 * _chord(points, first[off])
        found, sure = _across(middle[off], normal[off], left[off], level[off], cutter, reach)
        where = first[off][sure] + 1
        points, owner = np.insert(points, where, found[sure], axis=0), np.insert(owner, where, owner[where - 1])
    backwards = _part_on_left(points, owner, heights, cutter, max(10.0 * tolerance, 0.05))
    bounds = np.searchsorted(owner, np.arange(len(lines) + 1)).tolist()
    for number, (a, b) in enumerate(pairwise(bounds)):
        line = points[a:b]
        line = line[np.concatenate(([True], np.any(np.diff(line, axis=0) != 0.0, axis=1)))]
        if len(line) > 2:
            line = line[::-1] if backwards[number] else line
            yield np.column_stack((line, np.full(len(line), heights[number])))


def _on_edges(points: FloatArray, level: FloatArray, cutter: DropCutter, chart: SteepMap) -> FloatArray:
    """Points of traced lines, each on an edge of the grid, halved to where the tip's exact height is the level.

    The lower side is kept, so that no point lies in the part.
    """
    steps = np.array([chart.x_mm[1] - chart.x_mm[0], chart.y_mm[1] - chart.y_mm[0]])
    cells = (points - [chart.x_mm[0], chart.y_mm[0]]) / steps
    nearest = np.rint(cells)
    off = np.abs(cells - nearest)
    axis = np.argmax(off, axis=1)  # the axis along which the point lies between two grid points
    low, high = nearest.copy(), nearest.copy()
    rows = np.arange(len(points))
    low[rows, axis], high[rows, axis] = np.floor(cells[rows, axis]), np.floor(cells[rows, axis]) + 1
    origin = np.array([chart.x_mm[0], chart.y_mm[0]])
    a, b = origin + low * steps, origin + high * steps
    swap = cutter.drop(np.ascontiguousarray(a)) > level
    a[swap], b[swap] = b[swap], a[swap].copy()
    return _halved(a, b, level, cutter)


def _halved(safe: FloatArray, beyond: FloatArray, level: FloatArray, cutter: DropCutter) -> FloatArray:
    """The last safe position between a safe one and one in the part."""
    safe, beyond = safe.copy(), beyond.copy()
    for _ in range(_HALVINGS):
        middle = 0.5 * (safe + beyond)
        fine = cutter.drop(np.ascontiguousarray(middle)) <= level
        safe[fine], beyond[~fine] = middle[fine], middle[~fine]
    return safe


def _middles(points: FloatArray, owner: NDArray[np.int64]) -> tuple[FloatArray, FloatArray, NDArray[np.int64]]:
    """Middles of all chords, their unit normals to the left, and the chords' first points."""
    first = np.flatnonzero(owner[1:] == owner[:-1])
    chord = points[first + 1] - points[first]
    length = np.maximum(np.hypot(chord[:, 0], chord[:, 1]), 1e-12)[:, None]
    normal = np.column_stack((-chord[:, 1], chord[:, 0])) / length
    return 0.5 * (points[first] + points[first + 1]), normal, first


def _chord(points: FloatArray, first: NDArray[np.int64]) -> FloatArray:
    chord = points[first + 1] - points[first]
    length: FloatArray = np.hypot(chord[:, 0], chord[:, 1])
    return length


def _across(
    middle: FloatArray,
    normal: FloatArray,
    safe: NDArray[np.bool_],
    level: FloatArray,
    cutter: DropCutter,
    reach: FloatArray,
) -> tuple[FloatArray, NDArray[np.bool_]]:
    """The boundary's position on the normal of a chord whose middle is off it, and whether there is one."""
    best, sure = middle.copy(), np.zeros(len(middle), dtype=bool)
    for sign in (1.0, -1.0):
        other = middle + sign * reach[:, None] * normal
        beyond = cutter.drop(np.ascontiguousarray(other)) > level
        fits = (beyond == safe) & ~sure
        start, end = np.where(safe[:, None], middle, other), np.where(safe[:, None], other, middle)
        if fits.any():
            best[fits] = _halved(start[fits], end[fits], level[fits], cutter)
            sure |= fits
    return best, sure


def _part_on_left(
    points: FloatArray, owner: NDArray[np.int64], heights: FloatArray, cutter: DropCutter, side_mm: float
) -> NDArray[np.bool_]:
    """Which lines have the part on their left: they are to be reversed, for climb milling has it on the right."""
    middle, normal, first = _middles(points, owner)
    whose = owner[first]
    on_left = cutter.drop(np.ascontiguousarray(middle + side_mm * normal)) > heights[whose]
    return np.bincount(whose, weights=np.where(on_left, 1.0, -1.0), minlength=len(heights)) > 0.0


def _append(walls: list[list[FloatArray]], line: FloatArray, reach: float) -> None:
    """Put a line under the one on the same wall, begun near its end where it is closed; else it begins a wall."""
    closed = bool(np.all(np.abs(line[0] - line[-1]) < 1e-9))
    for wall in walls:
        last = wall[-1]
        gaps = np.linalg.norm(line[:, :2] - last[-1, :2], axis=1)
        if closed and float(gaps.min()) < reach:
            k = int(np.argmin(gaps))
            wall.append(np.concatenate((line[k:-1], line[: k + 1])))
            return
        if not closed and float(np.linalg.norm(line[0, :2] - last[0, :2])) < reach:
            wall.append(line)
            return
    walls.append([line])
