"""Rest material: where the next tool must and may cut, level by level, and at which points.

A tool dropped on the part has its tip at p(x, y) at the lowest; dropped on the stock, at s(x, y). At a
level z the tool at (x, y) does not gouge where p + allowance <= z, and cuts something where s > z. Positions
with both are those to machine: nowhere does the tool cut air, and nothing that it can reach at that level is missed.
The tool's whole underside counts, so that material next to it on a wall is found as well as that below its tip.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy import ndimage

from twin.arrays import FloatArray
from twin.cam.stock import dexel_kernels as kernels
from twin.cam.stock.dexel import Dexels
from twin.cam.surface.drop_cutter import DropCutter
from twin.cam.surface.surface import Surface
from twin.errors import ToolError
from twin.geometry.threads import in_parts
from twin.tools.shape import ToolShape

#: Thinner material above a tool is ignored, mm.
LEAST_MM = 0.02


@dataclass(frozen=True, slots=True, eq=False)
class LevelRest:
    """Rest material of a tool at one level.

    Attributes:
        z_mm: height of the tool tip.
        regions: shape (nx, ny), number of the connected region of tool positions that each dexel lies in, 0 for none.
        points_mm: shape (m, 3), thinned tool positions that cover the regions, region by region, rims first.
        point_regions: shape (m,), the region of each.
    """

    z_mm: float
    regions: NDArray[np.int32]
    points_mm: FloatArray
    point_regions: NDArray[np.int32]

    @property
    def region_count(self) -> int:
        """How many separate regions there are."""
        return int(self.regions.max(initial=0))


class RestMaterial:
    """Stock, part and the next tool, for queries level by level.

    Args:
        stock: after the tools before.
        part: the part's surface.
        tool: the next tool.
        allowance_mm: material to leave on the part, along its normals.
        least_mm: material thinner than this, measured along z, is not cut.
        threads: how many work, None for all cores; results do not depend on it.

    Raises:
        ToolError: an allowance below 0.
    """

    def __init__(
        self,
        stock: Dexels,
        part: Surface,
        tool: ToolShape,
        *,
        allowance_mm: float = 0.0,
        least_mm: float = LEAST_MM,
        threads: int | None = None,
    ) -> None:
        self.stock, self.tool, self.least_mm = stock, tool, least_mm
        points = stock.points_mm
        self.part_tip_mm = allowed_heights(part, tool, points, allowance_mm, threads).reshape(stock.heights_mm.shape)
        self.stock_tip_mm = stock_heights(stock, tool, points, threads).reshape(stock.heights_mm.shape)

    @property
    def depth_mm(self) -> FloatArray:
        """How far down the tool can cut at each dexel, shape (nx, ny); 0 where it cuts nothing."""
        return np.maximum(self.stock_tip_mm - self.part_tip_mm - self.least_mm, 0.0)

    def level(self, z_mm: float, spacing_mm: float | None = None) -> LevelRest:
        """Positions of the tool at a level where it cuts and does not gouge, and points that cover them.

        Args:
            spacing_mm: least distance of points, and largest from any position to the next point; half the
                tool's diameter if not given. `spacing_for_cusp` gives one for a cusp height.
        """
        spacing = self.tool.nominal_radius_mm if spacing_mm is None else spacing_mm
        if not spacing > 0.0:
            raise ToolError(f"rest material: spacing_mm = {spacing:g}; expected a number above 0")
        positions = (self.part_tip_mm <= z_mm) & (self.stock_tip_mm > z_mm + self.least_mm)
        labels, _ = ndimage.label(positions, structure=np.ones((3, 3), dtype=np.int8))
        rim = positions & ~ndimage.binary_erosion(positions, border_value=1)
        rows, columns = np.nonzero(positions)
        order = np.lexsort((~rim[rows, columns], labels[rows, columns]))
        rows, columns = rows[order], columns[order]
        plan = np.column_stack((self.stock.x_mm[rows], self.stock.y_mm[columns]))
        chosen = np.zeros(len(plan), dtype=np.bool_)
        kernels.thinned(plan, spacing, chosen)
        points = np.column_stack((plan[chosen], np.full(int(chosen.sum()), float(z_mm))))
        return LevelRest(float(z_mm), labels.astype(np.int32), points, labels[rows, columns][chosen].astype(np.int32))

    def levels(self, z_mm: Sequence[float], spacing_mm: float | None = None) -> list[LevelRest]:
        """The same at several levels, those without a position omitted."""
        found = [self.level(z, spacing_mm) for z in z_mm]
        return [rest for rest in found if len(rest.points_mm)]


def remaining(
    stock: Dexels,
    part_tip_mm: FloatArray,
    level_z_mm: float,
    tool: ToolShape,
    *,
    spacing_mm: float | None = None,
    least_mm: float = LEAST_MM,
) -> LevelRest:
    """One level of `RestMaterial` where the heights of the tool over the part are known already.

    Args:
        part_tip_mm: shape (nx, ny), lowest allowed tip height at every dexel, allowance included.
    """
    rest = object.__new__(RestMaterial)
    rest.stock, rest.tool, rest.least_mm = stock, tool, least_mm
    rest.part_tip_mm = part_tip_mm
    rest.stock_tip_mm = stock_heights(stock, tool, stock.points_mm).reshape(stock.heights_mm.shape)
    return rest.level(level_z_mm, spacing_mm)


def allowed_heights(
    part: Surface, tool: ToolShape, points_mm: FloatArray, allowance_mm: float = 0.0, threads: int | None = None
) -> FloatArray:
    """Lowest tip heights that leave an allowance on the part, shape (m,): exact, by dropping the tool grown by it."""
    if not (math.isfinite(allowance_mm) and allowance_mm >= 0.0):
        raise ToolError(f"rest material: allowance_mm = {allowance_mm:g}; expected a number not below 0")
    cutter = DropCutter(part, grown(tool, allowance_mm), floor_mm=-math.inf, threads=threads)
    return cutter.drop(points_mm) + allowance_mm


def grown(tool: ToolShape, by_mm: float) -> ToolShape:
    """The tool with all its surface moved out along the normal, or in where ``by_mm`` is below 0.

    Its tip is lower by as much, or higher. A corner radius smaller than a move inwards becomes a sharp corner.
    """
    if by_mm == 0.0:
        return tool
    corner = tool.corner_radius_mm + by_mm
    return ToolShape(
        disc_mm=tool.disc_mm if corner >= 0.0 else max(tool.disc_mm + corner, 0.0),
        corner_radius_mm=max(corner, 0.0),
        taper_rad=tool.taper_rad,
        height_mm=tool.height_mm + by_mm,
    )


def stock_heights(stock: Dexels, tool: ToolShape, points_mm: FloatArray, threads: int | None = None) -> FloatArray:
    """Tip heights at which a tool coming down touches the stock's first dexel, shape (m,); -inf next to the stock."""
    points = np.ascontiguousarray(points_mm, dtype=np.float64)
    out = np.empty(len(points))
    own, shape = stock.arrays, tool.meridian
    in_parts(lambda a, b: kernels.rest_heights(own, shape, points, a, b, out), len(points), threads=threads)
    return out


def spacing_for_cusp(tool: ToolShape, cusp_mm: float) -> float:
    """Distance from the axis at which the tool's underside is ``cusp_mm`` above its tip.

    Points no farther than this from every position leave cusps no higher on level ground.
    """
    if cusp_mm <= 0.0:
        raise ToolError(f"rest material: cusp_mm = {cusp_mm:g}; expected a number above 0")
    return float(tool.radius_mm(min(cusp_mm, tool.height_mm)))
