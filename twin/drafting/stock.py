"""The stock of a draft: as requested, as the program's comments state it, or around the cutting motions."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from twin.arrays import FloatArray
from twin.drafting.cuts import Feed
from twin.drafting.notes import Notes
from twin.drafting.stock_posts import StockStatement
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
_EXPECTED = "'box X Y Z', 'cylinder D H', either with 'at X Y Z' (centre in X and Y, top in Z), or an STL file"
_N = r"[-+]?(?:\d+\.?\d*|\.\d+)"
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
    that is the top. Otherwise it is the highest level plus one step-down, or the highest point of the path; material
    can in no case be above the height from which all plunges begin.
    """
    side = feed.only(feed.sideways)
    if not len(side.tool):
        lowest = float(feed.low_mm[:, 2].min())
        starts = float(feed.start_mm[feed.first, 2].min()) if feed.first.any() else lowest
        return Top(z_mm=0.0, reason="at Z0") if lowest < 0.0 <= starts else Top(z_mm=starts, reason="at the first plunge")
    middle = 0.5 * (side.low_mm[:, 2] + side.high_mm[:, 2])
    total = float(side.length_mm.sum())
    plunges_mm = float(feed.start_mm[feed.first, 2].max()) if feed.first.any() else np.inf
    above = float(side.length_mm[middle > _SAME_MM].sum()) / total
    levels = _levels(side, total)
    if above <= _ABOVE_SHARE and plunges_mm >= -_SAME_MM:
        if levels and abs(levels[0]) < _SAME_MM:
            return _over_level(levels, plunges_mm)
        return Top(z_mm=0.0, reason="at Z0: no more than entries and lead-outs are above it")
    body = side.only(~_entries(side))
    highest = float((body if len(body.tool) else side).high_mm[:, 2].max())
    if levels and levels[0] >= highest - _SAME_MM - (levels[0] - levels[1] if len(levels) > 1 else _ABOVE_LEVEL_MM):
        return _over_level(levels, plunges_mm)
    return Top(z_mm=min(highest, plunges_mm), reason="at the highest point of the cutting motions")


def _over_level(levels: list[float], plunges_mm: float) -> Top:
    """A step-down above the highest level, at most where plunges begin."""
    step = levels[0] - levels[1] if len(levels) > 1 else _ABOVE_LEVEL_MM
    room = plunges_mm - levels[0]
    step = min(step, room) if room > _SAME_MM else step
    what = "one step-down" if len(levels) > 1 else f"{step:.3g} mm"
    return Top(z_mm=levels[0] + step, reason=f"{what} above the highest level, Z{levels[0]:.4g}")


def _levels(side: Feed, total_mm: float) -> list[float]:
    """Heights at which a good part of the path is level, from the top."""
    heights = np.round(side.low_mm[side.level, 2], 3)
    lengths = side.length_mm[side.level]
    found, at = np.unique(heights, return_inverse=True)
    sums = np.bincount(at, weights=lengths, minlength=len(found))
    share = _LEVEL_SHARE if len(found) < 1.0 / _LEVEL_SHARE else 0.5 / len(found)
    return [float(z) for z, length in zip(found[::-1], sums[::-1], strict=True) if length >= share * total_mm]


def _entries(side: Feed) -> np.ndarray[Any, np.dtype[np.bool_]]:
    """Motions that go down or up: ramps, helices, lead-ins and lead-outs; of a 3D path, its slopes too."""
    return side.first | (~side.level & (side.length_mm < 1.0))


def stock_of(
    feed: Feed,
    radius_mm: Mapping[int, float],
    stated: StockStatement | None,
    requested: str | None,
    margin_mm: float,
    notes: Notes,
    folder: Path,
) -> StockBox:
    """The stock of a job.

    Args:
        feed: the feed motions of the program, at least one.
        radius_mm: largest radius of each tool.
        stated: what the program's comments state.
        requested: the option, see `DraftSettings.stock`; it counts first.
        margin_mm: stock around the cutting motions.
        notes: takes assumptions and warnings.
        folder: of the job file, to which the name of an STL file is relative there.

    Raises:
        StockError: a request that cannot be read.
        MeshError: an STL file that cannot be used.
    """
    top = top_of_cut(feed)
    if requested is not None:
        box = _requested(requested, feed, radius_mm, top, notes, folder)
    elif stated is not None:
        box = _stated(stated, feed, radius_mm, top, notes)
    else:
        box = _around(feed, radius_mm, top, margin_mm, notes)
    _check(box, feed, notes)
    return box


def cut_box(feed: Feed, radius_mm: Mapping[int, float], top_mm: float) -> tuple[FloatArray, FloatArray]:
    """The box of the motions below the top, grown sideways by the tools' radii; its lower and upper corner."""
    below = feed.low_mm[:, 2] < top_mm - _SAME_MM
    part = feed.only(below) if below.any() else feed
    radii = np.array([radius_mm.get(tool, 0.0) for tool in part.tool.tolist()])
    grow = np.stack([radii, radii, np.zeros(len(radii))], axis=1)
    low, high = (part.low_mm - grow).min(axis=0), (part.high_mm + grow).max(axis=0)
    return low, np.array([high[0], high[1], top_mm])


