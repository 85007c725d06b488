"""Motions as lines and circles between points of the grid that words with a number of decimals can name."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import TypeAlias

from gcode.dialects import Dialect
from gcode.events import PLANE_AXES, ArcMotion, Point
from gcode.phases.arcs import arc_lengths
from gcode.report.path_geometry import points_mm
from gcode.write.numbers import Counts, Grid

#: A circle whose radius is less, in counts, is not a circle any more once its centre and ends are rounded.
LEAST_RADIUS = 4
#: Largest deviation of an arc by rounding, in counts: half a count per axis at both ends and at the centre.
MOST_DEVIATION = 4.0
#: Largest distance, in counts, of the centre that a control computes from R.
MOST_CENTRE_DEVIATION = 1.5


@dataclass(frozen=True, slots=True)
class Line:
    """A straight stroke to a point of the grid."""

    end: Counts


@dataclass(frozen=True, slots=True)
class Circle:
    """A circular or helical stroke.

    Attributes:
        end: its end.
        plane: 17, 18 or 19.
        turns: as those of `ArcMotion`.
        centre: counts from its start to its centre along the plane's first and second axis.
        radius: radius in counts, negative for more than half a turn, where it defines the same centre; else None.
        climb: length of the stroke over that of its arc in the plane: 1 for a circle, more for a helix.
    """

    end: Counts
    plane: int
    turns: int
    centre: tuple[int, int]
    radius: int | None
    climb: float


Stroke: TypeAlias = Line | Circle


def arc_strokes(arc: ArcMotion, start: Counts, grid: Grid, dialect: Dialect) -> Iterator[Stroke]:
    """An arc as strokes from a point of the grid.

    Several turns are one stroke where the control counts turns (P in G2), else one stroke each. An arc that is not
    a circle any more once rounded, or that the control refuses for its radii, becomes chords within one count of it.

    Args:
        arc: the arc; it starts at the point of the grid nearest to `start`.
        start: where the tool is.
    """
    counts_turns = "P" in dialect.codes["G2"].letters
    for part in [arc] if counts_turns else _single_turns(arc):
        circle = _circle(part, start, grid, dialect)
        strokes = [circle] if circle is not None else _chords(part, start, grid)
        yield from strokes
        start = strokes[-1].end


def _single_turns(arc: ArcMotion) -> Iterator[ArcMotion]:
    """An arc of many turns as arcs of one turn at most; where its radius changes, the last of them changes it."""
    k = PLANE_AXES[arc.plane][2]
    sense = 1 if arc.turns > 0 else -1
    whole, sweep, start = abs(arc.turns) - 1, arc.sweep_rad, arc.start_mm
    rise = (arc.end_mm[k] - arc.start_mm[k]) / abs(sweep) * math.tau
    for _ in range(whole):
        end = list(start)
        end[k] += rise
        there: Point = (end[0], end[1], end[2])
        yield replace(arc, start_mm=start, end_mm=there, turns=sense)
        start = there
    yield replace(arc, start_mm=start, turns=sense)


def _chords(arc: ArcMotion, start: Counts, grid: Grid) -> list[Line]:
    points = [grid.point((float(x), float(y), float(z))) for x, y, z in points_mm(arc, grid.step_mm)[1:]]
    kept = [after for before, after in zip([start, *points], points, strict=False) if after != before]
    return [Line(point) for point in kept or points[-1:]]


def _circle(arc: ArcMotion, start: Counts, grid: Grid, dialect: Dialect) -> Circle | None:
    """The rounded arc, None where it is not the same arc any more, or the control refuses it."""
    i, j, _ = PLANE_AXES[arc.plane]
    end, centre = grid.point(arc.end_mm), grid.point(arc.centre_mm)
    radii = [math.hypot(point[i] - centre[i], point[j] - centre[j]) for point in (start, end)]
    if min(radii) < LEAST_RADIUS:
        return None
    if not dialect.arc_tolerance.in_unit(grid.unit_mm).accepts(radii[0] * grid.step_mm, radii[1] * grid.step_mm):
        return None
    rounded = replace(arc, start_mm=_floats(start), end_mm=_floats(end), centre_mm=_floats(centre))
    if abs(rounded.sweep_rad - arc.sweep_rad) * max(radii) > MOST_DEVIATION:
        return None
    in_plane, path = arc_lengths(rounded)
    return Circle(
        end=end,
        plane=arc.plane,
        turns=arc.turns,
        centre=(centre[i] - start[i], centre[j] - start[j]),
        radius=_radius(rounded, sum(radii) / 2.0),
        climb=path / in_plane,
    )


def _radius(arc: ArcMotion, mean: float) -> int | None:
    """R of an arc of the grid, None where the control would compute another centre from it."""
    i, j, _ = PLANE_AXES[arc.plane]
    chord = (arc.end_mm[i] - arc.start_mm[i], arc.end_mm[j] - arc.start_mm[j])
    length, sweep, radius = math.hypot(*chord), arc.sweep_rad, round(mean)
    if abs(arc.turns) != 1 or length == 0.0 or radius * 2 < length:
        return None
    height = math.sqrt(radius * radius - length * length / 4.0)
    side = math.copysign(1.0, sweep) if abs(sweep) <= math.pi else -math.copysign(1.0, sweep)
    across = arc.start_mm[i] + chord[0] / 2.0 - side * height * chord[1] / length
    along = arc.start_mm[j] + chord[1] / 2.0 + side * height * chord[0] / length
    if math.hypot(across - arc.centre_mm[i], along - arc.centre_mm[j]) > MOST_CENTRE_DEVIATION:
        return None
    return radius if abs(sweep) <= math.pi else -radius


def _floats(counts: Counts) -> Point:
    return (float(counts[0]), float(counts[1]), float(counts[2]))
