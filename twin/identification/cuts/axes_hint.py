"""Other axes and signs under which the forces of the cuts would follow the model."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import permutations, product

import numpy as np

from twin.arrays import FloatArray
from twin.identification.cuts.measure import Measured
from twin.identification.fit.least_squares import fit_linear, fixed_values
from twin.identification.models.model import Model

_AXES = "xyz"
#: Part of the variation that axes must explain to be reported.
_FITS = 0.97


def other_axes(models: Sequence[Model], measured: Sequence[Measured]) -> str | None:
    """Axes and signs under which mean forces fit best, relative to those of the map; None where none fit.

    Only coefficients as metals have them count: tangential and radial ones above 0.
    """
    if not models or not all(m.axes.all() for m in measured):
        return None
    design = np.concatenate([model.means() for model in models])
    means = np.array([m.mean_n for m in measured])
    best = max(_tried(design, means), default=(0.0, ""))
    return best[1] if best[0] > _FITS else None


def _tried(design: FloatArray, means: FloatArray) -> Iterator[tuple[float, str]]:
    """Part of the variation explained, and the axes in words, of all axes that give possible coefficients."""
    for order in permutations(range(3)):
        for signs in product((1.0, -1.0), repeat=3):
            values = (means[:, order] * np.array(signs)).reshape(-1)
            found = fit_linear(design, values, None, fixed_values({}))
            if not found.determined.all() or found.values[:4].min() <= 0.0:
                continue
            left = float(np.sum((values - design @ found.values) ** 2))
            total = float(np.sum((values - values.mean()) ** 2))
            listed = ", ".join(
                f"{axis} = {'-' if sign < 0.0 else ''}{_AXES[i]}"
                for axis, i, sign in zip(_AXES, order, signs, strict=True)
            )
            yield (1.0 - left / total if total > 0.0 else 0.0), listed
