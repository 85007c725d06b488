"""The part as a recording shows it, and as moving tools leave it, as heights over a grid."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping

import numpy as np
import pyarrow as pa
from numpy.typing import NDArray

from tests.support.recording import Recording
from twin.record import Step
from twin.sinks.rerun import layout

Heights = NDArray[np.float64]


class Plan:
    """Heights over the nodes of a grid, from ``low`` to ``high`` of one square pitch."""

    def __init__(self, low: tuple[float, float], high: tuple[float, float], pitch: float) -> None:
        self.x, self.y = (np.arange(a + 0.5 * pitch, b, pitch) for a, b in zip(low, high, strict=True))
        self.pitch = pitch

    def near(self, x: tuple[float, float], y: tuple[float, float]) -> tuple[slice, slice]:
        """The nodes within a rectangle."""
        return (
            slice(*np.searchsorted(self.x, x).tolist()),
            slice(*np.searchsorted(self.y, y).tolist()),
        )


def milled(
    plan: Plan, top: float, steps: Iterable[Step], tools: Mapping[int, tuple[str, float]], times: list[float]
) -> list[Heights]:
    """Heights of a block after each of some increasing times, from the definition of milling.

    Args:
        top: of the block.
        tools: kind, flat or ball, and radius of each by number.
    """
    heights = np.full((len(plan.x), len(plan.y)), top)
    found: list[Heights] = []
    for step in steps:
        while len(found) < len(times) and times[len(found)] < step.t_s:
            found.append(heights.copy())
        if step.rapid or step.tool not in tools:
            continue
        kind, radius = tools[step.tool]
        start, end = np.array(step.start_mm), np.array(step.end_mm)
        parts = max(1, math.ceil(math.dist(start, end) / 0.2))
        for k in range(parts + 1):
            if len(found) < len(times) and times[len(found)] < step.t_s + k / parts * step.duration_s:
                found.append(heights.copy())
            x, y, z = start + (end - start) * k / parts
            near = plan.near((x - radius, x + radius), (y - radius, y + radius))
            square = radius**2 - (plan.x[near[0]][:, None] - x) ** 2 - (plan.y[near[1]] - y) ** 2
            below = z if kind == "flat" else z + radius - np.sqrt(np.maximum(square, 0.0))
            heights[near] = np.where(square >= 0.0, np.minimum(heights[near], below), heights[near])
    return found + [heights] * (len(times) - len(found))


class DrawnPart:
    """The meshes of a recording's workpiece, by time."""

    def __init__(self, recording: Recording) -> None:
        self._rows: dict[str, list[tuple[float, NDArray[np.float64], NDArray[np.int64]]]] = {}
        for entity, tables in recording.tables.items():
            if not entity.startswith(layout.WORKPIECE + "/"):
                continue
            rows = self._rows.setdefault(entity, [])
            for table in tables:
                columns = [table.column(layout.TIME).cast(pa.int64())]
                columns += [table.column(f"Mesh3D:{name}") for name in ("vertex_positions", "triangle_indices")]
                for ns, vertices, triangles in zip(*(c.to_pylist() for c in columns), strict=True):
                    if vertices is not None:
                        rows.append((ns * 1e-9, np.array(vertices), np.array(triangles)))
            rows.sort(key=lambda row: row[0])

    @property
    def times(self) -> list[float]:
        """Every time at which something is drawn."""
        return sorted({t for rows in self._rows.values() for t, _, _ in rows})

    def heights(self, plan: Plan, at_s: float) -> Heights:
        """Height of the uppermost surface over each node at the cursor, -inf without one."""
        heights = np.full((len(plan.x), len(plan.y)), -np.inf)
        for rows in self._rows.values():
            shown = [row for row in rows if row[0] <= at_s]
            if shown:
                _, vertices, triangles = shown[-1]
                for corners in vertices[triangles]:
                    raise_to(heights, plan, corners)
        return heights


def raise_to(heights: Heights, plan: Plan, corners: NDArray[np.float64]) -> None:
    """Raise heights to a triangle where it is above them."""
    (ax, ay, az), (bx, by, bz), (cx, cy, cz) = corners.tolist()
    area = (bx - ax) * (cy - ay) - (by - ay) * (cx - ax)
    if area <= 0.0:  # faces down, or is a wall
        return
    near = plan.near((min(ax, bx, cx) - 1e-9, max(ax, bx, cx) + 1e-9), (min(ay, by, cy) - 1e-9, max(ay, by, cy) + 1e-9))
    x, y = plan.x[near[0]][:, None], plan.y[near[1]]
    b = ((x - ax) * (cy - ay) - (y - ay) * (cx - ax)) / area
    c = ((bx - ax) * (y - ay) - (by - ay) * (x - ax)) / area
    inside = (b >= -1e-9) & (c >= -1e-9) & (b + c <= 1.0 + 1e-9)
    z = az + b * (bz - az) + c * (cz - az)
    heights[near] = np.where(inside, np.maximum(heights[near], z), heights[near])
