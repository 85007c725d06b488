"""Time, memory and file sizes of a replay, estimated before it.

The counts (steps, force samples) follow from the motions below the top of the stock; the costs of one of each are
those measured with eight programs. Sizes of runs with forces are within a factor of 1.5; times are those of an idle
processor of the usual kind.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np

from twin.drafting.cuts import Cuts
from twin.drafting.fineness import Fineness
from twin.drafting.stock import StockBox
from twin.drafting.tools import DraftTool
from twin.number_format import clock, duration

#: Rate of rapids of a job that does not state one, mm/min.
_RAPID_MM_MIN = 48_000.0
#: Computing time of a run without its motions, s.
_SETUP_S = 1.5
#: Computing time of a straight motion in the material for each slice over the tool's diameter, without and with forces,
#: and of a force sample, s. The length of a motion hardly counts: all its steps are solved together, and cut at once.
_SLICE_S, _FORCED_SLICE_S, _SAMPLE_S = 0.2e-3, 0.35e-3, 2.5e-6
#: Length of the straight pieces that an arc counts as, mm.
_PIECE_MM = 1.0
#: Bytes of a force sample, of a step, and of a byte of the meshes of the part: in the archive, and in a recording. In
#: the archive a sample takes little where each revolution is like the one before, and 8 bytes where no two are alike.
_ARCHIVE_B, _UNLIKE_B = (1.2, 120.0, 0.12), 8.0
_RECORDING_B = (24.0, 400.0, 0.55)
#: Bytes of the meshes for each second of feed motion in the stock: straight and level with a flat tool, which leaves
#: large planes, and otherwise; and for each cell of the surface at the end.
_PLANE_B_S, _DRAWN_B_S, _CELL_B = 0.05e6, 0.6e6, 45.0
#: Arcs, tilted motions, and those that are shorter than this, mm, change the engagement of tools that are not flat.
_SHORT_MM = 2.0
#: Most bytes of the meshes, and most samples in a recording (`twin.simulation.preview`, `twin.sinks.rerun.envelope`).
MOST_BYTES, MOST_SAMPLES = 120e6, 8_000_000
#: Cells along the longest side of the stock as drawn.
_CELLS = 200.0
#: Bytes of an archive and of a recording besides.
_ARCHIVE_MORE_B, _RECORDING_MORE_B = 0.03e6, 1.2e6
#: Memory of the program itself (a recording takes 130 MB more), and of a column of the slices that is cut, bytes.
_PROGRAM_B, _COLUMN_B = 280e6, 180.0


@dataclass(frozen=True, slots=True, kw_only=True)
class Estimate:
    """Estimate of a replay.

    Attributes:
        machine_time_s: feed motions, rapids and dwells.
        steps: steps of the tool below the top of the stock.
        samples: force samples, 0 without forces.
        computing_s: time of the replay on two threads.
        memory_bytes: largest memory.
        archive_bytes, recording_bytes: sizes of the archive and of a rerun recording.
    """

    machine_time_s: float
    steps: int
    samples: int
    computing_s: float
    memory_bytes: float
    archive_bytes: float
    recording_bytes: float

    def __str__(self) -> str:
        return (
            f"{clock(self.machine_time_s)} of machine time, {self.samples:,} force samples; about "
            f"{duration(self.computing_s)} of computing, {_bytes(self.memory_bytes)} of memory, archive "
            f"{_bytes(self.archive_bytes)}, recording (--rrd) {_bytes(self.recording_bytes)}"
        )

    def as_dict(self) -> dict[str, Any]:
        """The values by name."""
        return asdict(self)


def estimate(cuts: Cuts, stock: StockBox, fine: Fineness, tools: Sequence[DraftTool], *, forces: bool) -> Estimate:
    """Estimate a replay.

    Args:
        cuts: motions of the program.
        stock: the stock.
        fine: resolution of the replay.
        tools: tools that cut.
        forces: whether forces are computed.
    """
    inside = cuts.feed.only(cuts.feed.low_mm[:, 2] < stock.high_mm[2])
    rise = np.maximum(inside.high_mm[:, 2] - inside.low_mm[:, 2], 1e-9)
    share = np.minimum((stock.high_mm[2] - inside.low_mm[:, 2]) / rise, 1.0)
    own_turns = inside.time_s * inside.spindle_rpm * share / 60.0
    turns = float(own_turns.sum())
    samples = round(turns * 360.0 / fine.angle_deg) if forces else 0
    steps = round(float((inside.length_mm * share).sum()) / fine.pitch_mm) + len(inside.tool)
    x, y, z = stock.size_mm.tolist()
    surface = 2.0 * (x * y + y * z + z * x)
    cells = surface / max(max(x, y, z) / _CELLS, fine.pitch_mm) ** 2
    sizes = {tool.number: tool.diameter_mm for tool in tools}
    slices = np.array([sizes.get(number, 0.0) for number in inside.tool.tolist()]) / fine.pitch_mm
    swept = float((inside.length_mm * share * slices).sum()) * fine.pitch_mm
    pieces = np.where(inside.arc, np.maximum(1.0, inside.length_mm / _PIECE_MM), 1.0)
    cut_slices = float((pieces * slices).sum())

    flat = [tool.number for tool in tools if tool.kind in ("flat", "face mill")]
    planes = inside.level & ~inside.arc & np.isin(inside.tool, flat)
    drawn = float((inside.time_s * share * np.where(planes, _PLANE_B_S, _DRAWN_B_S)).sum())
    drawn = min(drawn, MOST_BYTES) + cells * _CELL_B
    changing = ~np.isin(inside.tool, flat) & (~inside.level | inside.arc | (inside.length_mm < _SHORT_MM))
    unlike = samples * float(own_turns[changing].sum()) / max(turns, 1e-9)

    def size(parts: tuple[float, float, float], most_samples: float = math.inf) -> float:
        sample, step, mesh = parts
        return float(min(samples, most_samples) * sample + steps * step + drawn * mesh)

    return Estimate(
        machine_time_s=float(cuts.feed.time_s.sum()) + cuts.dwell_s + cuts.rapid_mm / _RAPID_MM_MIN * 60.0,
        steps=steps,
        samples=samples,
        computing_s=_SETUP_S + cut_slices * (_FORCED_SLICE_S if forces else _SLICE_S) + samples * _SAMPLE_S,
        memory_bytes=_PROGRAM_B + min(surface, 2.0 * swept) / fine.pitch_mm**2 * _COLUMN_B,
        archive_bytes=size(_ARCHIVE_B) + unlike * (_UNLIKE_B - _ARCHIVE_B[0]) + _ARCHIVE_MORE_B,
        recording_bytes=size(_RECORDING_B, MOST_SAMPLES) + _RECORDING_MORE_B,
    )


def _bytes(size: float) -> str:
    """A size as people write it."""
    return f"{size / 1e9:.2g} GB" if size >= 1e9 else f"{size / 1e6:.2g} MB" if size < 1e7 else f"{size / 1e6:.0f} MB"
