"""The stock of a draft: as requested, as the program's comments state it, or around the cutting motions."""

from __future__ import annotations

import re
from collections.abc import Collection, Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from twin.arrays import FloatArray
from twin.drafting.comments.stock_posts import StockStatement
from twin.drafting.cuts import HOME_MM, Feed
from twin.drafting.notes import Notes
from twin.drafting.tables import DraftTable
from twin.errors import StockError
from twin.workpiece.solids.from_mesh import load_mesh

#: Material below the lowest point of the tools, mm.
_FLOOR_MM = 2.0
#: Share of the path that entries and lead-outs above the stock may have.
_ABOVE_SHARE = 0.05
#: Share of the path at a level from which it counts as a level, and least stock above a level, mm.
_LEVEL_SHARE, _ABOVE_LEVEL_MM = 0.05, 1.0
_SAME_MM = 1e-3
#: Share of a stock's size that entries and exits may be next to it.
_OVER_SHARE = 0.25
#: A path that is all this far below Z0 has its zero elsewhere than on the stock, mm.
_DEEPEST_MM = 30.0
_EXPECTED = (
    "'box X Y Z', 'cylinder D H', either with 'at X Y Z' (centre in X and Y, top in Z), all in mm, or an STL file"
)
_N = r"[-+]?(?:\d{1,9}(?:\.\d*)?|\.\d+)"
_AT = re.compile(rf"\s+at\s+({_N})\s+({_N})\s+({_N})\s*$", re.IGNORECASE)
_BOX = re.compile(rf"box\s+({_N})\s*[x ]\s*({_N})\s*[x ]\s*({_N})$", re.IGNORECASE)
_CYLINDER = re.compile(rf"cylinder\s+({_N})\s*[x ]\s*({_N})$", re.IGNORECASE)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class StockBox:
    """The box of a stock, and its table.

    Attributes:
        low_mm, high_mm: corners, shape (3,).
        table: the job's ``[stock]``.
    """

    low_mm: FloatArray
    high_mm: FloatArray
    table: DraftTable

    @property
    def size_mm(self) -> FloatArray:
        """Extents along X, Y and Z."""
        return self.high_mm - self.low_mm


@dataclass(frozen=True, slots=True, kw_only=True)
class Top:
    """Height at which cutting begins.

    Attributes:
        z_mm: Z.
        reason: how it was found.
    """

    z_mm: float
    reason: str


def top_of_cut(feed: Feed) -> Top:
    """The height at which cutting begins, from feed motions that are not plunges.

    Programs have their zero on the stock more often than not: where no more than lead-ins and lead-outs are above Z0,
    that is the top. Otherwise it is the highest level plus one step-down, at most where plunges begin, or the highest
    point of the path.
    """
    side = feed.only(feed.sideways)
    if not len(side.tool):
        return _top_of_holes(feed)
    cutting = feed.only(feed.sideways & ~_entries(feed) & ~_links(feed))
    side = cutting if len(cutting.tool) else side
    plunges_mm = float(feed.start_mm[feed.first, 2].max()) if feed.first.any() else np.inf
    middle = 0.5 * (side.low_mm[:, 2] + side.high_mm[:, 2])
    above = float(side.length_mm[middle > _SAME_MM].sum()) / float(side.length_mm.sum())
    levels = _levels(side)
    highest = float(side.high_mm[:, 2].max())
    if above <= _ABOVE_SHARE and (highest > -_DEEPEST_MM or plunges_mm >= 0.0):
        if levels and abs(levels[0]) < _SAME_MM:
            return _over_level(levels, plunges_mm)
        return Top(z_mm=0.0, reason="at Z0: no more than entries and lead-outs are above it")
    step = levels[0] - levels[1] if len(levels) > 1 else _ABOVE_LEVEL_MM
    if levels and levels[0] >= highest - step - _SAME_MM:
        return _over_level(levels, plunges_mm)
    return Top(z_mm=min(highest, plunges_mm), reason="at the highest point of the cutting motions")


