"""Machining times of the stages next to those of other orders and of the raster baseline, and rest material.

The comparison is that of the mold paper's Tables 2 and 3.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from twin.cam.surface.drop_cutter import DropCutter
from twin.moldmaking.stages import MoldPlan

BASELINE = "raster baseline"


@dataclass(frozen=True, slots=True, kw_only=True)
class Times:
    """Machining time of one variant, s, without tool changes.

    Attributes:
        name: a method of ordering, or ``raster baseline``.
        rough_s, semi_s, finish_s: times of the stages.
    """

    name: str
    rough_s: float
    semi_s: float
    finish_s: float

    @property
    def total_s(self) -> float:
        """Time of all stages."""
        return self.rough_s + self.semi_s + self.finish_s


def times_table(plan: MoldPlan) -> list[Times]:
    """One line per search method of semi-finishing, and one for the raster baseline where it is requested."""
    rough, finish = plan.rough.time.total_s, plan.finish.time.total_s
    lines = [
        Times(name=name, rough_s=rough, semi_s=spent.total_s, finish_s=finish)
        for name, spent in plan.semi.by_method.items()
    ]
    if plan.job.compare.raster_baseline:
        other = plan.raster_baseline
        lines.append(
            Times(
                name=BASELINE,
                rough_s=other.rough_time.total_s,
                semi_s=other.semi_time.total_s,
                finish_s=finish,
            )
        )
    return lines


def saved(lines: Sequence[Times]) -> float | None:
    """Share of the raster baseline's time that the best order saves; None without the baseline."""
    others = [line for line in lines if line.name == BASELINE]
    if not others:
        return None
    best = min(line.total_s for line in lines if line.name != BASELINE)
    return 1.0 - best / others[0].total_s


@dataclass(frozen=True, slots=True, kw_only=True)
class Rest:
    """Rest material of a stage, measured along z at the dexels.

    Attributes:
        volume_mm3: volume above the part.
        median_mm, most_mm: median and largest height above the part.
        gouge_mm: depth of the deepest gouge.
    """

    volume_mm3: float
    median_mm: float
    most_mm: float
    gouge_mm: float


def rest_table(plan: MoldPlan) -> dict[str, Rest]:
    """Rest material after each stage."""
    surface = DropCutter(plan.surface, None)
    results = {name: plan.stage(name) for name in ("rough", "semi", "finish")}
    first = results["rough"].stock
    part = surface.drop(first.points_mm).reshape(first.heights_mm.shape)
    table: dict[str, Rest] = {}
    for name, result in results.items():
        above = result.stock.heights_mm - part
        table[name] = Rest(
            volume_mm3=float(np.maximum(above, 0.0).sum()) * result.stock.cell_mm2,
            median_mm=float(np.median(above)),
            most_mm=float(above.max()),
            gouge_mm=float(max(0.0, -above.min())),
        )
    return table
