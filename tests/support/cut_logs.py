"""Files of test cuts whose logs come from `support.edge_integral`, as a dynamometer in its own axes would say them."""

from __future__ import annotations

import math
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from support.edge_integral import Pass, log_rows
from twin.arrays import FloatArray
from twin.identification.cuts.cuts_file import Cuts
from twin.identification.cuts.load import cuts_from_dict

#: The force on the part, the dynamometer's x along the machine's y, its y along -x, z up.
QUARTER_TURN = {"map": "x=-Fy,y=Fx,z=Fz", "force_on": "workpiece"}
AIR_S, CUT_S = 0.8, 1.5


def write_log(path: Path, t_s: FloatArray, on_tool_n: FloatArray) -> None:
    on_part = -on_tool_n
    table = np.column_stack((t_s, on_part[:, 1], -on_part[:, 0], on_part[:, 2]))
    np.savetxt(path, table, delimiter=",", header="t_s,Fx_N,Fy_N,Fz_N", comments="", fmt="%.6f")


def cut_name(index: int, given: Pass) -> str:
    return f"{index}_{given.direction}_{given.feed:g}"


def mean_tables(passes: Sequence[Pass], k: FloatArray) -> dict[str, Any]:
    """A file of cuts with exact mean forces."""
    cuts = [p.cut(cut_name(i, p)) | {"mean_force_n": p.mean(k).tolist()} for i, p in enumerate(passes)]
    return {"tool": passes[0].tool(), "cuts": cuts}


def logged(
    folder: Path,
    passes: Sequence[Pass],
    k: FloatArray,
    *,
    rate_hz: float = 3000.0,
    noise_n: float = 0.0,
    seed: int = 1,
    zero: bool = True,
) -> dict[str, Any]:
    """A file of cuts with logs: offset, drift, unknown phase, a spindle a little off its speed."""
    rng = np.random.default_rng(seed)
    cuts = []
    for i, given in enumerate(passes):
        true = given.but(rpm=given.rpm * (1.0 + rng.uniform(-0.003, 0.003)), points=250)
        phase = rng.uniform(0.0, 2.0 * math.pi)
        t, force = log_rows(true, k, rate_hz=rate_hz, air_s=AIR_S, cut_s=CUT_S, phase_rad=phase)
        if zero:
            force = force + rng.uniform(-9.0, 9.0, 3) + np.outer(t, rng.uniform(-1.0, 1.0, 3))
        name = cut_name(i, given)
        write_log(folder / f"{name}.csv", t, force + rng.normal(0.0, noise_n, force.shape))
        # the cut begins and ends at a stroke: the tool's way in and out is not in these logs
        window = [AIR_S + 0.05, AIR_S + CUT_S - 0.05]
        cuts.append(given.cut(name) | {"log": f"{name}.csv", "window_s": window})
    return {"tool": given.tool(), "defaults": dict(QUARTER_TURN), "cuts": cuts}


def cuts_in(folder: Path, data: dict[str, Any], **fit: object) -> Cuts:
    return cuts_from_dict(data | {"fit": data.get("fit", {}) | fit}, folder / "cuts.toml")