def _top_of_holes(feed: Feed) -> Top:
    """The top of a program that only plunges: holes, of which a peck begins deep in the hole."""
    _, hole = np.unique(np.round(feed.end_mm[:, :2], 3), axis=0, return_inverse=True)
    tops = np.full(int(hole.max()) + 1, -np.inf)
    np.maximum.at(tops, hole.ravel(), feed.start_mm[:, 2])
    starts = float(tops.min())
    if float(feed.low_mm[:, 2].min()) < 0.0 <= starts:
        return Top(z_mm=0.0, reason="at Z0: plunges begin above it and end below it")
    return Top(z_mm=starts, reason="where plunges begin")


def _over_level(levels: list[float], plunges_mm: float) -> Top:
    """A step-down above the highest level, at most where plunges begin."""
    step = levels[0] - levels[1] if len(levels) > 1 else _ABOVE_LEVEL_MM
    room = plunges_mm - levels[0]
    step = min(step, room) if room > _SAME_MM else step
    what = "one step-down" if len(levels) > 1 else f"{step:.3g} mm"
    return Top(z_mm=levels[0] + step, reason=f"{what} above the highest level, Z{levels[0]:.4g}")


def _levels(side: Feed) -> list[float]:
    """Heights at which a good part of a tool's path is level, from the top: those of the tool of the highest one."""
    highest: list[float] = []
    for tool in dict.fromkeys(side.tool.tolist()):
        own = side.only(side.tool == tool)
        heights = np.round(own.low_mm[own.level, 2], 3)
        found, at = np.unique(heights, return_inverse=True)
        sums = np.bincount(at, weights=own.length_mm[own.level], minlength=len(found))
        least = min(_LEVEL_SHARE, 0.5 / max(len(found), 1)) * float(own.length_mm.sum())
        levels = [float(z) for z, length in zip(found[::-1], sums[::-1], strict=True) if length >= least]
        highest = max(highest, levels, key=lambda some: some[0] if some else -np.inf)
    return highest


def _entries(feed: Feed) -> NDArray[np.bool_]:
    """Motions that go down without a break after a rapid: plunges, ramps and helices into the material."""
    stops = np.cumsum(feed.end_mm[:, 2] > feed.start_mm[:, 2] - _SAME_MM)
    first = feed.first.copy()
    first[:1] = True
    begun = np.maximum.accumulate(np.where(first, np.arange(len(first)), 0))
    before = np.concatenate([[0], stops])[begun]
    inside: NDArray[np.bool_] = stops == before
    return inside


def _links(feed: Feed) -> NDArray[np.bool_]:
    """Motions between a retract at feed and the next plunge: some posts write rapids as feed motions.

    Level motions above Z0 at a height of such retracts are links too, as the approach to the first plunge is, and so
    are those at the height of the reference point.
    """
    up = ~feed.sideways & (feed.end_mm[:, 2] > feed.start_mm[:, 2])
    last = np.maximum.accumulate(np.where(~feed.sideways | feed.first, np.arange(len(up)), 0))
    height = np.round(feed.low_mm[:, 2], 3)
    clear = np.isin(height, np.round(feed.end_mm[up, 2], 3)) & (height > 0.0) | (height >= HOME_MM[2])
    links: NDArray[np.bool_] = up[last] | (feed.level & clear)
    return links


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class CutShape:
    """The box of the cutting motions.

    Attributes:
        feed: all feed motions.
        top: height at which cutting begins.
        low_mm, high_mm: corners of the box of the motions below it, grown sideways by the tools' radii, shape (3,).
    """

    feed: Feed
    top: Top
    low_mm: FloatArray
    high_mm: FloatArray

    @classmethod
    def of(cls, feed: Feed, radius_mm: Mapping[int, float], facing: Collection[int] = ()) -> CutShape:
        """The shape of a program's cuts.

        Args:
            feed: its feed motions, at least one.
            radius_mm: largest radius of each tool.
            facing: face mills: they begin and end off the stock, so other tools determine its sides, if there are any.
        """
        top = top_of_cut(feed)
        below = feed.low_mm[:, 2] < top.z_mm - _SAME_MM
        part = feed.only(below) if below.any() else feed
        others = ~np.isin(part.tool, list(facing)) & part.sideways
        sides = part.only(others) if others.any() else part
        radii = np.array([radius_mm.get(tool, 0.0) for tool in sides.tool.tolist()])
        grow = np.stack([radii, radii, np.zeros(len(radii))], axis=1)
        if facing and not others.any():
            grow *= np.ptp([sides.low_mm.min(axis=0), sides.high_mm.max(axis=0)], axis=0) < 2.0 * radii.max()
        low, high = (sides.low_mm - grow).min(axis=0), (sides.high_mm + grow).max(axis=0)
        low[2], high[2] = part.low_mm[:, 2].min(), top.z_mm
        return cls(feed=feed, top=top, low_mm=low, high_mm=high)


