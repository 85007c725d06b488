"""The largest ball that leaves no uncut material on a part."""

from __future__ import annotations

import math
from collections.abc import Callable

from twin.cam.reach.tool_reach import Reach, tool_reach
from twin.cam.slices.sections import SlicedPart
from twin.cam.slices.structuring_element import StructuringElement
from twin.errors import ToolError

#: The radius is found to this part of itself.
_SHARE = 0.01
#: Radii below this many pitches cannot be distinguished from noise.
_LEAST_PITCHES = 5.0


def largest_ball_mm(
    part: SlicedPart,
    *,
    thin_mm: float | None = None,
    threads: int | None = None,
    report: Callable[[float, Reach], None] | None = None,
) -> float | None:
    """Radius of the largest ball that leaves nothing that the slices can resolve, by bisection.

    Args:
        thin_mm: least thickness that counts, see `twin.cam.reach.tool_reach.tool_reach`.
        report: called with every radius that was tried and the material left by the ball.

    Returns:
        mm, to 1 %, never above half the part's smallest side; None where even a ball of five slice pitches leaves
        material, as in a sharp inner edge.

    Raises:
        ToolError: slices too far apart for any ball.
    """
    low = _LEAST_PITCHES * float(part.slices.pitch_mm.max())
    high = 0.5 * float((part.slices.high_mm - part.slices.low_mm).min())
    if low >= high:
        raise ToolError(
            f"slice pitch {low / _LEAST_PITCHES:g} mm; expected below {high / _LEAST_PITCHES:g} for a search"
        )

    def finishes(radius: float) -> bool:
        reach = tool_reach(part, StructuringElement.ball(radius), thin_mm=thin_mm, threads=threads)
        if report is not None:
            report(radius, reach)
        return not reach.uncut_regions

    if not finishes(low):
        return None
    if finishes(high):
        return high
    while high > low * (1.0 + _SHARE):
        middle = math.sqrt(low * high)
        low, high = (middle, high) if finishes(middle) else (low, middle)
    return low
