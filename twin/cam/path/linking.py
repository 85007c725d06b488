"""Passes to one chain of moves: approach, entry, lead-in, cut, lead-out, and the link to the next pass.

Links between passes; the first that is allowed and possible is taken:

1. along the surface (or inside an area that is cleared), at the link feed, where the link is no longer than
   ``stay_down_mm`` and `LinkPlanner` has one;
2. at a clearance above the rest material (``low_links``);
3. up to the safe height, across and down, at the rapid rate.

Straight up from any point of a pass is always free for a three-axis tool, so entries begin above the pass's start.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Literal, Protocol, TypeAlias

import numpy as np

from twin.arrays import FloatArray, frozen
from twin.cam.path.entries import EntryOptions, entry_moves, lead_in, lead_out
from twin.cam.path.toolpath import Move, MoveKind, rapids

Entry: TypeAlias = Literal["plunge", "ramp", "helix"]


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Pass:
    """A run of cutting without a break.

    Attributes:
        points_mm: tool tip, shape (n >= 2, 3); a closed pass ends where it begins.
        top_mm: height of the material over the pass's start; None where there is none to enter through.
        layer: passes of different layers are never linked along the surface.
        approach_mm: a tip in air from which the straight line to the start is free, shape (3,); None
            without one. It replaces the entry.
    """

    points_mm: FloatArray
    top_mm: float | None = None
    layer: int = 0
    approach_mm: FloatArray | None = None

    def __post_init__(self) -> None:
        object.__setattr__(self, "points_mm", frozen(self.points_mm, "points_mm", (None, 3)))
        if self.approach_mm is not None:
            object.__setattr__(self, "approach_mm", frozen(self.approach_mm, "approach_mm", (3,)))
        if len(self.points_mm) < 2:
            raise ValueError(f"points_mm must have shape (n >= 2, 3), got {self.points_mm.shape}")

    @property
    def closed(self) -> bool:
        """Whether it ends where it begins."""
        return len(self.points_mm) > 2 and bool(np.all(self.points_mm[0] == self.points_mm[-1]))


class LinkPlanner(Protocol):
    """The known free space around the passes; tips are positions of the tool's tip."""

    def between(self, start_mm: FloatArray, end_mm: FloatArray) -> FloatArray | None:
        """A link between two tips that cuts nothing of the part, shape (n, 3) with both ends; None without one."""

    def free(self, points_mm: FloatArray) -> bool:
        """Whether the tool may stand at all of these tips, shape (n, 3), without cutting the part."""

    def clear_z_mm(self, start_mm: FloatArray, end_mm: FloatArray) -> float:
        """Height above which a tip may move straight from one position to another through air only."""


@dataclass(frozen=True, slots=True, kw_only=True)
class LinkOptions:
    """How passes are joined.

    Attributes:
        safe_z_mm: height of rapids, above stock and clamps.
        clearance_mm: how far above material rapids end, and low links run.
        feed_mm_min: of cuts, leads, ramps and links along the surface, unless they have their own.
        plunge_mm_min: straight down, ramps and helices.
        link_mm_min: links along the surface; None for ``feed_mm_min``.
        lead_mm_min: leads; None for ``feed_mm_min``.
        stay_down_mm: longest link along the surface, 0 for none.
        low_links: whether rapids across stay at clearance above the rest material, where that is known.
        entry: into material: straight down, along the pass, or a helix.
        ramp_deg: steepest angle of ramps and helices.
        helix_mm: radius of helices.
        lead_mm: radius of lead-ins and lead-outs, 0 for none.
    """

    safe_z_mm: float
    clearance_mm: float = 1.0
    feed_mm_min: float = 600.0
    plunge_mm_min: float = 200.0
    link_mm_min: float | None = None
    lead_mm_min: float | None = None
    stay_down_mm: float = 0.0
    low_links: bool = False
    entry: Entry = "plunge"
    ramp_deg: float = 3.0
    helix_mm: float = 2.0
    lead_mm: float = 0.0

    def __post_init__(self) -> None:
        for name in ("clearance_mm", "feed_mm_min", "plunge_mm_min", "ramp_deg", "helix_mm"):
            if not getattr(self, name) > 0.0:
                raise ValueError(f"{name} must be above 0, got {getattr(self, name)}")
        if self.ramp_deg >= 90.0:
            raise ValueError(f"ramp_deg must be below 90, got {self.ramp_deg}")

    @property
    def entries(self) -> EntryOptions:
        """The options of entries and leads."""
        return EntryOptions(
            entry=self.entry,
            ramp_deg=self.ramp_deg,
            helix_mm=self.helix_mm,
            lead_mm=self.lead_mm,
            plunge_mm_min=self.plunge_mm_min,
            lead_mm_min=self.lead_mm_min or self.feed_mm_min,
        )


