"""Prints the tables of docs/accuracy.md from the golden cases: ``python tests/support/accuracy_table.py``."""

from __future__ import annotations

import math
import sys
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).parents[1]))

from support.straight_pass import StraightPass, golden_case, golden_names
from twin.cutting.engagement import EngagementRule
from twin.motion.sweep import Body, Sweep
from twin.tolerance import Tolerance
from twin.tools.shape import tool_shape
from twin.workpiece.removal import Removal
from twin.workpiece.stock import box_slices
from twin.workpiece.trislice import CellSlices, PolygonSlices

FORWARD_MM = (0.0, 0.137, 0.274, 0.411)
FINISH = "t4_finish_down_ap0.1_ae0.25_prev"
CUTS = 300
ON_THE_BORDER = {"flat10_zero_helix_slot": (0, 90, 180, 270)}


def force_table() -> None:
    """Worst of four places in the slices' pitch, at 0.1 mm, 1 degree."""
    print("| case | mean error, % of mean resultant | RMS error, % of peak | torque, % | allowed RMS, % |")
    print("| --- | --- | --- | --- | --- |")
    for name in golden_names():
        case = golden_case(name)
        found = [StraightPass(case).errors(f, ON_THE_BORDER.get(name, ())) for f in FORWARD_MM]
        stated = case["rms_pct_of_peak_at_0_1_mm"]
        allowed = 2.0 if stated is None else 1.5 * stated + 1.0
        mean, rms = max(e.mean_pct for e in found), max(e.rms_pct for e in found)
        torque = max((e.torque_pct for e in found), key=abs)
        print(f"| {name} | {mean:.2f} | {rms:.2f} | {torque:+.2f} | {allowed:.2f} |")


def pitch_table() -> None:
    """RMS error over the pitch, mean of four places, for both rules."""
    print("\n| pitch, mm | ball, side | flat, side | finishing cut | finishing cut, any of three |")
    print("| --- | --- | --- | --- | --- |")
    cases: tuple[tuple[str, EngagementRule], ...] = (
        ("paper_B_f100", "majority"),
        ("flat16_helix40_half", "majority"),
        (FINISH, "majority"),
        (FINISH, "any"),
    )
    for pitch in (0.4, 0.2, 0.1, 0.05):
        cells = []
        for name, rule in cases:
            run = StraightPass(golden_case(name), pitch_mm=pitch, rule=rule)
            cells.append(f"{np.mean([run.errors(f).rms_pct for f in FORWARD_MM]):.2f}")
        print(f"| {pitch:g} | " + " | ".join(cells) + " |")


def power_table() -> None:
    """Mean power of the tangential forces without edge terms, against Ktc times removal rate by map and by volume."""
    print("\n| case | against the engagement map's rate, % | against the removed volume, % |")
    print("| --- | --- | --- |")
    for name in ("paper_table4_slot_ap2", "bull16_half", "flat16_helix40_half", "flat10_zero_helix_slot", FINISH):
        case = golden_case(name)
        run = StraightPass(case, edge_terms=False)
        ktc_w = case["coefficients"]["Ktc"] * 1e-3
        power_w = run.waveform(0.137)[:, 3].mean() * 1e-3 * 2.0 * math.pi * case["spindle_rpm"] / 60.0
        by_map = ktc_w * run.engage(0.137).summary.removal_rate_mm3_s
        by_volume = ktc_w * np.mean([run.cut(run.feed * (19.0 + i), 1.0) for i in range(3)])
        by_volume *= case["feed_mm_min"] / 60.0
        print(f"| {name} | {100.0 * (power_w / by_map - 1.0):+.3f} | {100.0 * (power_w / by_volume - 1.0):+.3f} |")


def volume_table() -> None:
    """Ball slot R4, 2 mm deep, 20 mm long against the circle's segment."""
    print("\n| pitch, mm | yz slices, % | zx slices, % | xy slices, % | reported, % |")
    print("| --- | --- | --- | --- | --- |")
    exact = 20.0 * (16.0 * math.acos(0.5) - 2.0 * math.sqrt(12.0))
    for pitch in (0.2, 0.1, 0.05):
        tolerance = Tolerance.for_pitch(pitch)
        piece = CellSlices(box_slices((0.0, -6.0, -4.0), (20.0, 6.0, 0.0), pitch))
        before = [piece.volume_mm3(axis) for axis in range(3)]
        body = Body.of(tool_shape("ball", 8.0, 20.0), chord_mm=tolerance.chord_mm)
        with Removal(piece, tolerance.chord_mm) as removal:
            said = removal.cut(Sweep(body, np.array([-6.0, 0.0, -2.0]), np.array([26.0, 0.0, -2.0])))
        found = [before[axis] - piece.volume_mm3(axis) for axis in range(3)] + [said]
        print(f"| {pitch:g} | " + " | ".join(f"{100.0 * (v / exact - 1.0):+.3f}" for v in found) + " |")


def store_line() -> None:
    """Largest difference in area of any slice between the two stores, over random cuts of four tools."""
    slices = box_slices((0.0, 0.0, -4.0), (9.0, 8.0, 0.0), 0.4)
    tolerance = Tolerance.for_pitch(0.4)
    shapes = (
        tool_shape("ball", 3.0, 8.0),
        tool_shape("flat", 2.0, 8.0),
        tool_shape("bull", 4.0, 8.0, corner_radius_mm=0.8),
        tool_shape("taper", 1.0, 8.0, corner_radius_mm=0.5, taper_deg=6.0),
    )
    bodies = [Body.of(shape, chord_mm=tolerance.chord_mm) for shape in shapes]
    fast, slow = CellSlices(slices), PolygonSlices(slices)
    rng = np.random.default_rng(5)
    with Removal(fast, tolerance.chord_mm) as quick, Removal(slow, tolerance.chord_mm) as plain:
        for number in range(CUTS):
            start = rng.uniform((-2.0, -2.0, -3.5), (11.0, 10.0, 0.5))
            sweep = Sweep(bodies[number % 4], start, start + rng.uniform(-2.0, 2.0, 3) * (rng.random(3) < 0.6))
            quick.cut(sweep)
            plain.cut(sweep)
    apart = max(float(np.abs(fast.areas_mm2(axis) - slow.areas_mm2(axis)).max()) for axis in range(3))
    print(f"\nlargest difference of a slice's area after {CUTS} cuts, fast and reference store: {apart:.1e} mm2")


if __name__ == "__main__":
    force_table()
    pitch_table()
    power_table()
    volume_table()
    store_line()
