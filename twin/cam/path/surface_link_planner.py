"""Links over a part's surface, by dropping the tool on its triangles: see `twin.cam.path.linking.LinkPlanner`."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace

import numpy as np

from twin.arrays import FloatArray
from twin.cam.surface.drop_cutter import DropCutter
from twin.cam.surface.surface import Surface
from twin.tools.shape import ToolShape

#: Distance of the points that are checked along a link, in parts of the tool's radius.
_STEP = 0.0125
#: A tip this much below the lowest free one counts as free, mm: slices and chords are not exact.
_SLACK_MM = 0.01


class SurfaceLinkPlanner:
    """Links over a surface.

    Args:
        surface: makes the part's surface, when a link is first needed.
        tool: the tool.
        allowance_mm: to be left on the part.
        remaining_mm: rest material of the operations before; None where it may be all of the stock.
        floor_mm: lowest tip.
        top_mm: the stock's top.
    """

    def __init__(
        self,
        surface: Callable[[], Surface],
        tool: ToolShape,
        *,
        allowance_mm: float,
        remaining_mm: float | None,
        floor_mm: float,
        top_mm: float,
    ) -> None:
        self._make, self._tool = surface, tool
        self._surface: Surface | None = None
        self._allowance, self._remaining = allowance_mm, remaining_mm
        self._floor, self._top = floor_mm, top_mm
        self._step = _STEP * tool.max_radius_mm
        self._cutters: dict[float, DropCutter] = {}

    def lowest_mm(self, xy_mm: FloatArray, left_mm: float) -> FloatArray:
        """Lowest tips over plan points, shape (n, 2), that leave this much on the part, shape (n,)."""
        if self._surface is None:
            self._surface = self._make()
        if left_mm not in self._cutters:
            tool = replace(
                self._tool,
                corner_radius_mm=self._tool.corner_radius_mm + left_mm,
                height_mm=self._tool.height_mm + left_mm,
            )
            self._cutters[left_mm] = DropCutter(self._surface, tool, floor_mm=self._floor - left_mm)
        heights: FloatArray = self._cutters[left_mm].drop(xy_mm) + left_mm
        return heights

    def between(self, start_mm: FloatArray, end_mm: FloatArray) -> FloatArray:
        """Straight in the plan, over the surface; never lower than the highest of three neighbouring points."""
        xy = _along(start_mm[:2], end_mm[:2], self._step)
        z = self.lowest_mm(xy, self._allowance)
        z = np.max([z, np.append(z[1:], z[-1]), np.append(z[0], z[:-1])], axis=0)
        line = np.vstack((start_mm, np.column_stack((xy, z)), end_mm))
        kept: FloatArray = line[np.concatenate(([True], np.any(np.diff(line, axis=0) != 0.0, axis=1)))]
        return kept

    def free(self, points_mm: FloatArray) -> bool:
        """Whether all tips are above the surface."""
        return bool(np.all(points_mm[:, 2] >= self.lowest_mm(points_mm[:, :2], self._allowance) - _SLACK_MM))

    def clear_z_mm(self, start_mm: FloatArray, end_mm: FloatArray) -> float:
        """Height above which there is only air: over the rest material where that is known, else the stock's top."""
        if self._remaining is None:
            return self._top
        xy = _along(start_mm[:2], end_mm[:2], 4.0 * self._step)
        return min(self._top, float(self.lowest_mm(xy, self._remaining + self._allowance).max()))


def _along(start: FloatArray, end: FloatArray, step: float) -> FloatArray:
    count = max(1, math.ceil(float(np.linalg.norm(end - start)) / step))
    return start + (end - start) * (np.arange(count + 1) / count)[:, None]