def link(passes: Sequence[Pass], options: LinkOptions, planner: LinkPlanner | None = None) -> tuple[Move, ...]:
    """One chain of moves through all passes in their order, from the safe height and back to it.

    Args:
        planner: what is known of the part; without it passes are joined at the safe height, leads and helices are made
            without a check.

    Raises:
        ValueError: a pass above the safe height.
    """
    highest = max((float(p.points_mm[:, 2].max()) for p in passes), default=-np.inf)
    if highest > options.safe_z_mm:
        raise ValueError(
            f"safe_z_mm must be at least {highest:g}, the height of the highest pass: {options.safe_z_mm:g}"
        )
    moves: list[Move] = []
    before: Pass | None = None
    for one in passes:
        moves += _one_pass(moves, before, one, options, planner)
        before = one
    if moves:
        end = moves[-1].end_mm
        moves += rapids(np.array([end, [end[0], end[1], options.safe_z_mm]]))
    return tuple(moves)


def _one_pass(
    moves: Sequence[Move], before: Pass | None, one: Pass, options: LinkOptions, planner: LinkPlanner | None
) -> Iterator[Move]:
    """The moves from the end of those before to the end of one more pass."""
    if before is not None and before.layer == one.layer:
        points = _down(moves, before, one, options, planner)
        if points is not None:
            if len(points) > 1:
                feed = options.link_mm_min or options.feed_mm_min
                yield Move(kind=MoveKind.LINK, points_mm=points, feed_mm_min=feed)
            yield Move(kind=MoveKind.CUT, points_mm=one.points_mm, feed_mm_min=options.feed_mm_min)
            return
    entry, points = _entry(one, options, planner)
    yield from _over(moves, entry[0].start_mm if entry else points[0], options, planner)
    yield from entry
    yield Move(kind=MoveKind.CUT, points_mm=points, feed_mm_min=options.feed_mm_min)
    out = lead_out(points, options.entries, planner.free if planner else None)
    if out is not None:
        yield out


def _entry(one: Pass, options: LinkOptions, planner: LinkPlanner | None) -> tuple[list[Move], FloatArray]:
    """From where rapids end to a pass: from the side through air, by a lead, or down through the material.

    Returns:
        The moves, and the pass's points, see `twin.cam.path.entries.entry_moves`.
    """
    free = planner.free if planner else None
    points, top = one.points_mm, one.top_mm
    lead = lead_in(points, options.entries, free)
    if one.approach_mm is not None and lead is None:
        line = np.array([one.approach_mm, points[0]])
        lead = Move(kind=MoveKind.LEAD, points_mm=line, feed_mm_min=options.lead_mm_min or options.feed_mm_min)
        top = None
    start = points[0] if lead is None else lead.start_mm
    above = start[2] if top is None else max(float(start[2]), top)
    begin = np.array([start[0], start[1], min(above + options.clearance_mm, options.safe_z_mm)])
    if lead is None:
        return entry_moves(points, float(begin[2]), top, options.entries, free)
    down = Move(kind=MoveKind.PLUNGE, points_mm=np.array([begin, start]), feed_mm_min=options.plunge_mm_min)
    return ([down, lead] if begin[2] > start[2] else [lead]), points


def _down(
    moves: Sequence[Move], before: Pass, one: Pass, options: LinkOptions, planner: LinkPlanner | None
) -> FloatArray | None:
    """The link along the surface to the next pass, of one point where it begins at the last one's end."""
    if planner is None or options.stay_down_mm <= 0.0 or options.lead_mm > 0.0:
        return None
    end, start = before.points_mm[-1], one.points_mm[0]
    if np.any(moves[-1].end_mm != end) or np.linalg.norm(start - end) > options.stay_down_mm:
        return None
    if np.all(start == end):
        here: FloatArray = one.points_mm[:1]
        return here
    points = planner.between(end, start)
    if points is None or np.linalg.norm(np.diff(points, axis=0), axis=1).sum() > options.stay_down_mm:
        return None
    return points


def _over(
    moves: Sequence[Move], begin: FloatArray, options: LinkOptions, planner: LinkPlanner | None
) -> tuple[Move, ...]:
    """Rapids from the end of the moves, or from the safe height over the first entry, to where it begins."""
    if not moves:
        return rapids(np.array([[begin[0], begin[1], options.safe_z_mm], begin]))
    end, z = moves[-1].end_mm, options.safe_z_mm
    if options.low_links and planner is not None:
        z = min(z, max(planner.clear_z_mm(end, begin) + options.clearance_mm, end[2], begin[2]))
    return rapids(np.array([end, [end[0], end[1], z], [begin[0], begin[1], z], begin]))
