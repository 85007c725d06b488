"""Resolution of a drafted job: slice pitch, step and angle between samples, to suit tools and program."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from twin.arrays import FloatArray
from twin.drafting.cuts import Feed
from twin.workpiece.slice_limit import least_pitch_mm

#: Slices over the diameter of the thinnest mill.
_SLICES_PER_DIAMETER = 30.0
#: Coarsest pitch where nothing needs a coarser one, mm.
_COARSEST_MM = 0.25
_PITCHES_MM = (0.01, 0.02, 0.025, 0.04, 0.05, 0.1, 0.2, 0.25, 0.4, 0.5, 1.0)
_ANGLES_DEG = (1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 8.0, 10.0)
#: Largest height of an edge element, mm.
_AXIAL_MM = 0.2
#: Force samples of a run: more make archives of hundreds of megabytes.
_MOST_SAMPLES = 1.5e6
#: Slices of a stock, in all three directions, that a drafted job has at most.
_MOST_SLICES = 6000.0
#: Steps of the tool in the material that a drafted job has at most, before its pitch becomes coarser.
_MOST_STEPS = 4e5


@dataclass(frozen=True, slots=True, kw_only=True)
class Fineness:
    """Resolution of a replay.

    Attributes:
        pitch_mm: distance between slices, and longest step of the tool.
        angle_deg: spindle angle between force samples.
        pitch_reason, angle_reason: why these.
    """

    pitch_mm: float
    angle_deg: float
    pitch_reason: str
    angle_reason: str

    @property
    def axial_mm(self) -> float:
        """Height of an edge element."""
        return min(self.pitch_mm, _AXIAL_MM)


def fineness_of(feed: Feed, diameters_mm: Sequence[float], stock_mm: FloatArray, most_mm: float) -> Fineness:
    """Resolution to suit a program.

    Args:
        feed: its motions in the stock.
        diameters_mm: of the tools that cut.
        stock_mm: extents of the stock, shape (3,).
        most_mm: coarsest pitch that a job with these tools may have.
    """
    thinnest = min(diameters_mm)
    wanted = min(thinnest / _SLICES_PER_DIAMETER, _COARSEST_MM)
    least = max(least_pitch_mm(stock_mm.tolist()), float(stock_mm.sum()) / _MOST_SLICES)
    length = float(feed.length_mm.sum())
    for_steps = length / _MOST_STEPS
    pitch = max((p for p in _PITCHES_MM if p <= wanted), default=_PITCHES_MM[0])
    reason = f"about {thinnest / pitch:.0f} slices over D{thinnest:g} mm"
    if max(least, for_steps) > pitch:
        pitch = min((p for p in _PITCHES_MM if p >= max(least, for_steps)), default=max(least, for_steps))
        what = "a stock of this size" if least >= for_steps else f"{length:.3g} mm of cutting motions"
        reason = f"coarser than the tools need, for {what}"
    if pitch > most_mm:
        pitch = max((p for p in _PITCHES_MM if p <= most_mm), default=most_mm)
        reason = f"the thinnest tip has D{most_mm:g} mm"
    turns = float((feed.time_s * feed.spindle_rpm).sum() / 60.0)
    angle = next((a for a in _ANGLES_DEG if turns * 360.0 / a <= _MOST_SAMPLES), _ANGLES_DEG[-1])
    return Fineness(
        pitch_mm=pitch,
        angle_deg=angle,
        pitch_reason=reason,
        angle_reason=f"{turns:,.0f} revolutions; more than {_MOST_SAMPLES:,.0f} samples make large files",
    )
