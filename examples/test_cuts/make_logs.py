"""Makes SYNTHETIC dynamometer logs: nine test cuts and a validation cut. Nothing here was measured.

A model of its own, not the simulator: edges are integrated along the meridian at every sample, against a block that is
given by inequalities. Then what a real log has is added: a spindle a little off its speed, runout, the force on the
workpiece in the dynamometer's own axes, zero offsets, drift, an unknown delay, noise. Only numpy is used.

    python examples/test_cuts/make_logs.py        writes examples/test_cuts/logs/synthetic_*.csv
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np

LOGS = Path(__file__).parent / "logs"
SEED = 20260

# what the identification is to find again
KTC, KTE, KRC, KRE, KAC, KAE = 935.62, 2.0218, 416.73, 1.8238, 2.72e-05, 3.32e-06
RUNOUT_MM, RUNOUT_DEG = 0.003, 40.0

# ball end mill of Kaneko et al., Table 4; two teeth are assumed
RADIUS_MM, TEETH, HELIX_DEG = 4.0, 2, 30.0
RPM = 3600.0
ELEMENTS = 100
# samples whose arrays fit the processor's cache
AT_ONCE = 250

# test cuts of Table 5 (down milling is assumed), and the block that they cut into
DEPTHS_MM = {"A": (8.0, 1.5), "B": (5.0, 3.0), "C": (2.0, 7.0)}
FEEDS_MM_MIN = (100, 200, 300)
BLOCK_LENGTH_MM = 8.0
RATE_HZ = 6000.0
AIR_S = 0.7

# validation cut under the conditions of Table 4 (2 mm are assumed): level up to the waypoint, then rising
VALIDATION_MM = ((-6.0, -2.0), (14.0, -2.0), (30.0, -0.5))
VALIDATION_LENGTH_MM = 40.0
VALIDATION_FEED_MM_MIN = 200.0
VALIDATION_RATE_HZ = 6000.0

NOISE_N, OFFSET_N, DRIFT_N_S = 1.5, 8.0, 0.3


@dataclass(frozen=True)
class Edges:
    """Points in the middle of elements along the meridian of a ball end mill, up to a height."""

    z: np.ndarray
    r: np.ndarray
    sin_k: np.ndarray
    cos_k: np.ndarray
    db: np.ndarray
    lag: np.ndarray


def edges(height_mm: float) -> Edges:
    arc = RADIUS_MM * np.arccos(max(0.0, 1.0 - height_mm / RADIUS_MM))
    wall = max(0.0, height_mm - RADIUS_MM)
    s = (np.arange(ELEMENTS) + 0.5) * (arc + wall) / ELEMENTS
    kappa = np.minimum(s / RADIUS_MM, 0.5 * np.pi)
    z = np.where(s < arc, RADIUS_MM * (1.0 - np.cos(kappa)), RADIUS_MM + s - arc)
    lag = z * np.tan(np.radians(HELIX_DEG)) / RADIUS_MM
    return Edges(
        z, RADIUS_MM * np.sin(kappa), np.sin(kappa), np.cos(kappa), np.full(len(s), (arc + wall) / len(s)), lag
    )


def forces_on_tool(
    tip: np.ndarray, feed: np.ndarray, spindle: np.ndarray, per_tooth_mm: float, e: Edges, x_max: float, y_max: float
) -> np.ndarray:
    """Force on the tool, shape (n, 3), at tool tips (n, 3), unit feeds (n, 3), spindle angles (n,).

    The block is 0 < x < x_max, y < y_max, z < 0. Spindle clockwise from above; tooth 0 points along +x at angle 0.
    """
    out = np.zeros((len(tip), 3))
    for first in range(0, len(tip), AT_ONCE):
        at = slice(first, first + AT_ONCE)
        out[at] = forces_at_once(tip[at], feed[at], spindle[at], per_tooth_mm, e, x_max, y_max)
    return out


def forces_at_once(
    tip: np.ndarray, feed: np.ndarray, spindle: np.ndarray, per_tooth_mm: float, e: Edges, x_max: float, y_max: float
) -> np.ndarray:
    """The same for a few samples."""
    out = np.zeros((len(tip), 3))
    runout = np.radians(RUNOUT_DEG)
    for tooth in range(TEETH):
        behind = tooth * 2.0 * np.pi / TEETH + e.lag
        theta = behind[None, :] - spindle[:, None]
        cos_t, sin_t = np.cos(theta), np.sin(theta)
        nf = (cos_t * feed[:, :1] + sin_t * feed[:, 1:2]) * e.sin_k - feed[:, 2:] * e.cos_k
        x, y = tip[:, :1] + e.r * cos_t, tip[:, 1:2] + e.r * sin_t
        inside = (nf > 0.0) & (x > 0.0) & (x < x_max)
        part = share(y_max - y, np.gradient(y, axis=1)) * share(-tip[:, 2:] - e.z, e.sin_k * e.db)
        # Kline and DeVor: the chip is the smallest of those left by the earlier passes of each tooth
        farther = RUNOUT_MM * (np.cos(runout + behind) - np.cos(runout + behind - 2.0 * np.pi / TEETH))
        chip = np.minimum(per_tooth_mm * nf + farther * e.sin_k, TEETH * per_tooth_mm * nf)
        db = np.where(inside & (chip > 0.0), e.db * part, 0.0)
        ft, fr, fa = (KTC * chip + KTE) * db, (KRC * chip + KRE) * db, (KAC * chip + KAE) * db
        inward = fr * e.sin_k + fa * e.cos_k
        out[:, 0] += np.sum(-ft * sin_t - inward * cos_t, axis=1)
        out[:, 1] += np.sum(ft * cos_t - inward * sin_t, axis=1)
        out[:, 2] += np.sum(fr * e.cos_k - fa * e.sin_k, axis=1)
    return out


def share(depth: np.ndarray, extent: np.ndarray) -> np.ndarray:
    """Share of an element in the block, from the depth of its middle and its extent across the block's face."""
    return np.clip(0.5 + depth / np.maximum(np.abs(extent), 1e-9), 0.0, 1.0)


