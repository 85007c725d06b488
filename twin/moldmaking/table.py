"""Times of the chain's stages beside those of its variants (the mold paper's Tables 2 and 3)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from twin.cam.surface.drop_cutter import DropCutter
from twin.moldmaking.chain import MoldChain

CONVENTIONAL = "conventional"


@dataclass(frozen=True, slots=True, kw_only=True)
class Times:
    """Machining time of one variant, s, without tool changes.

    Attributes:
        name: a method of ordering, or ``conventional``.
        rough_s, semi_s, finish_s: of the stages.
    """

    name: str
    rough_s: float
    semi_s: float
    finish_s: float

    @property
    def total_s(self) -> float:
        """Of all stages."""
        return self.rough_s + self.semi_s + self.finish_s


def times_table(chain: MoldChain) -> list[Times]:
    """A line for each order of semi-finishing, and the conventional chain where it is asked for."""
    rough, finish = chain.rough.time.total_s, chain.finish.time.total_s
    lines = [
        Times(name=name, rough_s=rough, semi_s=spent.total_s, finish_s=finish)
        for name, spent in chain.semi.by_method.items()
    ]
    if chain.job.compare.conventional:
        other = chain.conventional
        lines.append(
            Times(
                name=CONVENTIONAL,
                rough_s=other.rough_time.total_s,
                semi_s=other.semi_time.total_s,
                finish_s=finish,
            )
        )
    return lines


def saved(lines: list[Times]) -> float | None:
    """Part of the conventional chain's time that the best order saves; None without that chain."""
    others = [line for line in lines if line.name == CONVENTIONAL]
    if not others:
        return None
    best = min(line.total_s for line in lines if line.name != CONVENTIONAL)
    return 1.0 - best / others[0].total_s


@dataclass(frozen=True, slots=True, kw_only=True)
class Rest:
    """What a stage leaves on the part, measured along z at the dexels.

    Attributes:
        volume_mm3: above the part.
        median_mm, most_mm: height above it.
        gouge_mm: depth of the deepest cut into it.
    """

    volume_mm3: float
    median_mm: float
    most_mm: float
    gouge_mm: float


def rest_table(chain: MoldChain) -> dict[str, Rest]:
    """What each stage leaves."""
    surface = DropCutter(chain.surface, None)
    results = {name: chain.stage(name) for name in ("rough", "semi", "finish")}
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
