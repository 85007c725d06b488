"""Arrays of a tool's cutting edges and of an engagement map's rows, as kernels take them."""

from __future__ import annotations

from typing import NamedTuple

from twin.arrays import FloatArray


class EdgeArrays(NamedTuple):
    """Edge elements along the meridian, each of shape (elements,), from the lowest; see `twin.tools.edges`.

    Attributes:
        radius, height: of the element's midpoint, mm.
        cos_kappa, sin_kappa: of the angle between outward normal and tool axis.
        length: along the meridian, mm.
    """

    radius: FloatArray
    height: FloatArray
    cos_kappa: FloatArray
    sin_kappa: FloatArray
    length: FloatArray


class RowAngles(NamedTuple):
    """Cosine and sine of the angle of each row of an engagement map, shape (rows,)."""

    cos: FloatArray
    sin: FloatArray


class Flutes(NamedTuple):
    """Flutes of a cutter.

    Attributes:
        angle: shape (teeth, elements), angle of each element behind the tip of tooth 0, rad.
        feed_part: shape (teeth, backs), fraction of a revolution since the tooth 1, 2, ... before passed.
        runout_step_mm: shape (teeth, backs, elements), how much farther out by runout than on that tooth an
            element is, mm.
    """

    angle: FloatArray
    feed_part: FloatArray
    runout_step_mm: FloatArray
