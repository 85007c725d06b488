"""The feed motions of a program, run once: extents with those of arcs, levels, lengths and times by tool."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from gcode.events import PLANE_AXES, MotionState
from gcode.language.program import Program
from gcode.report.motion_arrays import MotionArrays, MotionKind, motion_arrays
from gcode.settings import ALL_OFFSETS, MachineSettings, ToolOffset
from twin.arrays import FloatArray

#: Position of the gauge point at the reference point and at the start of the program, above all work, mm.
HOME_MM = (0.0, 0.0, 100.0)
_LEVEL_MM = 1e-4
_FEEDING = (MotionKind.FEED, MotionKind.ARC, MotionKind.TAP)


class Feed(NamedTuple):
    """Feed motions in order, n of them; lengths in mm.

    Attributes:
        tool: (n,) number of the tool.
        line: (n,) line of the program.
        low_mm, high_mm: (n, 3) least and largest coordinates of the tool tip, of the path of arcs.
        start_mm, end_mm: (n, 3) ends.
        length_mm: (n,) length of the path.
        sideways_mm: (n,) its length seen from above.
        feed_mm_min: (n,) speed along the path.
        spindle_rpm: (n,) speed, 0 where the spindle is stopped.
        tapping: (n,) the feed follows the spindle.
        first: (n,) the motion before it was not a feed motion.
        arc: (n,) the motion is an arc.
    """

    tool: NDArray[np.int64]
    line: NDArray[np.int64]
    low_mm: FloatArray
    high_mm: FloatArray
    start_mm: FloatArray
    end_mm: FloatArray
    length_mm: FloatArray
    sideways_mm: FloatArray
    feed_mm_min: FloatArray
    spindle_rpm: FloatArray
    tapping: NDArray[np.bool_]
    first: NDArray[np.bool_]
    arc: NDArray[np.bool_]

    def only(self, chosen: NDArray[np.bool_]) -> Feed:
        """Some of the motions."""
        columns: tuple[Any, ...] = tuple(column[chosen] for column in self)
        return Feed(*columns)

    @property
    def time_s(self) -> FloatArray:
        """(n,) duration of each motion."""
        return self.length_mm / np.maximum(self.feed_mm_min, 1e-9) * 60.0

    @property
    def level(self) -> NDArray[np.bool_]:
        """(n,) the motion keeps its height."""
        return self.high_mm[:, 2] - self.low_mm[:, 2] < _LEVEL_MM

    @property
    def sideways(self) -> NDArray[np.bool_]:
        """(n,) the motion is not a plunge or a retract along Z."""
        return self.sideways_mm > _LEVEL_MM


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Cuts:
    """Motions of a program in numbers.

    Attributes:
        feed: its feed motions.
        rapid_mm: length of its other motions.
        dwell_s: time of its dwells.
        motions: number of motions.
        tools: tools that make feed motions, in order of use.
        offsets: work offsets of feed motions, in order of use.
        compensated: by tool, numbers of the radius offsets (D) with which cutter compensation is on.
        length_offsets: by tool, numbers of its tool length offsets (H).
    """

    feed: Feed
    rapid_mm: float
    dwell_s: float
    motions: int
    tools: tuple[int, ...]
    offsets: tuple[str, ...]
    compensated: Mapping[int, frozenset[int]]
    length_offsets: Mapping[int, frozenset[int]]


def cuts_of(
    program: Program, dialect: str, *, tool: int = 0, radii_mm: Mapping[int, float] | None = None, **more: Any
) -> Cuts:
    """Run a program.

    Args:
        dialect: name of the dialect.
        tool: number of the tool in the spindle at the start.
        radii_mm: radius offsets by number; None where they are not known, so that all are 0.
        more: further fields of `MachineSettings`.

    Raises:
        GcodeError: the program cannot be interpreted.
    """
    tools = None if radii_mm is None else {number: ToolOffset(radius_mm=r) for number, r in radii_mm.items()}
    settings = MachineSettings(
        offsets=dict.fromkeys(ALL_OFFSETS, (0.0, 0.0, 0.0)),
        home_mm=HOME_MM,
        start_mm=HOME_MM,
        tools=tools,
        tool=tool,
        **more,
    )
    collector = _Collector()
    for part in motion_arrays(program, dialect=dialect, settings=settings):
        collector.take(part)
    return collector.cuts()


class _Collector:
    """Gathers feed motions part by part."""

    def __init__(self) -> None:
        self._parts: list[Feed] = []
        self._rapid_mm = self._dwell_s = 0.0
        self._motions = 0
        self._last_fed = False
        self._states: dict[MotionState, None] = {}

    def take(self, part: MotionArrays) -> None:
        """Add motions."""
        feeding = np.isin(part.kind, _FEEDING)
        dwell = part.kind == MotionKind.DWELL
        lengths, sideways = _lengths(part)
        self._rapid_mm += float(lengths[~feeding & ~dwell].sum())
        self._dwell_s += float(part.seconds.sum())
        self._motions += len(part)
        for index in dict.fromkeys(part.state[feeding].tolist()):
            self._states.setdefault(part.states[index])
        before = np.concatenate([[self._last_fed], feeding[:-1]])
        self._last_fed = bool(feeding[-1]) if len(feeding) else self._last_fed
        self._parts.append(_feed(part, lengths, sideways, ~before).only(feeding & (lengths > 0.0)))

    def cuts(self) -> Cuts:
        """All that was gathered."""
        columns = zip(*(self._parts or [_no_feed()]), strict=True)
        feed = Feed(*(np.concatenate(column) for column in columns))
        radii: dict[int, set[int]] = {}
        lengths: dict[int, set[int]] = {}
        for state in self._states:
            if state.compensation != "off" and state.radius_number is not None:
                radii.setdefault(state.tool, set()).add(state.radius_number)
            if state.length_number is not None:
                lengths.setdefault(state.tool, set()).add(state.length_number)
        return Cuts(
            feed=feed,
            rapid_mm=self._rapid_mm,
            dwell_s=self._dwell_s,
            motions=self._motions,
            tools=tuple(dict.fromkeys(feed.tool.tolist())),
            offsets=tuple(dict.fromkeys(state.wcs for state in self._states)),
            compensated={tool: frozenset(numbers) for tool, numbers in radii.items()},
            length_offsets={tool: frozenset(numbers) for tool, numbers in lengths.items()},
        )


def _feed(part: MotionArrays, lengths: FloatArray, sideways: FloatArray, first: NDArray[np.bool_]) -> Feed:
    low, high = _extremes(part)
    shift = np.array([(*state.tool_offset_xy_mm, state.length_offset_mm) for state in part.states] or [(0.0, 0.0, 0.0)])
    shift = shift[part.state]
    return Feed(
        tool=part.tool.astype(np.int64),
        line=part.line,
        low_mm=low + shift,
        high_mm=high + shift,
        start_mm=part.start_mm + shift,
        end_mm=part.end_mm + shift,
        length_mm=lengths,
        sideways_mm=sideways,
        feed_mm_min=part.feed_mm_min,
        spindle_rpm=part.spindle_rpm * np.abs(part.spindle_direction),
        tapping=part.kind == MotionKind.TAP,
        first=first,
        arc=part.kind == MotionKind.ARC,
    )


def _no_feed() -> Feed:
    none, points = np.zeros(0), np.zeros((0, 3))
    whole, no = none.astype(np.int64), none.astype(bool)
    return Feed(whole, whole, points, points, points, points, none, none, none, none, no, no, no)


def _arcs(part: MotionArrays) -> Iterator[tuple[int, NDArray[np.int64], FloatArray, FloatArray, FloatArray]]:
    """Arcs by plane: the plane, their indices, angle of the start, signed angle swept, radius."""
    for plane, (i, j, _) in PLANE_AXES.items():
        chosen = np.flatnonzero((part.kind == MotionKind.ARC) & (part.plane == plane))
        if not len(chosen):
            continue
        centre = part.centre_mm[chosen]
        start, end = part.start_mm[chosen] - centre, part.end_mm[chosen] - centre
        from_rad, to_rad = np.arctan2(start[:, j], start[:, i]), np.arctan2(end[:, j], end[:, i])
        sign = np.sign(part.turns[chosen])
        one = np.mod(sign * (to_rad - from_rad), 2.0 * np.pi)
        one = np.where(one < 1e-12, 2.0 * np.pi, one)
        swept = sign * (one + 2.0 * np.pi * (np.abs(part.turns[chosen]) - 1))
        radius = np.maximum(np.hypot(start[:, i], start[:, j]), np.hypot(end[:, i], end[:, j]))
        yield plane, chosen, from_rad, swept, radius


def _lengths(part: MotionArrays) -> tuple[FloatArray, FloatArray]:
    """Lengths of motions, and those seen from above; of arcs with their rise."""
    along = part.end_mm - part.start_mm
    lengths, sideways = np.linalg.norm(along, axis=1), np.hypot(along[:, 0], along[:, 1])
    for plane, chosen, _, swept, radius in _arcs(part):
        rise = along[chosen, PLANE_AXES[plane][2]]
        lengths[chosen] = np.hypot(radius * np.abs(swept), rise)
        sideways[chosen] = lengths[chosen]
    return lengths, sideways


def _extremes(part: MotionArrays) -> tuple[FloatArray, FloatArray]:
    """Least and largest coordinates of motions, of the path of arcs."""
    low, high = np.minimum(part.start_mm, part.end_mm), np.maximum(part.start_mm, part.end_mm)
    for plane, chosen, start, swept, radius in _arcs(part):
        first, last = np.minimum(start, start + swept), np.maximum(start, start + swept)
        for axis, phase in zip(PLANE_AXES[plane][:2], (0.0, 0.5 * np.pi), strict=True):
            centre = part.centre_mm[chosen, axis]
            for bound, choose, turn, sign in ((high, np.maximum, 0.0, 1.0), (low, np.minimum, np.pi, -1.0)):
                at = phase + turn
                passed = np.floor((last - at) / (2.0 * np.pi)) >= np.ceil((first - at) / (2.0 * np.pi))
                reach = np.where(passed, centre + sign * radius, bound[chosen, axis])
                bound[chosen, axis] = choose(bound[chosen, axis], reach)
    return low, high
