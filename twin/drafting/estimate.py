"""Time, memory and file sizes of a replay, estimated before it.

The counts (steps, force samples, revolutions) follow from the motions below the top of the stock; the costs of one of
each are those measured with the examples . Times are those of a
usual processor with two threads.
"""

from __future__ import annotations

from dataclasses import asdict, dataclass
from typing import Any

from twin.drafting.cuts import Cuts
from twin.drafting.fineness import Fineness
from twin.drafting.stock import StockBox
from twin.number_format import clock

#: Rate of rapids of a job that does not state one, mm/min.
_RAPID_MM_MIN = 48_000.0
#: Computing time of a run without its steps, of a step in the material, and of a force sample, s.
_SETUP_S, _STEP_S, _SAMPLE_S = 3.0, 1.6e-3, 3e-6
#: Archive: bytes of a force sample, of a step, of a block, and of 1 mm2 of the stock's surface in cells of 1 mm.
_SAMPLE_B, _STEP_B, _MOTION_B, _SURFACE_B = 70.0, 190.0, 60.0, 2000.0
#: Memory: of the program itself, and of a column of a slice, bytes.
_PROGRAM_B, _COLUMN_B = 300e6, 300.0


@dataclass(frozen=True, slots=True, kw_only=True)
class Estimate:
    """Estimate of a replay.

    Attributes:
        machine_time_s: feed motions, rapids and dwells.
        steps: steps of the tool below the top of the stock.
        samples: force samples, 0 without forces.
        computing_s: time of the replay on two threads.
        memory_bytes: largest memory.
        archive_bytes: size of the archive.
    """

    machine_time_s: float
    steps: int
    samples: int
    computing_s: float
    memory_bytes: float
    archive_bytes: float

    def __str__(self) -> str:
        return (
            f"{clock(self.machine_time_s)} of machine time, {self.samples:,} force samples; about "
            f"{clock(self.computing_s)} of computing, {_bytes(self.memory_bytes)} of memory, archive "
            f"{_bytes(self.archive_bytes)}"
        )

    def as_dict(self) -> dict[str, Any]:
        """The values by name."""
        return asdict(self)


def estimate(cuts: Cuts, stock: StockBox, fine: Fineness, *, forces: bool) -> Estimate:
    """Estimate a replay.

    Args:
        cuts: motions of the program.
        stock: the stock.
        fine: resolution of the replay.
        forces: whether forces are computed.
    """
    inside = cuts.feed.only(cuts.feed.low_mm[:, 2] < stock.high_mm[2])
    turns = float((inside.time_s * inside.spindle_rpm).sum() / 60.0)
    samples = round(turns * 360.0 / fine.angle_deg) if forces else 0
    steps = round(float(inside.length_mm.sum()) / fine.pitch_mm) + len(inside.tool)
    x, y, z = stock.size_mm.tolist()
    surface = 2.0 * (x * y + y * z + z * x)
    columns = surface / fine.pitch_mm**2
    return Estimate(
        machine_time_s=float(cuts.feed.time_s.sum()) + cuts.dwell_s + cuts.rapid_mm / _RAPID_MM_MIN * 60.0,
        steps=steps,
        samples=samples,
        computing_s=_SETUP_S + steps * _STEP_S + samples * _SAMPLE_S,
        memory_bytes=_PROGRAM_B + columns * _COLUMN_B,
        archive_bytes=samples * _SAMPLE_B + steps * _STEP_B + cuts.motions * _MOTION_B + surface * _SURFACE_B,
    )


def _bytes(size: float) -> str:
    """A size as people write it."""
    return f"{size / 1e9:.2g} GB" if size >= 1e9 else f"{size / 1e6:.2g} MB" if size < 1e7 else f"{size / 1e6:.0f} MB"
