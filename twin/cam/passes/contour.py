"""Contour paths: at every level the outlines of the inflated part's section, and further ones outside of them.

The tri-slice paper, section 3.1: xy slices of the inflated part are tool paths; expanded by the radial depth of cut
they are the layers before them. The part is inflated by the whole tool, shank and all: the body above a level counts.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from twin.arrays import FloatArray
from twin.cam.path.linking import Pass
from twin.geometry.polygons.outline import (
    Area,
    grown,
    holds,
    line_distance_mm,
    minus,
    nearest_area,
    outlines,
    pieces,
)
from twin.geometry.polygons.region import Region
from twin.geometry.polygons.shapes import to_shape

#: A cleared area needs no more layers than this; more are a mistake in the radial depth.
MOST_LAYERS = 10_000
#: Lines no farther apart than this many radial depths are neighbours.
_NEXT = 1.5
#: Part of the axial depth by which levels may be farther apart for rounding.
_SLACK = 1e-9


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Level:
    """Where the tool may be at one height.

    Attributes:
        z_mm: height of the tip.
        area: where the tip may not be.
    """

    z_mm: float
    area: Area


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class ContourOptions:
    """How levels become passes.

    Attributes:
        window: where the tip may be.
        stock: the stock's outline grown by what the tool reaches: outside of it nothing is cut.
        top_mm: material's highest point.
        layers: outlines a level, the part's own included; None for as many as clear the window.
        radial_depth_mm: distance of the layers.
        climb: part on the right of the feed, else on the left.
        chord_mm: how far chords may lie off the arcs of expanded outlines, outwards.
    """

    window: Area
    stock: Area
    top_mm: float
    layers: int | None = 1
    radial_depth_mm: float
    climb: bool = True
    chord_mm: float = 0.001


def level_heights(low_mm: float, high_mm: float, depth_mm: float) -> FloatArray:
    """Heights from the top down, evenly spread, the lowest included, the highest not, no farther apart than a depth."""
    count = max(1, math.ceil((high_mm - low_mm) / depth_mm - _SLACK))
    return np.linspace(high_mm, low_mm, count + 1)[1:]


def levels_of(heights_mm: FloatArray, sections: Sequence[Region]) -> tuple[Level, ...]:
    """Levels from the sections, one a height, of a part inflated by the tool, which reaches up without end."""
    return tuple(Level(z_mm=z, area=to_shape(r)) for z, r in zip(heights_mm.tolist(), sections, strict=True))


def contour_passes(levels: Sequence[Level], options: ContourOptions) -> tuple[Pass, ...]:
    """Level by level from the top; in each connected area from the outermost layer to the part's own outline.

    Where nothing but one layer is cut at each level, all passes have one layer number, so that they may be linked along
    the part; else each level has its own.
    """
    passes: list[Pass] = []
    cleared_mm = options.top_mm
    for number, level in enumerate(levels):
        made = list(_level_passes(level, options, cleared_mm, 0 if options.layers == 1 else number))
        passes += made
        if options.layers is None:
            cleared_mm = min(cleared_mm, level.z_mm)
    return tuple(passes)


def _level_passes(level: Level, options: ContourOptions, top_mm: float, layer: int) -> Iterator[Pass]:
    free = pieces(minus(options.window, level.area))
    lines: list[list[tuple[int, FloatArray]]] = [[] for _ in free]
    if not free:
        return
    for k in range(MOST_LAYERS if options.layers is None else options.layers):
        area = grown(level.area, k * options.radial_depth_mm, options.chord_mm)
        found = outlines(area, options.window)
        if not found:
            break
        for line in found:
            feed = line[::-1] if options.climb else line
            lines[nearest_area(free, line[len(line) // 2])].append((k, feed))
    at: FloatArray | None = None
    for own in lines:
        for one in _in_order(own, options.radial_depth_mm, at):
            at = one[-1]
            entered = None if _outside(one[0], options.stock) else top_mm
            points = np.column_stack((one, np.full(len(one), level.z_mm)))
            yield Pass(points_mm=points, top_mm=entered, layer=layer)


def _in_order(
    lines: list[tuple[int, FloatArray]], radial_depth_mm: float, at: FloatArray | None
) -> Iterator[FloatArray]:
    """Every line after its neighbours of the next outer layer; among those that may come, the nearest.

    Args:
        lines: with the numbers of their layers.
        at: where the last line ended.
    """
    waits = _waiting(lines, _NEXT * radial_depth_mm)
    left = set(range(len(lines)))
    while left:
        ready = sorted(i for i in left if not waits[i] & left)
        distances = [
            0.0 if at is None else float(np.linalg.norm(_starts(lines[i][1]) - at, axis=1).min()) for i in ready
        ]
        nearest = ready[int(np.argmin(distances))]
        left.remove(nearest)
        line = _from_nearest(lines[nearest][1], at)
        yield line
        at = line[-1]


def _starts(line: FloatArray) -> FloatArray:
    """Where a line may begin: anywhere on a closed one, else at its first point."""
    return line if np.all(line[0] == line[-1]) else line[:1]


def _waiting(lines: list[tuple[int, FloatArray]], apart_mm: float) -> list[set[int]]:
    """For each line its neighbours of the next outer layer."""
    layers: dict[int, list[int]] = {}
    for i, (k, _) in enumerate(lines):
        layers.setdefault(k, []).append(i)
    return [{j for j in layers.get(k + 1, []) if line_distance_mm(line, lines[j][1]) <= apart_mm} for k, line in lines]


def _from_nearest(line: FloatArray, at: FloatArray | None) -> FloatArray:
    """A closed line begun at its point nearest to a position; an open one as is."""
    if at is None or np.any(line[0] != line[-1]):
        return line
    k = int(np.argmin(np.linalg.norm(line - at, axis=1)))
    return np.concatenate((line[k:-1], line[: k + 1]))


def _outside(point: FloatArray, stock: Area) -> bool:
    return not holds(stock, np.array([point, point]))


class OutlineLinkPlanner:
    """Links next to the outlines, see `twin.cam.path.linking.LinkPlanner`.

    Args:
        levels: from the highest to the lowest.
        window: where the tip may be.
        top_mm: height above which there is only air.
    """

    def __init__(self, levels: Sequence[Level], window: Area, top_mm: float) -> None:
        self._levels = {level.z_mm: level for level in levels}
        self._window = window
        self._top_mm = top_mm
        self._free: dict[float, Area] = {}

    def between(self, start_mm: FloatArray, end_mm: FloatArray) -> FloatArray | None:
        """Straight at the height of the start, then straight down."""
        if end_mm[2] > start_mm[2]:
            return None
        over = np.array([end_mm[0], end_mm[1], start_mm[2]])
        if not self.free(np.array([start_mm, over])):
            return None
        return np.array([start_mm, over] if over[2] == end_mm[2] else [start_mm, over, end_mm])

    def free(self, points_mm: FloatArray) -> bool:
        """Whether a level line lies in the free area of its level; False for heights that are not a level."""
        z = float(points_mm[0, 2])
        level = self._levels.get(z)
        if level is None or np.any(points_mm[:, 2] != z):
            return False
        if z not in self._free:
            self._free[z] = minus(self._window, level.area)
        return holds(self._free[z], points_mm[:, :2])

    def clear_z_mm(self, start_mm: FloatArray, end_mm: FloatArray) -> float:  # noqa: ARG002
        """The material's top."""
        return self._top_mm