def _around(feed: Feed, radius_mm: Mapping[int, float], top: Top, margin_mm: float, notes: Notes) -> StockBox:
    low, high = cut_box(feed, radius_mm, top.z_mm)
    side = np.array([margin_mm, margin_mm, 0.0])
    low, high = low - side, high + side
    low[2] = min(low[2], top.z_mm - 0.1) - max(margin_mm, _FLOOR_MM)
    grown = "grown by the tool radius" + (f" and {margin_mm:g} mm" if margin_mm else "")
    reason = f"the cutting motions, {grown}; top {top.reason}; {max(margin_mm, _FLOOR_MM):g} mm below the lowest cut"
    return _box(low, high, reason, notes)


def _box(low: FloatArray, high: FloatArray, reason: str, notes: Notes) -> StockBox:
    low, high = np.floor(low * 1000.0 + 1e-6) / 1000.0, np.ceil(high * 1000.0 - 1e-6) / 1000.0
    words = ", ".join(f"{axis} {a:g} to {b:g}" for axis, a, b in zip("XYZ", low, high, strict=True))
    notes.assume("stock", f"box {words}", reason)
    table = DraftTable(name="stock", comments=[f"assumed: {reason}"])
    table.add("box_mm", {"min": low.tolist(), "max": high.tolist()})
    return StockBox(low_mm=low, high_mm=high, table=table)


def _stated(
    stated: StockStatement, feed: Feed, radius_mm: Mapping[int, float], top: Top, notes: Notes
) -> StockBox:
    """The box that a comment states, placed as it states, else over the cutting motions."""
    size = np.array(stated.size_mm)
    given = [value is not None for value in stated.low_mm]
    low = _placed(size, feed, radius_mm, top)
    low = np.array([float(a) if a is not None else b for a, b in zip(stated.low_mm, low.tolist(), strict=True)])
    table = DraftTable(name="stock", comments=[f"size stated in line {stated.line} of the program"])
    if not all(given):
        axes = " and ".join(axis for axis, known in zip("XYZ", given, strict=True) if not known)
        reason = f"line {stated.line} states the size only; centred over the cutting motions, top {top.reason}"
        words = ", ".join(f"{axis} from {a:g}" for axis, a, known in zip("XYZ", low, given, strict=True) if not known)
        notes.assume("stock", f"position {words}", reason)
        table.comments.append(f"assumed: position along {axes}: {reason}")
    table.add("box_mm", {"min": low.tolist(), "max": (low + size).tolist()})
    return StockBox(low_mm=low, high_mm=low + size, table=table)


def _placed(size: FloatArray, feed: Feed, radius_mm: Mapping[int, float], top: Top) -> FloatArray:
    """Lower corner of a box that is centred over the cutting motions, its top where cutting begins."""
    low, high = cut_box(feed, radius_mm, top.z_mm)
    middle = 0.5 * (low + high)
    corner: FloatArray = np.array([middle[0] - 0.5 * size[0], middle[1] - 0.5 * size[1], top.z_mm - size[2]])
    return np.round(corner, 3)


def _requested(
    text: str, feed: Feed, radius_mm: Mapping[int, float], top: Top, notes: Notes, folder: Path
) -> StockBox:
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
    low = _placed(size, feed, radius_mm, top)
    if at is not None:
        x, y, z = (float(n) for n in at.groups())
        low = np.array([x - 0.5 * size[0], y - 0.5 * size[1], z - size[2]])
    else:
        middle = low + 0.5 * size
        where = f"centre X{middle[0]:g} Y{middle[1]:g}, top Z{top.z_mm:g}"
        notes.assume("stock", where, f"--stock has no position: centred over the cutting motions, top {top.reason}")
    table = DraftTable(name="stock", comments=[f"given: {text}"])
    high = low + size
    if box:
        table.add("box_mm", {"min": low.tolist(), "max": high.tolist()})
    else:
        centre = (low + 0.5 * size)[:2].tolist()
        table.add("cylinder_mm", {"centre": centre, "diameter": numbers[0], "min": float(low[2]), "max": float(high[2])})
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
    apart = [a for a, l, h, bl, bh in zip("XYZ", low, high, box.low_mm, box.high_mm, strict=True) if h < bl or l > bh]
    if apart:
        notes.warnings.append(
            f"the cutting motions miss the stock along {' and '.join(apart)}: stock "
            f"{_range(box.low_mm, box.high_mm)}, motions {_range(low, high)}; check its position and the units"
        )


def _range(low: FloatArray, high: FloatArray) -> str:
    return ", ".join(f"{axis} {a:.4g} to {b:.4g}" for axis, a, b in zip("XYZ", low, high, strict=True))
