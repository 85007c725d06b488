"""Finishing by scanning lines: rows over the part's exact offset surface (the mold paper, section 2.3).

The tool is dropped on the triangles along each row. Between two points the row is divided until its straight pieces
keep to the surface within a part of the chord tolerance; arcs and longer pieces are fitted within the rest of it.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from twin.arrays import FloatArray
from twin.cam.passes.roughing import StageFeeds, Workspace
from twin.cam.passes.steep_walls import SteepMap, level_lines
from twin.cam.path.arc_fit import FitOptions, fit_path
from twin.cam.path.linking import LinkOptions, Pass, link
from twin.cam.path.machining_time import Dynamics
from twin.cam.path.toolpath import ToolPath
from twin.cam.path.tour import LinkSpeeds, order_pieces
from twin.cam.slices import stretch_kernels as kernels
from twin.cam.stock.dexel import Dexels
from twin.cam.stock.rest import spacing_for_cusp, stock_heights
from twin.cam.surface.drop_cutter import DropCutter
from twin.tools.shape import ToolShape

#: Part of the chord tolerance that dividing rows may use; fitting has the rest.
_SHARE = 0.3
#: Rows are divided no further than to this length, mm: walls that stand upright.
_LEAST_PIECE_MM = 5e-4
_MOST_ROUNDS = 14


@dataclass(frozen=True, slots=True, kw_only=True)
class FinishingOptions:
    """How the surface is finished.

    Attributes:
        stepover_mm: distance of rows in the plan.
        chord_mm: how far the path may lie from the exact one.
        pitch_mm: distance of the first points along a row.
        direction: of the rows.
        steep_deg: surfaces steeper than this get level lines instead of rows; None for rows everywhere.
        least_mm: thinner material is not cut.
        bridge_mm: shorter gaps without material are bridged.
        feeds: of the stage.
    """

    stepover_mm: float
    chord_mm: float = 0.005
    pitch_mm: float = 0.3
    direction: Literal["x", "y"] = "x"
    steep_deg: float | None = None
    least_mm: float = 0.01
    bridge_mm: float = 5.0
    feeds: StageFeeds


@dataclass(frozen=True, slots=True, eq=False)
class Row:
    """One scanning line.

    Attributes:
        at_mm: its position across.
        along_mm: positions along it, increasing, shape (n,).
        z_mm: tip heights there, shape (n,).
    """

    at_mm: float
    along_mm: FloatArray
    z_mm: FloatArray


def stepover_for_scallop(cutter: DropCutter, scallop_mm: float) -> float:
    """Distance of rows that leaves scallops no higher than this on level ground."""
    assert cutter.tool is not None
    return 2.0 * spacing_for_cusp(cutter.tool, scallop_mm)


def scan_rows(cutter: DropCutter, low_mm: FloatArray, high_mm: FloatArray, options: FinishingOptions) -> list[Row]:
    """Rows over a rectangle of the plan, divided where they bend.

    Args:
        low_mm, high_mm: corners of the rectangle, shape (2,).
    """
    u, v = (0, 1) if options.direction == "x" else (1, 0)
    across = _even(low_mm[v], high_mm[v], options.stepover_mm)
    along = _even(low_mm[u], high_mm[u], options.pitch_mm)
    row = np.repeat(np.arange(len(across)), len(along))
    at = np.tile(along, len(across))
    z = _drop(cutter, at, across[row], u)
    tolerance = _SHARE * options.chord_mm
    # the pieces still to be checked, by number of their first point
    same = np.append(row[1:] == row[:-1], False)
    pieces = np.flatnonzero(same)
    left = np.column_stack((at[pieces], at[pieces + 1], z[pieces], z[pieces + 1]))
    which = row[pieces]
    rows, ats, zs = [row], [at], [z]
    for number in range(_MOST_ROUNDS):
        if not len(left):
            break
        middle = 0.5 * (left[:, 0] + left[:, 1])
        found = _drop(cutter, middle, across[which], u)
        off = np.abs(found - 0.5 * (left[:, 2] + left[:, 3])) > tolerance
        if number == 0:  # a piece whose middle is right by chance has a neighbour that bends
            off = off | (np.append(off[1:], False) & same[pieces]) | np.insert(off[:-1], 0, False)
        rows.append(which[off])
        ats.append(middle[off])
        zs.append(found[off])
        halves = np.concatenate(
            (
                np.column_stack((left[off, 0], middle[off], left[off, 2], found[off])),
                np.column_stack((middle[off], left[off, 1], found[off], left[off, 3])),
            )
        )
        which = np.tile(which[off], 2)
        long = halves[:, 1] - halves[:, 0] > 2.0 * _LEAST_PIECE_MM
        left, which = halves[long], which[long]
    return _gathered(across, np.concatenate(rows), np.concatenate(ats), np.concatenate(zs))


def _even(low: float, high: float, longest: float) -> FloatArray:
    return np.linspace(low, high, max(1, math.ceil((high - low) / longest - 1e-9)) + 1)


def _drop(cutter: DropCutter, at: FloatArray, across: FloatArray, u: int) -> FloatArray:
    points = np.empty((len(at), 2))
    points[:, u], points[:, 1 - u] = at, across
    return cutter.drop(points)


def _gathered(across: FloatArray, rows: NDArray[np.int64], ats: FloatArray, zs: FloatArray) -> list[Row]:
    order = np.lexsort((ats, rows))
    rows, ats, zs = rows[order], ats[order], zs[order]
    bounds = np.searchsorted(rows, np.arange(len(across) + 1))
    return [
        Row(float(y), ats[a:b], zs[a:b])
        for y, a, b in zip(across, bounds[:-1].tolist(), bounds[1:].tolist(), strict=True)
    ]


def row_chains(
    rows: Sequence[Row], cutter: DropCutter, stock: Dexels, options: FinishingOptions, chart: SteepMap | None = None
) -> list[list[FloatArray]]:
    """The parts of the rows that cut, in zigzag: each chain holds runs of neighbouring rows that overlap.

    Args:
        chart: steep areas, where there are no rows.
    """
    assert cutter.tool is not None
    u = 0 if options.direction == "x" else 1
    chains: list[list[FloatArray]] = []
    last: list[list[FloatArray]] = []
    for row in rows:
        line = np.empty((len(row.z_mm), 3))
        line[:, u], line[:, 1 - u], line[:, 2] = row.along_mm, row.at_mm, row.z_mm
        plan = np.ascontiguousarray(line[:, :2])
        wanted = stock_heights(stock, cutter.tool, plan) > row.z_mm + options.least_mm
        if chart is not None:
            wanted &= ~chart.at(chart.inner, plan)
        here: list[list[FloatArray]] = []
        for run in _runs(line, wanted, options.bridge_mm):
            nearby = [c for c in last if _overlap(c[-1][:, u], run[:, u])]
            if len(nearby) == 1 and all(nearby[0] is not c for c in here):
                chain = nearby[0]
                back = np.linalg.norm(run[-1] - chain[-1][-1]) < np.linalg.norm(run[0] - chain[-1][-1])
                chain.append(run[::-1] if back else run)
            else:
                chain = [run]
                chains.append(chain)
            here.append(chain)
        last = here
    return chains


def _overlap(a: FloatArray, b: FloatArray) -> bool:
    """Whether two runs share more than half of the shorter one's range."""
    shared = min(a.max(), b.max()) - max(a.min(), b.min())
    return bool(shared > 0.5 * min(np.ptp(a), np.ptp(b)))


