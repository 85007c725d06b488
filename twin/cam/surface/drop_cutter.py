"""Exact drop-cutter: the height at which a tool lowered along its axis touches a triangle surface.

Flat, ball, bull and taper tools, on faces, edges and vertices. `drop_cutter_kernels.py` has the method.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import partial

import numpy as np
from numpy.typing import ArrayLike, NDArray

from twin.arrays import FloatArray
from twin.cam.surface import drop_cutter_kernels as kernels
from twin.cam.surface.surface import Surface, surface_of
from twin.errors import ToolError
from twin.geometry.threads import in_parts, run_all
from twin.tools.meridian import Meridian
from twin.tools.shape import ToolShape
from twin.tools.text import parse_tool

#: Parts of the elements that are listed in parallel.
_LIST_PARTS = 4
#: Cells of the grid for each face, and the most there may be.
_CELLS_A_FACE = 1.0
_MOST_CELLS = 4_000_000
#: Entries of the cells' lists above which the cells are made larger.
_MOST_ENTRIES = 60_000_000

FACE, EDGE, VERTEX, FLOOR = 0, 1, 2, 3
#: A tool without a body: it touches at its tip alone.
_NEEDLE = Meridian(0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0)


@dataclass(frozen=True, slots=True, eq=False)
class Contacts:
    """Where a dropped tool touches.

    Attributes:
        z_mm: shape (m,), height of the tool tip.
        kind: shape (m,), FACE, EDGE, VERTEX or FLOOR.
        points_mm: shape (m, 3), the contact, NaN on the floor.
        normals: shape (m, 3), unit normal of the part there, pointing towards the tool; (0, 0, 1) on the floor.
    """

    z_mm: FloatArray
    kind: NDArray[np.int8]
    points_mm: FloatArray
    normals: FloatArray


class DropCutter:
    """A tool over a surface, ready to be dropped anywhere.

    Args:
        triangles: the surface, or loose triangles, shape (n, 3, 3), mm.
        tool: a shape, or text as ``ball D8`` or ``bull D10 rc1``; None for a needle, which gives the surface's height.
        floor_mm: tip height where nothing is hit, and the least height given; the surface's lowest z if not given.
        threads: how many work, None for all cores; heights do not depend on it.

    Raises:
        MeshError: triangles that `surface_of` refuses.
        ToolError: text that does not name a tool.
    """

    def __init__(
        self,
        triangles: ArrayLike | Surface,
        tool: ToolShape | str | None,
        *,
        floor_mm: float | None = None,
        threads: int | None = None,
    ) -> None:
        self.surface = triangles if isinstance(triangles, Surface) else surface_of(triangles, threads=threads)
        shape = parse_tool(tool) if isinstance(tool, str) else tool
        self.tool = shape
        self.floor_mm = float(self.surface.low_mm[2]) if floor_mm is None else float(floor_mm)
        if math.isnan(self.floor_mm):
            raise ToolError("drop-cutter: floor_mm is not a number; expected a height, or -inf for none")
        self._threads = threads
        meridian = _NEEDLE if shape is None else shape.meridian
        elements = _elements(self.surface, meridian)
        grid, lists = self._listed(elements, meridian)
        self._cutter = kernels.Cutter(meridian, self.floor_mm, elements, grid, lists)

    def drop(self, points_mm: ArrayLike, threads: int | None = None) -> FloatArray:
        """Height of the tool tip over plan points.

        Args:
            points_mm: shape (m, 2).

        Returns:
            shape (m,).
        """
        return self._dropped(_plan_points(points_mm), threads)[0]

    def contacts(self, points_mm: ArrayLike, threads: int | None = None) -> Contacts:
        """Heights of the tip, and where the tool touches; of several contacts at one height any one is given."""
        points = _plan_points(points_mm)
        heights, touched = self._dropped(points, threads)
        positions = np.empty((len(points), 3))
        kernels.contacts(self._cutter, points, touched, positions)
        elements = self._cutter.elements
        bounds = np.cumsum([len(elements.faces), len(elements.edges)])
        kind = np.where(touched < 0, FLOOR, np.searchsorted(bounds, touched, side="right")).astype(np.int8)
        normals = self._normals(points, heights, positions, touched)
        return Contacts(heights, kind, positions, normals)

    def _normals(
        self, points: FloatArray, heights: FloatArray, positions: FloatArray, touched: NDArray[np.int32]
    ) -> FloatArray:
        """Normals of the tool where it touches: the face's own, or that of the meridian at the contact."""
        normals = np.tile(np.array([0.0, 0.0, 1.0]), (len(points), 1))
        faces = len(self._cutter.elements.faces)
        on_face = (touched >= 0) & (touched < faces)
        normals[on_face] = self.surface.normals[touched[on_face]]
        rest = np.flatnonzero(touched >= faces)
        if self.tool is None or len(rest) == 0:
            return normals
        across = points[rest] - positions[rest, :2]
        rho = np.hypot(across[:, 0], across[:, 1])
        kappa = self.tool.kappa_rad(positions[rest, 2] - heights[rest])
        kappa = np.where(rho <= self.tool.disc_mm * (1.0 - 1e-12), 0.0, kappa)
        unit = across / np.maximum(rho, 1e-300)[:, None]
        normals[rest] = np.column_stack((unit * np.sin(kappa)[:, None], np.cos(kappa)))
        return normals

    def _dropped(self, points: FloatArray, threads: int | None) -> tuple[FloatArray, NDArray[np.int32]]:
        heights = np.empty(len(points))
        touched = np.empty(len(points), dtype=np.int32)
        in_parts(
            lambda first, last: kernels.drop(self._cutter, points, first, last, heights, touched),
            len(points),
            threads=self._threads if threads is None else threads,
        )
        return heights, touched

    def _listed(self, elements: kernels.Elements, tool: Meridian) -> tuple[kernels.Grid, kernels.Lists]:
        """The grid of patches; cells are made larger while their lists would be too long."""
        low, high = self.surface.low_mm - tool.radius, self.surface.high_mm + tool.radius
        extent = np.maximum(high[:2] - low[:2], 1e-3)
        wanted = min(_MOST_CELLS, max(16.0, _CELLS_A_FACE * len(elements.faces)))
        size = math.sqrt(float(extent[0] * extent[1]) / wanted)
        while True:
            size = max(size, float(extent.max()) / _MOST_CELLS)
            columns, rows = (int(n) for n in np.ceil(extent / size) + 1)
            grid = kernels.Grid(float(low[0]), float(low[1]), size, columns, rows)
            counts = np.zeros((_LIST_PARTS, columns * rows), dtype=np.int64)
            self._list(elements, tool, grid, counts)
            if counts.sum() <= _MOST_ENTRIES or columns * rows < 64:
                break
            size *= 2.0
        ends = np.cumsum(counts.T.ravel()).reshape(-1, _LIST_PARTS)
        begins = np.concatenate(([0], ends[:, -1]))
        entries = np.empty(int(begins[-1]), dtype=np.int32)
        self._list(elements, tool, grid, np.ascontiguousarray(ends.T - counts), entries)
        return grid, kernels.Lists(begins, entries)

    def _list(
        self,
        elements: kernels.Elements,
        tool: Meridian,
        grid: kernels.Grid,
        counts: NDArray[np.int64],
        entries: NDArray[np.int32] | None = None,
    ) -> None:
        """Count elements in cells, or enter them, in parallel parts."""
        into = np.empty(0, dtype=np.int32) if entries is None else entries
        listings = [kernels.Listing(entries is not None, counts[part], into) for part in range(_LIST_PARTS)]
        run_all(
            [partial(self._list_part, elements, tool, grid, part, own) for part, own in enumerate(listings)],
            self._threads,
        )

    def _list_part(
        self,
        elements: kernels.Elements,
        tool: Meridian,
        grid: kernels.Grid,
        part: int,
        listing: kernels.Listing,
    ) -> None:
        surface = self.surface
        (f0, f1), (e0, e1), (v0, v1) = [
            (n * part // _LIST_PARTS, n * (part + 1) // _LIST_PARTS)
            for n in (len(elements.faces), len(elements.edges), len(elements.vertices))
        ]
        kernels.list_faces(elements, f0, f1, grid, listing)
        if self.tool is not None:
            kernels.list_edges(elements, surface.edge_cones_rad, e0, e1, tool, grid, listing)
            kernels.list_vertices(elements, surface.vertex_cones, v0, v1, tool, grid, listing)


def _elements(surface: Surface, tool: Meridian) -> kernels.Elements:
    """The parts of a surface that the tool can touch, as kernels take them."""
    faces = np.empty((len(surface.triangles), kernels.FACE_COLUMNS))
    edges = np.empty((len(surface.ends), kernels.EDGE_COLUMNS))
    kernels.face_patches(surface.vertices_mm, surface.triangles, surface.normals, tool, faces)
    kernels.edge_patches(surface.vertices_mm, surface.ends, edges)
    return kernels.Elements(faces, edges, surface.vertices_mm, surface.triangles)


def _plan_points(points_mm: ArrayLike) -> FloatArray:
    points = np.ascontiguousarray(points_mm, dtype=np.float64)
    if points.ndim != 2 or points.shape[1] != 2:
        raise ValueError(f"points_mm must have shape (m, 2), got {points.shape}")
    return points