def stock_of(
    shape: CutShape, stated: StockStatement | None, requested: str | None, margin_mm: float, notes: Notes, folder: Path
) -> StockBox:
    """The stock of a job.

    Args:
        shape: the box of the cutting motions.
        stated: what the program's comments state.
        requested: the option, see `DraftSettings.stock`; it counts first.
        margin_mm: stock around the cutting motions.
        notes: takes assumptions and warnings.
        folder: of the job file, to which the name of an STL file is relative there.

    Raises:
        StockError: a request that cannot be read.
        MeshError: an STL file that cannot be used.
    """
    if requested is not None:
        box = _requested(requested, shape, notes, folder)
    elif stated is not None:
        box = _stated(stated, shape, notes)
    else:
        box = _around(shape, margin_mm, notes)
    _check(box, shape.feed, notes)
    return box


def _around(shape: CutShape, margin_mm: float, notes: Notes) -> StockBox:
    side, floor = np.array([margin_mm, margin_mm, 0.0]), max(margin_mm, _FLOOR_MM)
    low, high = shape.low_mm - side, shape.high_mm + side
    low[2] = min(low[2], high[2] - 0.1) - floor
    grown = "grown by the tool radius" + (f" and {margin_mm:g} mm" if margin_mm else "")
    reason = f"the cutting motions, {grown}; top {shape.top.reason}; {floor:g} mm below the lowest cut"
    return _box(low, high, reason, notes)


def _box(low: FloatArray, high: FloatArray, reason: str, notes: Notes) -> StockBox:
    low, high = np.floor(low * 1000.0 + 1e-6) / 1000.0 + 0.0, np.ceil(high * 1000.0 - 1e-6) / 1000.0 + 0.0
    words = ", ".join(f"{axis} {a:g} to {b:g}" for axis, a, b in zip("XYZ", low, high, strict=True))
    notes.assume("stock", f"box {words}", reason)
    table = DraftTable(name="stock", comments=[f"assumed: {reason}"])
    table.add("box_mm", {"min": low.tolist(), "max": high.tolist()})
    return StockBox(low_mm=low, high_mm=high, table=table)


def _stated(stated: StockStatement, shape: CutShape, notes: Notes) -> StockBox:
    """The box that a comment states, placed as it states, else with its corner or centre at zero or over the cuts."""
    extents = " x ".join(f"{length:g}" for length in stated.size_mm)
    notes.stated.append(f"stock {extents} mm (line {stated.line})")
    size = np.array(stated.size_mm)
    given = [value is not None for value in stated.low_mm]
    low, where = _likely(size, shape)
    low = np.array([float(a) if a is not None else b for a, b in zip(stated.low_mm, low.tolist(), strict=True)])
    table = DraftTable(name="stock", comments=[f"size stated in line {stated.line} of the program"])
    if not all(given):
        axes = " and ".join(axis for axis, known in zip("XYZ", given, strict=True) if not known)
        reason = f"line {stated.line} states the size only; {where}, top {shape.top.reason}"
        words = ", ".join(f"{axis} from {a:g}" for axis, a, known in zip("XYZ", low, given, strict=True) if not known)
        notes.assume("stock", f"position {words}", reason)
        table.comments.append(f"assumed: position along {axes}: {reason}")
    table.add("box_mm", {"min": low.tolist(), "max": (low + size).tolist()})
    return StockBox(low_mm=low, high_mm=low + size, table=table)