def _runs(line: FloatArray, wanted: NDArray[np.bool_], bridge_mm: float) -> Iterator[FloatArray]:
    """The parts of a line that are wanted, a point more at both ends."""
    bounds = np.empty((len(line), 2), dtype=np.int64)
    spacing = np.linalg.norm(np.diff(line[:, :2], axis=0), axis=1)
    count = kernels.runs(np.ascontiguousarray(wanted), spacing, bridge_mm, bounds)
    for a, b in bounds[:count].tolist():
        run = line[max(0, a - 1) : b + 2]
        if len(run) > 1:
            yield run


def steep_chains(
    cutter: DropCutter, stock: Dexels, options: FinishingOptions, chart: SteepMap
) -> list[list[FloatArray]]:
    """The parts of the level lines that cut, a chain for each wall, from its top."""
    assert cutter.tool is not None
    chains: list[list[FloatArray]] = []
    walls = list(level_lines(cutter, chart, options.stepover_mm, _SHARE * options.chord_mm))
    for wall in walls:
        chain: list[FloatArray] = []
        for line in wall:
            tips = stock_heights(stock, cutter.tool, np.ascontiguousarray(line[:, :2]))
            chain += _runs(line, tips > line[:, 2] + options.least_mm, options.bridge_mm)
        if chain:
            chains.append(chain)
    return chains


