"""Comments against motions: a diameter, a depth or a kind that the path contradicts."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from twin.arrays import FloatArray
from twin.drafting.cuts import Cuts, Feed
from twin.drafting.notes import Notes
from twin.drafting.tools import MILLS, DraftTool

_INCH_MM = 25.4
#: Depth that a comment states against that of the path, mm.
_DEPTH_MM = 0.02
#: Diameters above this, or above this many times the path's extent, are doubtful.
_LARGEST_MM, _OF_EXTENT = 160.0, 4.0
#: Chip per tooth above this part of the diameter is doubtful.
_CHIP_PART = 0.125
#: Passes that are counted as parallel, and the number of equal stepovers that makes a pattern.
_LONG_DIAMETERS, _EQUAL, _PATTERN = 3.0, 0.01, 4
#: A contour runs along this part of the sides of the box around the path, and sweeps less than this part of its area.
_OF_SIDES, _OF_AREA = 0.55, 0.6


def doubts(cuts: Cuts, tools: Sequence[DraftTool], top_mm: float, notes: Notes) -> None:
    """Note where the comments and the motions of a program contradict each other.

    Args:
        top_mm: top of the stock.
    """
    for tool in tools:
        feed = cuts.feed.only(cuts.feed.tool == tool.number)
        below = feed.only(feed.low_mm[:, 2] < top_mm)
        for problem in (
            *_size(tool, feed),
            *_depth(tool, feed),
            *_kind(tool, feed),
            *_stepover(tool, below),
            *_chip(tool, below),
        ):
            notes.warnings.append(f"T{tool.number}: {problem}")


def outside_contours(cuts: Cuts, tools: Sequence[DraftTool], low_mm: FloatArray, high_mm: FloatArray) -> Iterator[str]:
    """Contours that may go around a part: in an assumed box of stock, which extends to their far side, they cut slots.

    Args:
        low_mm, high_mm: corners of the box.
    """
    size = (high_mm - low_mm)[:2]
    for tool in tools:
        feed = cuts.feed.only((cuts.feed.tool == tool.number) & cuts.feed.level & cuts.feed.sideways)
        feed = feed.only(feed.low_mm[:, 2] < high_mm[2])
        if tool.kind not in MILLS or not len(feed.tool):
            continue
        level = feed.only(feed.low_mm[:, 2] < feed.low_mm[:, 2].min() + _DEPTH_MM)
        radius = 0.5 * tool.diameter_mm
        low, high = (
            np.abs(level.low_mm[:, :2] - low_mm[:2] - radius),
            np.abs(high_mm[:2] - radius - level.high_mm[:, :2]),
        )
        along = (level.high_mm - level.low_mm)[:, 1::-1]
        thin = (level.high_mm - level.low_mm)[:, :2] < _DEPTH_MM
        run = float(along[thin & (np.minimum(low, high) < _DEPTH_MM)].sum())
        swept = float(level.length_mm.sum()) * tool.diameter_mm
        if run > _OF_SIDES * 2.0 * float(size.sum()) and swept < _OF_AREA * float(size.prod()):
            yield (
                f"T{tool.number} runs along the sides of the assumed stock only: if that is the outside of the part, a "
                "blank is smaller than this box, and the tool cuts less than the full slot here; give --stock"
            )


def _size(tool: DraftTool, feed: Feed) -> Iterator[str]:
    """A tool larger than its work is usually one in the wrong unit."""
    if not tool.known:
        return
    extent = float((feed.high_mm - feed.low_mm)[:, :2].max(initial=0.0))
    extent = max(extent, float((feed.high_mm.max(axis=0) - feed.low_mm.min(axis=0))[:2].max()))
    if tool.diameter_mm > _LARGEST_MM or (extent > 0.0 and tool.diameter_mm > max(_OF_EXTENT * extent, 25.0)):
        in_mm = tool.diameter_mm / _INCH_MM
        hint = f"; D{in_mm:g} mm if its comment is in mm" if 0.1 < in_mm < _LARGEST_MM else ""
        yield f"D{tool.diameter_mm:g} mm is large for a path of {extent:.4g} mm: check the unit of its comment{hint}"


def _depth(tool: DraftTool, feed: Feed) -> Iterator[str]:
    """The lowest Z in the comment of a post against that of the path."""
    stated = tool.states.z_min_mm
    lowest = float(feed.low_mm[:, 2].min())
    if stated is not None and abs(stated - lowest) > _DEPTH_MM:
        yield (
            f"its comment states a lowest Z of {stated:.4g} mm, the program goes to {lowest:.4g} mm: the comment may "
            "be that of another program, or in another unit"
        )


def _kind(tool: DraftTool, feed: Feed) -> Iterator[str]:
    """Taps do not mill, and mills do not tap."""
    if feed.tapping.any() and tool.kind in MILLS and tool.states.kind is not None:
        yield f"its comment names a {tool.kind}, and line {int(feed.line[feed.tapping][0])} taps a thread"
    if tool.kind in ("drill", "tap", "reamer", "spot drill"):
        side = feed.only(feed.sideways)
        if float(side.length_mm.sum()) > 0.5 * float(feed.length_mm.sum()):
            yield f"its comment names a {tool.kind}, and line {int(side.line[0])} moves it sideways"


def _stepover(tool: DraftTool, feed: Feed) -> Iterator[str]:
    """Parallel passes at one height with equal stepovers above the diameter would leave ridges."""
    if not tool.known or tool.kind not in MILLS:
        return
    straight = feed.only(feed.level & ~feed.arc & (feed.length_mm > _LONG_DIAMETERS * tool.diameter_mm))
    for along in (0, 1):
        across = 1 - along
        part = straight.only(np.abs(straight.end_mm - straight.start_mm)[:, across] < 1e-6)
        for height in np.unique(np.round(part.low_mm[:, 2], 3)).tolist():
            offsets = np.unique(np.round(part.low_mm[np.abs(part.low_mm[:, 2] - height) < 2e-3, across], 4))
            stepover = _common(np.diff(offsets))
            if stepover is not None and stepover > tool.diameter_mm * (1.0 + _EQUAL):
                yield (
                    f"passes at Z{height:g} are {stepover:.4g} mm apart, more than D{tool.diameter_mm:g} mm: ridges "
                    "remain between them, or the comment has the wrong diameter"
                )
                return


def _common(steps: FloatArray) -> float | None:
    """The step of a pattern: at least `_PATTERN` steps, nearly all of them equal."""
    if len(steps) < _PATTERN:
        return None
    middle = float(np.median(steps))
    same = np.abs(steps - middle) < _EQUAL * middle
    return middle if same.sum() >= max(_PATTERN, 0.8 * len(steps)) else None


def _chip(tool: DraftTool, feed: Feed) -> Iterator[str]:
    """Feed per tooth against the diameter, with the flutes as stated, or two."""
    if not tool.cuts or not len(feed.tool):
        return
    turning = feed.only((feed.spindle_rpm > 0.0) & ~feed.tapping)
    if not len(turning.tool):
        return
    teeth = tool.states.teeth or 2
    chips = turning.feed_mm_min / turning.spindle_rpm / teeth
    worst = int(np.argmax(chips))
    if chips[worst] > _CHIP_PART * tool.diameter_mm:
        yield (
            f"line {int(turning.line[worst])}: a feed per tooth of {chips[worst]:.3g} mm "
            f"(F{turning.feed_mm_min[worst]:g} mm/min, S{turning.spindle_rpm[worst]:g}) is absurd for "
            f"D{tool.diameter_mm:g} mm: check F, S and the diameter; forces from it mean nothing"
        )
