"""Forces of a cut for unit coefficients: mean and multiples of the spindle frequency."""

from __future__ import annotations

import math
from dataclasses import dataclass, field, replace
from typing import Protocol

import numpy as np

from twin.arrays import FloatArray
from twin.errors import CutsError, ToolError
from twin.identification.cuts.cuts_file import Cut, CutTool
from twin.identification.fit.harmonics import ComplexArray, of_waveform
from twin.identification.models.straight import ROWS, StraightPass, mean_matrix, response, strip_of
from twin.tools.shape import ToolShape, tool_shape


class Model(Protocol):
    """A cut as a linear function of the coefficients."""

    @property
    def feed_per_tooth_mm(self) -> float:
        """Feed per tooth; the largest where it changes."""

    @property
    def teeth(self) -> int:
        """Number of flutes."""

    @property
    def has_runout(self) -> bool:
        """Whether another runout than that of its file can be tried."""

    def means(self) -> FloatArray:
        """Mean force on the tool for unit coefficients, shape (3, 6)."""

    def harmonics(self, count: int, runout_mm: FloatArray | None = None) -> ComplexArray:
        """Coefficients of the force's waveform, see `twin.identification.fit.harmonics`, shape (count + 1, 3, 6).

        Args:
            runout_mm: shape (2,), offset of the cutter's axis along and across the direction of the tip of tooth 0
                (across: in the sense of rotation); None for that of the file.
        """


@dataclass(slots=True, eq=False)
class PassModel:
    """A straight pass."""

    cut: StraightPass
    _kept: dict[tuple[float, float], ComplexArray] = field(default_factory=dict)

    @property
    def feed_per_tooth_mm(self) -> float:
        """See `Model`."""
        return self.cut.feed_per_rev_mm / self.teeth

    @property
    def teeth(self) -> int:
        """See `Model`."""
        return len(self.cut.pitch_rad)

    @property
    def has_runout(self) -> bool:
        """See `Model`."""
        return True

    def at_speed(self, feed_per_rev_mm: float) -> PassModel:
        """The same pass with the feed per revolution that goes with the speed found."""
        return PassModel(replace(self.cut, feed_per_rev_mm=feed_per_rev_mm))

    def means(self) -> FloatArray:
        """See `Model`."""
        return mean_matrix(self.cut)

    def harmonics(self, count: int, runout_mm: FloatArray | None = None) -> ComplexArray:
        """See `Model`; the last few runouts are kept."""
        cut = self.cut
        if runout_mm is not None:
            size, angle = math.hypot(*runout_mm), math.atan2(runout_mm[1], runout_mm[0])
            cut = replace(cut, runout_mm=size, runout_rad=angle)
        key = (cut.runout_mm, cut.runout_rad)
        if key not in self._kept:
            if len(self._kept) > 4:
                del self._kept[next(iter(self._kept))]
            self._kept[key] = of_waveform(response(cut), ROWS // 2 - 1, math.pi / ROWS)
        return self._kept[key][: count + 1]


def shape_of(tool: CutTool, least_height_mm: float) -> ToolShape:
    """The tool's meridian, as high as given or as needed."""
    corner = 0.5 * tool.diameter_mm if tool.kind == "ball" else tool.corner_radius_mm or 0.0
    height = tool.flute_length_mm or max(least_height_mm, corner)
    return tool_shape(tool.kind, tool.diameter_mm, height, tool.corner_radius_mm or 0.0, tool.taper_deg or 0.0)


def pass_model(tool: CutTool, cut: Cut, file: str) -> PassModel:
    """The model of a straight pass.

    Raises:
        CutsError: a tool whose shape cannot be.
    """
    assert cut.axial_depth_mm and cut.spindle_rpm and cut.feed_mm_min and cut.direction
    try:
        shape = shape_of(tool, cut.axial_depth_mm)
    except ToolError as error:
        raise CutsError(file, [f"tool: {error}"]) from error
    pitch = np.asarray(tool.pitch_deg if tool.pitch_deg else [360.0 / tool.teeth] * tool.teeth)
    return PassModel(
        StraightPass(
            shape=shape,
            helix_deg=tool.helix_deg,
            pitch_rad=np.radians(np.concatenate(([0.0], np.cumsum(pitch)[:-1]))),
            runout_mm=tool.runout_mm,
            runout_rad=math.radians(tool.runout_angle_deg),
            axial_depth_mm=cut.axial_depth_mm,
            strip_mm=strip_of(cut.direction, 0.5 * tool.diameter_mm, cut.radial_depth_mm or tool.diameter_mm),
            feed_per_rev_mm=cut.feed_mm_min / cut.spindle_rpm,
        )
    )
