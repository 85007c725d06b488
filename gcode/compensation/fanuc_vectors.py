"""FANUC's offset vectors: the points that the tool's centre passes between two blocks.

``n`` is the normal to the left of a block's direction ``d`` at the corner, ``r`` the signed offset. A corner is an
inner one where the path turns towards the tool (the manual's angle on the workpiece side is 180 degrees or more), an
obtuse outer one where it turns away by up to 90 degrees, and an acute outer one beyond that.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Literal, TypeAlias

from gcode.compensation.planar import Segment, circle_circle, cross, dot, line_circle, unit
from gcode.errors import GcodeError

Joint: TypeAlias = Literal["linear", "arc"]
StartupType: TypeAlias = Literal["A", "B"]
Bend: TypeAlias = Literal["inner", "obtuse", "acute"]
Points: TypeAlias = tuple[complex, ...]

#: Sines and cosines nearer to 0 than this are 0.
_FLAT = 1e-9
#: Below this sine an inner corner is a smooth passage, whose two normals agree.
_SMOOTH = 1e-6


@dataclass(frozen=True, slots=True, kw_only=True)
class Corner:
    """Two blocks and the offset between them.

    Attributes:
        before: the block that ends at the corner.
        after: the block that starts there.
        offset: signed offset, mm; positive to the left.
    """

    before: Segment
    after: Segment
    offset: float

    @property
    def bend(self) -> Bend:
        """Kind of the corner. A path that reverses goes around its end, as an acute one."""
        d1, d2 = self.before.direction_out, self.after.direction_in
        towards, onward = cross(d1, d2) * self.offset, dot(d1, d2)
        if onward < 0.0 and abs(towards) <= _FLAT * abs(self.offset):
            return "acute"
        if towards > 0.0:
            return "inner"
        return "obtuse" if onward >= -_FLAT else "acute"

    @property
    def ending(self) -> complex:
        """The offset point of the corner at right angles to the block before."""
        return self.before.end + 1j * self.offset * self.before.direction_out

    def starting(self, offset: float) -> Points:
        """The offset point of the corner at right angles to the block after, for another offset."""
        return (self.before.end + 1j * offset * self.after.direction_in,)

    @property
    def mitre(self) -> complex:
        """Where the two paths, both prolonged by their tangents, meet at the offset."""
        d1, d2 = self.before.direction_out, self.after.direction_in
        return self.before.end + 1j * self.offset * (d1 + d2) / (1.0 + dot(d1, d2))


def upright(segment: Segment, offset: float) -> Points:
    """The vector at right angles to the end of a block."""
    return (segment.end + 1j * offset * segment.direction_out,)


def startup_vectors(corner: Corner, kind: StartupType, joint: Joint) -> Points:
    """Start-up (the first motion of G41 or G42).

    Type A ends at right angles to the start of the next block at every corner; type B does so at inner corners only
    and takes the vectors of the offset mode at outer ones.
    """
    if kind == "A" or corner.bend == "inner":
        return corner.starting(corner.offset)
    return corner_vectors(corner, joint)


def cancel_vectors(corner: Corner, kind: StartupType, joint: Joint) -> Points:
    """Cancel (the motion of G40), which mirrors the start-up: at right angles to the end of the block before."""
    if kind == "A" or corner.bend == "inner":
        return upright(corner.before, corner.offset)
    return corner_vectors(corner, joint)


def corner_vectors(corner: Corner, joint: Joint) -> Points:
    """Corners in the offset mode, which are the same with both types."""
    if joint == "arc" and corner.bend != "inner":
        return (corner.ending, *corner.starting(corner.offset))
    return _VECTORS[corner.bend](corner)


def _inner(corner: Corner) -> Points:
    """The point where the two shifted paths meet."""
    before, after = corner.before, corner.after
    if before.centre is None and after.centre is None:
        return (corner.mitre,)
    if abs(cross(before.direction_out, after.direction_in)) <= _SMOOTH:
        return corner.starting(corner.offset)
    points = _meeting(corner)
    if not points:
        offset = f"{abs(corner.offset):.4f} mm"
        problem = f"the offset paths of this block and the next, {offset} from the programmed ones, do not meet"
        expected = "a corner that a tool of this radius reaches"
        raise GcodeError(before.motion.place, "compensation-no-intersection", problem, expected)
    return (min(points, key=lambda point: abs(point - before.end)),)


def _meeting(corner: Corner) -> Points:
    before, after, offset = corner.before, corner.after, corner.offset
    if before.centre is None and after.centre is not None:
        radius = _shifted(after, after.start, after.centre, offset)
        return line_circle(corner.ending, before.direction_out, after.centre, radius)
    if after.centre is None and before.centre is not None:
        radius = _shifted(before, before.end, before.centre, offset)
        return line_circle(corner.starting(offset)[0], after.direction_in, before.centre, radius)
    if before.centre is None or after.centre is None:
        return (corner.mitre,)
    radii = (_shifted(before, before.end, before.centre, offset), _shifted(after, after.start, after.centre, offset))
    return circle_circle(before.centre, radii[0], after.centre, radii[1])


def _shifted(segment: Segment, point: complex, centre: complex, offset: float) -> float:
    """Radius of an arc's shifted path at `point`."""
    return abs(point + offset * unit(centre - point) * (1.0 if segment.turns > 0 else -1.0) - centre)


def _obtuse(corner: Corner) -> Points:
    """The meeting point of the tangents; an arc is left, and joined, by a straight line along its tangent."""
    return _with_arcs(corner, (corner.mitre,))


def _acute(corner: Corner) -> Points:
    """Each side is prolonged by the offset's amount, and the two points are joined by a straight line."""
    size = abs(corner.offset)
    beyond = corner.ending + size * corner.before.direction_out
    ahead = corner.starting(corner.offset)[0] - size * corner.after.direction_in
    return _with_arcs(corner, (beyond, ahead))


def _with_arcs(corner: Corner, points: Points) -> Points:
    first = () if corner.before.centre is None else (corner.ending,)
    last = () if corner.after.centre is None else corner.starting(corner.offset)
    return (*first, *points, *last)


_VECTORS: Mapping[Bend, Callable[[Corner], Points]] = {"inner": _inner, "obtuse": _obtuse, "acute": _acute}
