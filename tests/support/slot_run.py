"""A small run made by formula: a box, a ball-end slot that grows along x, sinusoidal forces. No engine needed."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from twin.arrays import FloatArray, frozen
from twin.record import (
    Collision,
    Engagement,
    ForceSamples,
    NcEvent,
    Record,
    RunHeader,
    RunSummary,
    Step,
    ToolRecord,
    ToolSummary,
    WorkpiecePatch,
)

BOX = np.array([(0.0, 0.0, -20.0), (60.0, 30.0, 0.0)])
RADIUS, DEPTH, MIDDLE = 4.0, 2.0, 15.0
PATCH_MM = 15.0
RPM = 3600.0
FEED_MM_MIN = 600.0


@dataclass(frozen=True, slots=True)
class SlotRun:
    """The run's numbers: steps of ``step_mm`` along the slot, ``per_turn`` samples a revolution."""

    step_mm: float = 0.5
    per_turn: int = 90
    collision: bool = True

    def records(self) -> Iterator[Record]:
        """All records in order."""
        yield self.header()
        for k in range(4):
            yield patch(k, -1.0, 0.0)
        yield NcEvent(t_s=0.0, nc_line=1, kind="tool", text="T1 ball D8 z2")
        yield NcEvent(t_s=0.0, nc_line=2, kind="spindle", text="M3 S3600")
        yield NcEvent(t_s=0.0, nc_line=3, kind="block", text="N30 G0 X-6 Y15 Z-2")
        yield self.rapid(0, 0.0, (-20.0, 15.0, 30.0), (-6.0, 15.0, -2.0), 3)
        yield NcEvent(t_s=0.2, nc_line=4, kind="block", text="N40 G1 X66 F600")
        index, t_s = 1, 0.2
        count = round(72.0 / self.step_mm)
        for i in range(count):
            x = -6.0 + i * self.step_mm
            yield self.cut(index, t_s, x)
            index, t_s = index + 1, 0.2 + (i + 1) * self.step_mm * 60.0 / FEED_MM_MIN
            if (i + 1) % max(1, round(2.0 / self.step_mm)) == 0 and 0.0 <= x <= 60.0:
                yield from (
                    patch(k, x + self.step_mm, t_s) for k in range(4) if k * PATCH_MM <= x < (k + 1) * PATCH_MM + 2.0
                )
        for k in range(4):
            yield patch(k, 60.0, t_s)
        yield NcEvent(t_s=t_s, nc_line=5, kind="block", text="N50 G0 X20 Y22 Z-1")
        if self.collision:
            yield Collision(
                t_s=t_s,
                nc_line=5,
                tool=1,
                kind="rapid",
                point_mm=(60.0, 15.0, -2.0),
                volume_mm3=12.5,
                message="slot.nc:5: T1: rapid motion through the stock, from X60 Y15 Z-2, 12.5 mm3",
            )
        yield self.rapid(index, t_s, (66.0, 15.0, -2.0), (-20.0, 15.0, 30.0), 5)
        yield NcEvent(t_s=t_s + 0.2, nc_line=6, kind="notice", text="M98 has no effect here")
        yield NcEvent(t_s=t_s + 0.2, nc_line=7, kind="stop", text="M30")
        yield self.summary(t_s + 0.2, index + 1)

    def header(self) -> RunHeader:
        arc = np.linspace(0.0, 0.5 * math.pi, 13)
        profile = np.column_stack([RADIUS * np.sin(arc), RADIUS * (1.0 - np.cos(arc))])
        top = [(4.0, 20.0), (4.0, 30.0), (10.0, 30.0), (10.0, 45.0)]
        return RunHeader(
            twin_version="0.0",
            program="slot.nc",
            stock_bounds_mm=frozen(BOX, "stock_bounds_mm", (2, 3)),
            slice_pitch_mm=(0.1, 0.1, 0.1),
            tools=(
                ToolRecord(
                    number=1,
                    description="ball D8 z2",
                    profile_mm=frozen(np.vstack([profile, top]), "profile_mm", (None, 2)),
                ),
            ),
            planned_time_s=0.4 + 72.0 * 60.0 / FEED_MM_MIN,
            parameters={},
        )

    def cut(self, index: int, t_s: float, x: float) -> Step:
        duration = self.step_mm * 60.0 / FEED_MM_MIN
        rate = RPM / 60.0 * self.per_turn
        first, last = math.ceil(t_s * rate - 1e-9), math.ceil((t_s + duration) * rate - 1e-9)
        t = np.arange(first, last) / rate
        angle = 2.0 * math.pi * RPM / 60.0 * t
        cutting = 0.0 <= x < 60.0
        peak = (60.0 + 40.0 * x / 60.0) if cutting else 0.0
        tooth = np.abs(np.sin(angle))
        force = np.column_stack([-0.4 * peak * tooth, peak * tooth**2, -0.25 * peak * tooth])
        return Step(
            index=index,
            t_s=t_s,
            duration_s=duration,
            start_mm=(x, MIDDLE, -DEPTH),
            end_mm=(x + self.step_mm, MIDDLE, -DEPTH),
            nc_line=4,
            tool=1,
            rapid=False,
            feed_mm_min=FEED_MM_MIN,
            spindle_rpm=RPM,
            engagement=Engagement(axial_depth_mm=DEPTH if cutting else 0.0, cutting=cutting),
            samples=ForceSamples(
                t_s=frozen(t, "t_s", (None,)),
                spindle_angle_rad=frozen(angle, "spindle_angle_rad", (None,)),
                force_n=frozen(force, "force_n", (None, 3)),
                torque_nm=frozen(0.002 * peak * tooth, "torque_nm", (None,)),
                power_w=frozen(0.002 * peak * tooth * 2.0 * math.pi * RPM / 60.0, "power_w", (None,)),
            ),
        )

    def rapid(
        self, index: int, t_s: float, start: tuple[float, float, float], end: tuple[float, float, float], line: int
    ) -> Step:
        return Step(
            index=index,
            t_s=t_s,
            duration_s=0.2,
            start_mm=start,
            end_mm=end,
            nc_line=line,
            tool=1,
            rapid=True,
            feed_mm_min=48000.0,
            spindle_rpm=RPM,
            engagement=Engagement(),
            samples=NO_SAMPLES,
        )

    def summary(self, t_s: float, steps: int) -> RunSummary:
        tool = ToolSummary(
            number=1,
            description="ball D8 z2",
            cutting_time_s=6.0,
            air_time_s=1.2,
            rapid_time_s=0.4,
            removed_volume_mm3=590.0,
            peak_force_n=(40.0, 100.0, 25.0, 110.5),
            mean_force_n=(25.0, 50.0, 16.0, 58.1),
            peak_torque_nm=0.2,
            mean_torque_nm=0.1,
            peak_power_w=75.0,
            peak_line=4,
        )
        return RunSummary(
            complete=True,
            machine_time_s=t_s,
            cutting_time_s=6.0,
            removed_volume_mm3=590.0,
            steps=steps,
            samples=0,
            peak_force_n=tool.peak_force_n,
            mean_force_n=tool.mean_force_n,
            collisions=1,
            tools=(tool,),
            top_lines=((4, "N40 G1 X66 F600", 110.5),),
            digest="0" * 16,
        )