def log(
    path: Path, rng: np.random.Generator, rate_hz: float, seconds: float, tool_force: np.ndarray, what: str
) -> None:
    """Write the log of a dynamometer under the part, its x axis along the machine's y, its y axis along -x."""
    t = np.arange(len(tool_force)) / rate_hz
    on_workpiece = -tool_force
    force = np.column_stack((on_workpiece[:, 1], -on_workpiece[:, 0], on_workpiece[:, 2]))
    force += rng.uniform(-OFFSET_N, OFFSET_N, 3) + np.outer(t, rng.uniform(-DRIFT_N_S, DRIFT_N_S, 3))
    force += rng.normal(0.0, NOISE_N, force.shape)
    rows = "\n".join(f"{a:.6f},{x:.2f},{y:.2f},{z:.2f}" for a, (x, y, z) in zip(t, force, strict=True))
    path.write_text(
        f"# SYNTHETIC DATA: computed by make_logs.py, not measured. {what}, {seconds:.1f} s.\n"
        f"Time [s],Fx [N],Fy [N],Fz [N]\n{rows}\n"
    )


def test_cut(rng: np.random.Generator, name: str, axial_mm: float, radial_mm: float, feed_mm_min: float) -> None:
    speed = feed_mm_min / 60.0
    seconds = 2.0 * AIR_S + (BLOCK_LENGTH_MM + 2.0 * RADIUS_MM) / speed
    delay = rng.uniform(0.0, 0.4)
    t = np.arange(0.0, seconds + delay, 1.0 / RATE_HZ)
    rpm = RPM * (1.0 + rng.uniform(-0.002, 0.002))
    spindle = rpm * 2.0 * np.pi / 60.0 * t + rng.uniform(0.0, 2.0 * np.pi)
    x = -RADIUS_MM + speed * (t - delay - AIR_S)
    cutting = (x > -RADIUS_MM) & (x < BLOCK_LENGTH_MM + RADIUS_MM)
    tip = np.column_stack((x, np.zeros_like(x), np.full_like(x, -axial_mm)))[cutting]
    feed = np.tile([1.0, 0.0, 0.0], (len(tip), 1))
    force = np.zeros((len(t), 3))
    force[cutting] = forces_on_tool(
        tip, feed, spindle[cutting], speed * 60.0 / rpm / TEETH, edges(axial_mm), BLOCK_LENGTH_MM, radial_mm - RADIUS_MM
    )
    what = f"ap {axial_mm:g} mm, ae {radial_mm:g} mm, down, {feed_mm_min:g} mm/min"
    log(LOGS / f"synthetic_{name}.csv", rng, RATE_HZ, float(t[-1]), force, what)


def validation_cut(rng: np.random.Generator) -> None:
    speed = VALIDATION_FEED_MM_MIN / 60.0
    corners = np.array([[x, 0.0, z] for x, z in VALIDATION_MM])
    lengths = np.linalg.norm(np.diff(corners, axis=0), axis=1)
    begins = AIR_S + rng.uniform(0.0, 0.4)
    ends = begins + np.concatenate(([0.0], np.cumsum(lengths / speed)))
    t = np.arange(0.0, ends[-1] + AIR_S, 1.0 / VALIDATION_RATE_HZ)
    spindle = RPM * 2.0 * np.pi / 60.0 * t + rng.uniform(0.0, 2.0 * np.pi)
    force = np.zeros((len(t), 3))
    for a, b, first, last in zip(corners[:-1], corners[1:], ends[:-1], ends[1:], strict=True):
        at = (t >= first) & (t < last)
        along = (b - a) / np.linalg.norm(b - a)
        tip = a + np.outer(speed * (t[at] - first), along)
        feed = np.tile(along, (len(tip), 1))
        per_tooth = speed * 60.0 / RPM / TEETH
        force[at] = forces_on_tool(tip, feed, spindle[at], per_tooth, edges(2.0), VALIDATION_LENGTH_MM, np.inf)
    log(LOGS / "synthetic_validation.csv", rng, VALIDATION_RATE_HZ, float(t[-1]), force, "slot, ap 2 mm, then rising")


def main() -> None:
    rng = np.random.default_rng(SEED)
    LOGS.mkdir(exist_ok=True)
    for letter, (axial_mm, radial_mm) in DEPTHS_MM.items():
        for feed_mm_min in FEEDS_MM_MIN:
            test_cut(rng, f"{letter}{feed_mm_min}", axial_mm, radial_mm, feed_mm_min)
    validation_cut(rng)
    print(f"SYNTHETIC logs of nine test cuts and a validation cut written to {LOGS}")


if __name__ == "__main__":
    main()