def _likely(size: FloatArray, shape: CutShape) -> tuple[FloatArray, str]:
    """Lower corner of a box of stated size in a program whose zero is usually at its corner or its centre."""
    low = _placed(size, shape)
    best, where, least = low, "centred over the cutting motions", np.inf
    for zero, name in ((0.0, "corner"), (0.5, "centre")):
        corner = 0.0 - zero * size
        over = np.maximum([corner - shape.low_mm, shape.high_mm - corner - size], 0.0)[:, :2]
        if (over <= _OVER_SHARE * size[:2]).all() and over.sum() < least:
            best, least = np.array([*corner[:2], low[2]]), float(over.sum())
            where = f"zero at its {name}, where the cutting motions fit"
    return best, where


def _placed(size: FloatArray, shape: CutShape) -> FloatArray:
    """Lower corner of a box that is centred over the cutting motions, its top where cutting begins."""
    middle = 0.5 * (shape.low_mm + shape.high_mm)
    corner: FloatArray = np.array([*(middle - 0.5 * size)[:2], shape.top.z_mm - size[2]])
    return np.round(corner, 3)


def _requested(text: str, shape: CutShape, notes: Notes, folder: Path) -> StockBox:
    at = _AT.search(text)
    words = _AT.sub("", text).strip()
    box, cylinder = _BOX.fullmatch(words), _CYLINDER.fullmatch(words)
    if box is None and cylinder is None:
        if words.lower().startswith(("box", "cylinder")) or at is not None or not words.lower().endswith(".stl"):
            raise StockError(f"--stock {text!r}: expected {_EXPECTED}")
        return _mesh(Path(words), folder)
    numbers = [float(n) for n in (box or cylinder).groups()]  # type: ignore[union-attr]
    if min(numbers) <= 0.0:
        raise StockError(f"--stock {text!r}: expected lengths above 0, in mm: {_EXPECTED}")
    size = np.array(numbers if box else [numbers[0], numbers[0], numbers[1]])
    low = _placed(size, shape)
    if at is not None:
        x, y, z = (float(n) for n in at.groups())
        low = np.array([x - 0.5 * size[0], y - 0.5 * size[1], z - size[2]])
    else:
        middle = low + 0.5 * size
        where = f"centre X{middle[0]:g} Y{middle[1]:g}, top Z{shape.top.z_mm:g}"
        notes.assume(
            "stock", where, f"--stock has no position: centred over the cutting motions, top {shape.top.reason}"
        )
    table = DraftTable(name="stock", comments=[f"given: {text}"])
    high = low + size
    if box:
        table.add("box_mm", {"min": low.tolist(), "max": high.tolist()})
    else:
        centre = (low + 0.5 * size)[:2].tolist()
        table.add(
            "cylinder_mm", {"centre": centre, "diameter": numbers[0], "min": float(low[2]), "max": float(high[2])}
        )
    return StockBox(low_mm=low, high_mm=high, table=table)


def _mesh(file: Path, folder: Path) -> StockBox:
    low, high = load_mesh(file, unit="mm", scale=1.0, offset_mm=(0.0, 0.0, 0.0)).box_mm
    table = DraftTable(name="stock")
    table.add("stl", _relative(file, folder))
    return StockBox(low_mm=np.array(low), high_mm=np.array(high), table=table)


def _relative(file: Path, folder: Path) -> str:
    import os

    return Path(os.path.relpath(file, folder)).as_posix()


def _check(box: StockBox, feed: Feed, notes: Notes) -> None:
    """Warns of a stock that the cutting motions miss, or go far below."""
    side = feed.only(feed.sideways) if feed.sideways.any() else feed
    low, high = side.low_mm.min(axis=0), side.high_mm.max(axis=0)
    missed = (high < box.low_mm) | (low > box.high_mm)
    apart = [axis for axis, miss in zip("XYZ", missed.tolist(), strict=True) if miss]
    if apart:
        notes.warnings.append(
            f"the cutting motions miss the stock along {' and '.join(apart)}: stock "
            f"{_range(box.low_mm, box.high_mm)}, motions {_range(low, high)}; check its position and the units"
        )


def _range(low: FloatArray, high: FloatArray) -> str:
    return ", ".join(f"{axis} {a:.4g} to {b:.4g}" for axis, a, b in zip("XYZ", low, high, strict=True))
