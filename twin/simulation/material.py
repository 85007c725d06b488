"""The workpiece under a tool: sweeps wait their turn and are subtracted; forbidden contacts are detected."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from itertools import groupby, pairwise
from typing import NamedTuple, TypeAlias

import numpy as np
from numpy.typing import NDArray

from twin.arrays import FloatArray
from twin.motion.chain import chained
from twin.motion.sweep import Body, Sweep, SweptVolume
from twin.record import CollisionKind
from twin.simulation.tools import ToolSetup
from twin.tolerance import Tolerance
from twin.workpiece.removal import Removal, Swept
from twin.workpiece.trislice import TriSlices

#: Sweeps wait until the tool has gone on by this many slice pitches.
PENDING_PITCHES = 10.0
#: Those are subtracted together that make up this many diameters of the tool, or are this many.
TOGETHER_DIAMETERS, TOGETHER = 1.0, 96
#: Chords are subtracted together when at least this many wait.
CHORDS_TOGETHER = 32
#: A sweep this near to a motion's line lies on it, mm.
SAME_LINE_MM = 1e-9
#: A sweep of the tool itself this many chord deviations behind a tangent plane does not reach it: it has been enlarged
#: by one.
_BEHIND_CHORDS = 1.1


#: Chords that retrace earlier ones wait longer, for later ones to swallow them: this many at most, and until they are
#: deeper than the slices are cut by this many pitches; turns deeper than half of that do not wait.
RETRACED_TOGETHER, RETRACED_PITCHES = 512, 1.0
#: Chords are the same in plan when they agree to this many decimals, mm.
_DECIMALS = 9
#: Most plans of chords that are remembered.
_MOST_PLANS = 100_000

#: Start and end of a chord in plan, and its tool.
_Plan: TypeAlias = tuple[float, float, float, float, int]


class _Waiting(NamedTuple):
    """A sweep that waits, the number of its tool, and its plan if it may be subtracted together with others."""

    sweep: Sweep
    tool: int
    plan: _Plan | None = None


class Touch(NamedTuple):
    """A body that must not touch the stock, in the material.

    Attributes:
        kind: of the collision.
        met_mm3: volume of material in the way of the body less its clearance, above 0.
        volume_mm3: volume of material in its way.
    """

    kind: CollisionKind
    met_mm3: float
    volume_mm3: float


class Material:
    """Takes sweeps out of the workpiece in order.

    The newest sweeps wait before they are subtracted from the slices; until then they are excluded from the material
    exactly. So near the tool, where the surface has just been made, engagement does not depend on the slices' pitch.

    Args:
        workpiece: the slices.
        tolerance: of geometry.
        threads: how many work on the slices.

    Attributes:
        contact_mm3: volume of material that a body must meet for a collision.
        removed_mm3: volume removed by each tool, by number.
    """

    def __init__(self, workpiece: TriSlices, tolerance: Tolerance, threads: int) -> None:
        self.workpiece = workpiece
        self.contact_mm3 = tolerance.contact_mm3
        self._removal = Removal(workpiece, tolerance.chord_mm, threads)
        self._waiting: dict[int, _Waiting] = {}
        self._of_plan: dict[_Plan, int] = {}
        self._number = 0
        self._window_mm = PENDING_PITCHES * float(np.max(workpiece.pitch_mm))
        self._behind_mm = _BEHIND_CHORDS * tolerance.chord_mm
        self.removed_mm3: dict[int, float] = {}
        self._last_tool = 0
        self._together_mm = self._waiting_mm = 0.0
        self._cut_to_mm: dict[_Plan, float] = {}

    def pending(self, tool: int, start_mm: FloatArray, feed: FloatArray) -> SweptVolume:
        """Sweeps that are not yet subtracted from the slices and can have reached the front of a moving tool.

        A sweep of the same tool that lies on the motion's line, before its start, cannot: a convex tool there lies
        behind the plane that touches any front point.

        Args:
            tool: number of the moving tool.
            start_mm: tool tip at the start of a straight motion, shape (3,).
            feed: unit vector along it, shape (3,).
        """
        return self._volume(
            [w for w in self._waiting.values() if w.tool != tool or not _behind(w.sweep, start_mm, feed)], tool
        )

    def pending_chords(self, tool: ToolSetup, corners_mm: FloatArray) -> SweptVolume:
        """Sweeps that are not yet subtracted from the slices, and after them those of chords that come next.

        Args:
            corners_mm: shape (n + 1, 3), the ends of n chords, of which the last needs no sweep; without any, only the
                sweeps that wait.
        """
        chords = [_Waiting(Sweep(tool.cutter, a, b), tool.number) for a, b in pairwise(corners_mm[:-1])]
        return self._volume([*self._waiting.values(), *chords], tool.number)

    def pending_sweeps(self, tool: ToolSetup, sweeps: Sequence[Sweep]) -> SweptVolume:
        """Sweeps that are not yet subtracted from the slices, and after them those of the tool that come next."""
        return self._volume([*self._waiting.values(), *(_Waiting(s, tool.number) for s in sweeps)], tool.number)

    def _volume(self, waiting: Sequence[_Waiting], tool: int) -> SweptVolume:
        behind_mm = [self._behind_mm if w.tool == tool else math.inf for w in waiting]
        return SweptVolume([w.sweep for w in waiting], behind_mm)

    @property
    def waiting(self) -> int:
        """How many sweeps are not yet subtracted from the slices."""
        return len(self._waiting)

    def until_subtracted(self, lengths_mm: Sequence[float]) -> int:
        """How many of the next feed motions find the slices as they are now; at least 1.

        Args:
            lengths_mm: of the next motions.
        """
        waiting = [w.sweep.length_mm for w in self._waiting.values()]
        for count, length_mm in enumerate(lengths_mm, start=1):
            waiting.append(length_mm)
            if self._due(waiting):
                return count
        return max(1, len(lengths_mm))

    def near(self, tool: ToolSetup, start_mm: FloatArray, end_mm: FloatArray) -> bool:
        """Whether the box of a motion of any of a tool's bodies meets the stock's box."""
        return any(self._meets(body, start_mm, end_mm) for body in (tool.cutter, *(b for _, b in tool.rigid)))

    def near_each(self, tool: ToolSetup, corners_mm: FloatArray) -> NDArray[np.bool_]:
        """For each line of a path, whether the box of a motion of any of a tool's bodies meets the stock's box.

        Args:
            corners_mm: shape (n + 1, 3), ends of the lines.
        """
        low, high = np.minimum(corners_mm[:-1], corners_mm[1:]), np.maximum(corners_mm[:-1], corners_mm[1:])
        near = np.zeros(len(low), dtype=np.bool_)
        for body in (tool.cutter, *(b for _, b in tool.rigid)):
            reach = np.array([body.radius_mm, body.radius_mm, 0.0])
            above = np.all(high + reach + [0.0, 0.0, body.top_mm] > self.workpiece.low_mm, axis=1)
            near |= above & np.all(low - reach + [0.0, 0.0, body.bottom_mm] < self.workpiece.high_mm, axis=1)
        return near

    def rigid_near(self, tool: ToolSetup, corners_mm: FloatArray) -> bool:
        """Whether the box of a path of shank or holder meets the stock's box.

        Args:
            corners_mm: shape (n, 3), corners of the path of the tool tip.
        """
        low, high = corners_mm.min(axis=0), corners_mm.max(axis=0)
        return any(self._meets(body, low, high) for _, body in tool.rigid)

    def _meets(self, body: Body, start_mm: FloatArray, end_mm: FloatArray) -> bool:
        low, high = Sweep(body, start_mm, end_mm).bounds_mm
        return bool(np.all(high > self.workpiece.low_mm) and np.all(low < self.workpiece.high_mm))

    def cut(
        self,
        tool: ToolSetup,
        start_mm: FloatArray,
        end_mm: FloatArray,
        forbidden: CollisionKind | None,
    ) -> Iterator[Touch]:
        """Move the cutting part in a straight line: it removes material, now or a little later.

        Where it must not cut and goes no deeper into the material than the clearance, it removes nothing.

        Args:
            forbidden: kind of the collision when it meets material, None for a motion that is to cut.

        Yields:
            The touch, if it is forbidden and material was met.
        """
        if forbidden is None:
            self.add(tool, Sweep(tool.cutter, start_mm, end_mm))
            return
        self.flush()
        met = self._removal.cut(Sweep(tool.guard, start_mm, end_mm), apply=False)
        if met > 0.0:
            self._wait(_Waiting(Sweep(tool.cutter, start_mm, end_mm), tool.number))
            yield Touch(forbidden, met, self._subtract(1))

    def add(self, tool: ToolSetup, sweep: Sweep) -> None:
        """A sweep of the cutting part: it removes material, now or a little later."""
        self._wait(_Waiting(sweep, tool.number))
        self._together_mm = TOGETHER_DIAMETERS * 2.0 * tool.cutter.radius_mm
        if self._waiting_mm >= self._window_mm + self._together_mm or len(self._waiting) > TOGETHER:
            self._subtract(self._due([w.sweep.length_mm for w in self._waiting.values()]))

    def touches(self, tool: ToolSetup, start_mm: FloatArray, end_mm: FloatArray) -> Iterator[Touch]:
        """Shank and holder moved in a straight line, after the cutting part has gone there; they remove nothing."""
        for kind, body in tool.rigid:
            if self._meets(body, start_mm, end_mm):
                sweep = Sweep(body, start_mm, end_mm)
                volume = self._removal.cut(sweep, apply=False)
                if volume > 0.0 and (self._waiting or self._removal.left is not None):
                    self.flush()
                    volume = self._removal.cut(sweep, apply=False)
                if volume > 0.0:
                    yield Touch(kind, volume, volume)

    def add_chord(self, tool: ToolSetup, start_mm: FloatArray, end_mm: FloatArray) -> None:
        """Move the cutting part along a chord; it waits until `settle` subtracts it together with those before it.

        A chord that waits is forgotten when this one swallows it: the same in plan and nowhere below it. Tools become
        no thinner upwards, so this one removes all that the other does, as long as its cutting part reaches above the
        stock.
        """
        plan = _plan(start_mm, end_mm, tool.number)
        sweep = Sweep(tool.cutter, start_mm, end_mm)
        earlier = self._waiting.get(self._of_plan.get(plan, -1))
        if earlier is not None and self._swallows(sweep, earlier.sweep):
            del self._waiting[self._of_plan[plan]]
        self._of_plan[plan] = self._wait(_Waiting(sweep, tool.number, plan))

    def settle(self, tool: ToolSetup, start_mm: FloatArray, end_mm: FloatArray) -> None:
        """Subtract everything that waits, if that is much and will not soon be swallowed.

        Args:
            tool, start_mm, end_mm: the chord that will be added next.
        """
        if len(self._waiting) < CHORDS_TOGETHER:
            return
        plan, z_mm = _plan(start_mm, end_mm, tool.number), float(end_mm[2])
        cut_mm = self._cut_to_mm.get(plan, math.inf)
        before = self._waiting.get(self._of_plan.get(plan, -1))
        before_mm = cut_mm if before is None else float(before.sweep.end_mm[2])
        deep_mm = RETRACED_PITCHES * float(self.workpiece.pitch_mm[2])
        soon = cut_mm - z_mm <= deep_mm and before_mm - z_mm <= 0.5 * deep_mm
        if len(self._waiting) > RETRACED_TOGETHER or not soon:
            self._subtract(len(self._waiting), Sweep(tool.cutter, start_mm, end_mm))

    def _wait(self, sweep: _Waiting) -> int:
        """Let a sweep wait; returns its number."""
        self._number += 1
        self._waiting[self._number] = sweep
        self._waiting_mm += sweep.sweep.length_mm
        return self._number

    def _swallows(self, later: Sweep, earlier: Sweep) -> bool:
        """Whether a sweep of the same body and the same plan contains an earlier one, in the stock."""
        deep = later.start_mm[2] <= earlier.start_mm[2] and later.end_mm[2] <= earlier.end_mm[2]
        lowest = min(float(later.start_mm[2]), float(later.end_mm[2]))
        return bool(deep) and lowest + later.body.top_mm >= float(self.workpiece.high_mm[2])

    def _due(self, lengths_mm: Sequence[float]) -> int:
        """How many sweeps, of those that wait, are to be subtracted now; 0 while they are too few.

        Args:
            lengths_mm: of the sweeps that wait.
        """
        done, older = 0, 0.0
        newer = sum(lengths_mm) - lengths_mm[0]
        while len(lengths_mm) - done > 1 and newer >= self._window_mm:
            older += lengths_mm[done]
            done += 1
            newer -= lengths_mm[done]
        return done if older >= self._together_mm or done >= TOGETHER else 0

    def flush(self) -> None:
        """Subtract everything that waits."""
        left = self._removal.left
        if left is not None and not self._waiting:
            self._wait(_Waiting(left, self._last_tool))
        self._subtract(len(self._waiting))

    def volume_inside(self, tool: ToolSetup, tip_mm: FloatArray) -> float:
        """Volume of material inside the cutting part at rest, less its clearance, mm3."""
        self.flush()
        return self._removal.cut(Sweep(tool.guard, tip_mm, tip_mm), apply=False)

    def _subtract(self, count: int, after: Sweep | None = None) -> float:
        """Subtract the sweeps that have waited longest; returns the removed volume, mm3.

        Args:
            after: the sweep that comes next, where nothing else waits.
        """
        taken = [self._waiting.pop(number) for number in list(self._waiting)[:count]]
        self._waiting_mm = sum(w.sweep.length_mm for w in self._waiting.values())
        if not taken:
            return 0.0
        sweeps: list[Swept] = []
        tools: list[int] = []
        for (tool, chord), together in groupby(taken, key=lambda w: (w.tool, w.plan is not None)):
            single = [w.sweep for w in together]
            sweeps.extend(chained(single) if chord else self._removal.united(single))
            tools.extend([tool] * (len(sweeps) - len(tools)))
        if len(self._cut_to_mm) > _MOST_PLANS:
            self._cut_to_mm.clear()
            self._of_plan.clear()
        self._cut_to_mm.update((w.plan, float(w.sweep.end_mm[2])) for w in taken if w.plan is not None)
        volumes = self._removal.cut_all(sweeps, after=next((w.sweep for w in self._waiting.values()), after))
        self._last_tool = tools[-1]
        for tool, volume in zip(tools, volumes.tolist(), strict=True):
            if volume > 0.0:
                self.removed_mm3[tool] = self.removed_mm3.get(tool, 0.0) + volume
        return float(volumes.sum())

    def close(self) -> None:
        """End the worker threads."""
        self._removal.close()


def _plan(start_mm: FloatArray, end_mm: FloatArray, tool: int) -> _Plan:
    """Plan of a chord, which chords that retrace each other have in common."""
    (ax, ay), (bx, by) = start_mm[:2].tolist(), end_mm[:2].tolist()
    return round(ax, _DECIMALS), round(ay, _DECIMALS), round(bx, _DECIMALS), round(by, _DECIMALS), tool


def _behind(sweep: Sweep, start_mm: FloatArray, feed: FloatArray) -> bool:
    """Whether a straight sweep lies on the line of a motion, before its start."""
    behind = np.array([start_mm - sweep.start_mm, start_mm - sweep.end_mm])
    along = behind @ feed
    aside = np.abs(behind - along[:, None] * feed).max()
    return bool(aside <= SAME_LINE_MM and along.min() >= -SAME_LINE_MM)
