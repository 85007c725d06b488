"""Time, memory and file sizes of a replay, estimated before it."""

from __future__ import annotations

from dataclasses import dataclass

from twin.drafting.cuts import Cuts
from twin.drafting.fineness import Fineness
from twin.drafting.stock import StockBox


@dataclass(frozen=True, slots=True, kw_only=True)
class Estimate:
    """Estimate of a replay."""

    machine_time_s: float
    steps: int
    samples: int


def estimate(cuts: Cuts, stock: StockBox, fine: Fineness, *, forces: bool) -> Estimate:
    inside = cuts.feed.only(cuts.feed.low_mm[:, 2] < stock.high_mm[2])
    turns = float((inside.time_s * inside.spindle_rpm).sum() / 60.0)
    return Estimate(machine_time_s=float(cuts.feed.time_s.sum()), steps=int(inside.length_mm.sum()/fine.pitch_mm), samples=int(turns*360/fine.angle_deg))