NO_SAMPLES = ForceSamples(
    t_s=frozen([], "t_s", (None,)),
    spindle_angle_rad=frozen([], "spindle_angle_rad", (None,)),
    force_n=frozen(np.empty((0, 3)), "force_n", (None, 3)),
    torque_nm=frozen([], "torque_nm", (None,)),
    power_w=frozen([], "power_w", (None,)),
)


def patch(k: int, cut_to: float, t_s: float) -> WorkpiecePatch:
    """Block ``k`` along x, with the slot from its start to ``cut_to``."""
    x0, x1 = k * PATCH_MM, (k + 1) * PATCH_MM
    middle = min(max(cut_to, x0), x1)
    flat = np.array([(0.0, 0.0), (30.0, 0.0)])
    quads: list[FloatArray] = []
    for a, b, profile in ((x0, middle, slot_profile()), (middle, x1, flat)):
        if b > a:
            quads += extruded(a, b, profile)
            quads += wall(a, profile, -1.0) if a == 0.0 else []
            quads += wall(b, profile, 1.0) if b == 60.0 else []
    if x0 < middle < x1:
        quads += slot_end(middle)
    return WorkpiecePatch(t_s=t_s, patch=f"x{k}_y0", **mesh(quads))


def slot_profile() -> FloatArray:
    """Top of the cut box across y, shape (n, 2) of (y, z)."""
    half = math.acos((RADIUS - DEPTH) / RADIUS)
    arc = np.linspace(-half, half, 25)
    groove = np.column_stack([MIDDLE + RADIUS * np.sin(arc), RADIUS - DEPTH - RADIUS * np.cos(arc)])
    return np.vstack([(0.0, 0.0), groove, (30.0, 0.0)])


def extruded(a: float, b: float, profile: FloatArray) -> list[FloatArray]:
    """Top, sides and bottom between two x."""
    ring = np.vstack([(0.0, -20.0), profile, (30.0, -20.0), (0.0, -20.0)])
    return [np.array([(a, *p), (b, *p), (b, *q), (a, *q)]) for p, q in pairwise(ring)]


def wall(x: float, profile: FloatArray, side: float) -> list[FloatArray]:
    """The face x = const below a profile."""
    made = []
    for (y0, z0), (y1, z1) in pairwise(profile):
        quad = np.array([(x, y0, -20.0), (x, y1, -20.0), (x, y1, z1), (x, y0, z0)])
        made.append(quad if side > 0.0 else quad[::-1])
    return made


def slot_end(x: float) -> list[FloatArray]:
    """The upright end of the slot."""
    made = []
    profile = slot_profile()
    for (y0, z0), (y1, z1) in pairwise(profile):
        made.append(np.array([(x, y0, 0.0), (x, y1, 0.0), (x, y1, z1), (x, y0, z0)]))
    return made


def mesh(quads: list[FloatArray]) -> dict[str, NDArray[np.float32] | NDArray[np.uint32]]:
    """Flat-shaded quads as vertices, normals and triangles."""
    corners = np.array(quads)
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 3] - corners[:, 0])
    length = np.linalg.norm(normals, axis=1, keepdims=True)
    normals = normals / np.where(length > 0.0, length, 1.0)
    first = 4 * np.arange(len(corners))[:, None]
    triangles = np.concatenate([first + np.array(corner) for corner in ((0, 1, 2), (0, 2, 3))])
    return {
        "vertices_mm": corners.reshape(-1, 3).astype(np.float32),
        "normals": np.repeat(normals, 4, axis=0).astype(np.float32),
        "triangles": triangles.astype(np.uint32),
    }