def in_order(
    chains: Sequence[list[FloatArray]], tool: ToolShape, stock: Dexels, space: Workspace, dynamics: Dynamics
) -> Iterator[Pass]:
    """The chains' runs as passes, chains in the order of a tour; each knows the stock over its start."""
    if not chains:
        return
    ends = np.array([(chain[0][0, :2], chain[-1][-1, :2]) for chain in chains])
    speeds = LinkSpeeds(
        feed_mm_s=1e-6,  # chains are never joined on the surface
        rapid_mm_s=dynamics.rapid_mm_min / 60.0,
        rapid_mm_s2=dynamics.rapid_mm_s2,
    )
    tour = order_pieces(ends, space.low_mm[:2], speeds, two_way=False)
    for number in tour.order.tolist():
        starts = np.array([run[0, :2] for run in chains[number]])
        tops = stock_heights(stock, tool, starts)
        for run, top in zip(chains[number], tops.tolist(), strict=True):
            yield Pass(points_mm=run, top_mm=top if top > run[0, 2] else None)


class RowLinkPlanner:
    """Links over the part between rows, see `twin.cam.path.linking.LinkPlanner`.

    Args:
        cutter: the finishing tool over the part.
        stock: before the stage.
        step_mm: distance of the points that are checked.
    """

    def __init__(self, cutter: DropCutter, stock: Dexels, step_mm: float) -> None:
        self._cutter, self._stock, self._step = cutter, stock, step_mm

    def between(self, start_mm: FloatArray, end_mm: FloatArray) -> FloatArray:
        """Straight in the plan at the height of the highest point on the link."""
        z = max(float(self._cutter.drop(self._along(start_mm, end_mm), threads=1).max()), start_mm[2], end_mm[2])
        over = [[start_mm[0], start_mm[1], z], [end_mm[0], end_mm[1], z]]
        line = np.array([start_mm, *over, end_mm])
        kept: FloatArray = line[np.concatenate(([True], np.any(np.diff(line, axis=0) != 0.0, axis=1)))]
        return kept

    def free(self, points_mm: FloatArray) -> bool:
        """Whether all tips are above the surface."""
        return bool(np.all(points_mm[:, 2] >= self._cutter.drop(points_mm[:, :2], threads=1)))

    def clear_z_mm(self, start_mm: FloatArray, end_mm: FloatArray) -> float:
        """Lowest tip that touches nothing of the stock on the link."""
        assert self._cutter.tool is not None
        line = self._along(start_mm, end_mm)
        highest = float(stock_heights(self._stock, self._cutter.tool, line, threads=1).max())
        return highest if math.isfinite(highest) else float(max(start_mm[2], end_mm[2]))

    def _along(self, start: FloatArray, end: FloatArray) -> FloatArray:
        count = max(1, math.ceil(float(np.linalg.norm(end[:2] - start[:2])) / self._step))
        part = (np.arange(count + 1) / count)[:, None]
        line: FloatArray = start[:2] * (1.0 - part) + end[:2] * part
        return line


def finishing(
    space: Workspace, cutter: DropCutter, options: FinishingOptions, stock: Dexels, dynamics: Dynamics
) -> ToolPath:
    """Rows over all of the part's plan where there is material above the surface.

    Args:
        cutter: the tool over the part.
        stock: before the stage.
    """
    assert cutter.tool is not None
    low, high = space.part.vertices_mm.min(axis=0)[:2], space.part.vertices_mm.max(axis=0)[:2]
    chart = None
    if options.steep_deg is not None:
        chart = SteepMap.of(cutter, low, high, options.pitch_mm, options.steep_deg)
    passes = list(
        in_order(
            row_chains(scan_rows(cutter, low, high, options), cutter, stock, options, chart),
            cutter.tool,
            stock,
            space,
            dynamics,
        )
    )
    if chart is not None:
        passes += in_order(steep_chains(cutter, stock, options, chart), cutter.tool, stock, space, dynamics)
    linking = LinkOptions(
        safe_z_mm=space.safe_z_mm,
        clearance_mm=space.clearance_mm,
        feed_mm_min=options.feeds.cut,
        plunge_mm_min=options.feeds.plunge,
        link_mm_min=options.feeds.link,
        stay_down_mm=4.0 * options.stepover_mm,
        low_links=True,
        entry="plunge",
    )
    moves = link(passes, linking, RowLinkPlanner(cutter, stock, 0.5 * options.stepover_mm)) if passes else ()
    path = ToolPath(moves=moves, tool=cutter.tool, name=_name(options))
    share = (1.0 - _SHARE) * options.chord_mm
    return fit_path(path, FitOptions(tolerance_mm=share, gouge_mm=share, material="below"))


def _name(options: FinishingOptions) -> str:
    steep = f", level lines above {options.steep_deg:g} deg" if options.steep_deg is not None else ""
    return f"finishing, scanning along {options.direction}{steep}"
