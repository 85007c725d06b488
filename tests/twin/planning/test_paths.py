"""Planned paths and their replay agree with closed forms."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from support.small_parts import box, pocket, prism, small_torus

from twin.cam.path.to_nc import NcOptions, Operation, write_nc
from twin.cam.path.toolpath import MoveKind, ToolPath
from twin.cam.slices.sections import slice_part
from twin.cam.surface.drop_cutter import DropCutter
from twin.errors import SettingsError, StockError, ToolError, ToolPathError
from twin.job import load_job
from twin.planning.accuracy import pitch_bound_mm, sag_mm
from twin.planning.paths import PlanSetup, plan, prepare
from twin.planning.replay_job import replay_tables, write_replay_job
from twin.planning.settings import PathSettings
from twin.settings.check import checked
from twin.tools.text import parse_tool
from twin.verification.deviation import Deviation, Limits, deviation
from twin.verification.machining import machined
from twin.workpiece.solids.from_mesh import Solid

DEG = 30.0
#: A slope of 30 degrees between two floors, 16 x 6 mm.
SLOPE = [
    (0.0, -2.0),
    (16.0, -2.0),
    (16.0, 6.0 * math.tan(math.radians(DEG))),
    (12.0, 6.0 * math.tan(math.radians(DEG))),
    (6.0, 0.0),
    (0.0, 0.0),
]


def made(part: Solid, **values: Any) -> tuple[ToolPath, PlanSetup]:
    settings = checked(PathSettings, {"tool": "ball 4", "pitch_mm": 0.2, **values}, "test")
    setup = prepare(settings, slice_part(part, settings.pitch_mm))
    return plan(settings, setup), setup


def replayed(path: ToolPath, setup: PlanSetup, part: Solid, folder: Path, pitch: float, **limits: Any) -> Deviation:
    """Write program and job, load them again, cut, and compare."""
    operation, options = Operation(path=path, spindle_rpm=3600.0), NcOptions()
    write_nc(folder / "a.nc", [operation], options)
    tables = replay_tables(folder / "a.nc", [operation], options, setup.stock_mm, pitch, folder)
    write_replay_job(folder / "a.toml", tables, "test")
    store, collisions = machined(load_job(folder / "a.toml"))
    assert [c.message for c in collisions] == []
    return deviation(store, part, tolerance_mm=0.005, **limits)


def test_rows_over_a_slope_are_those_of_the_formula() -> None:
    path, _ = made(prism(SLOPE, 0.0, 6.0), strategy="scan", stepover_mm=1.0)
    points = np.concatenate([m.chords_mm(1e-4) for m in path.of_kind(MoveKind.CUT)])
    on = points[(points[:, 0] > 8.0) & (points[:, 0] < 10.0)]
    a = math.radians(DEG)
    # a ball's tip on a slope: its centre is r / cos(a) above the contact's plane
    wanted = (on[:, 0] - 6.0) * math.tan(a) + 2.0 / math.cos(a) - 2.0
    assert on[:, 2] == pytest.approx(wanted, abs=1e-3)
    floor = points[points[:, 0] < 4.0]
    assert floor[:, 2] == pytest.approx(0.0, abs=1e-4)


#: A wall of 6 mm with a draft of 3 degrees, along the rows: slices hardly know it.
DRAFT = [(0.0, -2.0), (12.0, -2.0), (12.0, 6.0), (6.0 + 6.0 * math.tan(math.radians(3.0)), 6.0), (6.0, 0.0), (0.0, 0.0)]


@pytest.mark.parametrize("tool", ["ball 4", "flat 4", "bull 4 r0.5", "taper 3 r1 a2"])
def test_exact_rows_are_the_drop_cutters(tool: str) -> None:
    for part in (prism(DRAFT, 0.0, 6.0), small_torus()):
        path, setup = made(part, strategy="scan", stepover_mm=0.7, direction="y", tool=tool, exact=True)
        cutter = DropCutter(part.vertices_mm[part.triangles], parse_tool(tool), floor_mm=setup.floor_mm)
        lines = [m.chords_mm(1e-4) for m in path.of_kind(MoveKind.CUT)]
        for points in (np.concatenate(lines), np.concatenate([0.5 * (ln[1:] + ln[:-1]) for ln in lines])):
            # chords 0.5 um, omitted points 0.2 um, extended corners; next to walls as much sideways
            near = np.array([cutter.drop(points[:, :2] + (0.0, aside)) for aside in (-0.002, 0.0, 0.002)])
            assert (points[:, 2] - near.min(axis=0)).min() > -0.002
            assert (points[:, 2] - near.max(axis=0)).max() < 0.002
            assert np.mean(np.abs(points[:, 2] - near[1]) < 0.001) > 0.99


def test_exact_rows_leave_the_allowance() -> None:
    part = small_torus()
    path, _ = made(part, strategy="scan", stepover_mm=0.7, tool="ball 4", exact=True, allowance_mm=0.3, layers=2)
    points = np.concatenate([m.points_mm for m in path.of_kind(MoveKind.CUT)])
    # the tip of a ball that is larger by the allowance is lower by it
    cutter = DropCutter(part.vertices_mm[part.triangles], parse_tool("ball 4.6"))
    above = points[:, 2] - cutter.drop(points[:, :2]) - 0.3
    assert above.min() > -0.02
    assert np.mean(np.abs(above) < 0.02) > 0.3


@pytest.mark.parametrize("exact", [False, True])
def test_rows_next_to_a_drafted_wall_keep_their_bound(exact: bool) -> None:
    part = prism(DRAFT, 0.0, 6.0)
    values: dict[str, Any] = {"strategy": "scan", "stepover_mm": 0.13, "direction": "y", "exact": exact}
    path, setup = made(part, **values)
    points = np.concatenate([m.points_mm for m in path.of_kind(MoveKind.CUT)])
    cutter = DropCutter(part.vertices_mm[part.triangles], parse_tool("ball 4"))
    aside = np.linspace(0.0, 0.1, 101)
    free = np.array([points[:, 2] >= cutter.drop(points[:, :2] - (a, 0.0)) - 3e-3 for a in aside])
    assert free.any(axis=0).all()
    # how far the tip must go away from the wall to be free
    off = float(aside[np.argmax(free, axis=0)].max())
    bound = pitch_bound_mm(checked(PathSettings, {"tool": "ball 4", "pitch_mm": 0.2, **values}, "test"), setup)
    assert off <= bound <= (0.0 if exact else 0.03)


@pytest.mark.parametrize(("direction", "stepover"), [("x", 0.8), ("y", 0.8)])
def test_scallops_are_as_high_as_the_formula_says(tmp_path: Path, direction: str, stepover: float) -> None:
    part = prism(SLOPE, 0.0, 6.0)
    path, setup = made(part, strategy="scan", stepover_mm=stepover, direction=direction, zigzag=True)
    # away from the box's sides and from the inner corner, which a ball cannot reach
    limits = Limits.of(part, (8.0, 0.5, 11.0, 5.5))
    found = replayed(path, setup, part, tmp_path, 0.2, limits=limits, excess_mm=0.1)
    # rows along x are a step-over apart on the slope too, rows along y are farther apart there
    apart = stepover * (6.0 / 8.0 * 1.0 if direction == "x" else 1.0)
    count = math.ceil((6.0 if direction == "x" else 16.0) / stepover)
    apart = (6.0 if direction == "x" else 16.0) / count / (1.0 if direction == "x" else math.cos(math.radians(DEG)))
    scallop = 2.0 - math.sqrt(4.0 - 0.25 * apart**2)
    assert found.worst_gouge_mm < 0.002
    assert found.worst_excess_mm < scallop + 0.002
    assert found.worst_excess_mm > 0.6 * scallop


def test_allowance_is_left_everywhere(tmp_path: Path) -> None:
    part = prism(SLOPE, 0.0, 6.0)
    path, setup = made(part, strategy="scan", stepover_mm=0.5, allowance_mm=0.3, stock_mm=(0, 0, -2, 16, 6, 5.0))
    found = replayed(path, setup, part, tmp_path, 0.2, limits=Limits.of(part, (8.0, 0.5, 11.0, 5.5)), excess_mm=0.4)
    scallop = 2.3 - math.sqrt(2.3**2 - 0.25**2)
    assert found.deviation_mm.min() > 0.3 - 0.002
    assert found.worst_excess_mm < 0.3 + scallop + 0.004


def test_layers_take_the_stock_down_step_by_step() -> None:
    path, setup = made(
        prism(SLOPE, 0.0, 6.0), strategy="scan", stepover_mm=2.0, allowance_mm=0.1, layers=3, axial_depth_mm=1.0
    )
    tops = [m.points_mm[:, 2].max() for m in path.of_kind(MoveKind.CUT)]
    assert max(tops) <= setup.stock_mm[1, 2] + 0.011
    floors = {round(float(m.points_mm[:, 2].min()), 2) for m in path.of_kind(MoveKind.CUT)}
    assert floors == {0.1, 1.1, 2.1}
    heights = [m.points_mm[:, 2].min() for m in path.of_kind(MoveKind.CUT)]
    assert heights[0] > heights[-1]


def test_a_scan_keeps_to_the_drop_cutter() -> None:
    part = small_torus()
    path, setup = made(part, strategy="scan", tool="ball 3", pitch_mm=0.1, stepover_mm=0.5, arcs_mm=0.001)
    cutter = DropCutter(part.vertices_mm[part.triangles], setup.tool, floor_mm=setup.floor_mm)
    points = np.concatenate([m.chords_mm(1e-4) for m in path.of_kind(MoveKind.CUT, MoveKind.LINK)])
    over = points[:, 2] - cutter.drop(points[:, :2])
    assert np.quantile(np.abs(over), 0.95) < 0.003
    assert over.min() > -0.02 and over.max() < 0.02


def test_contours_leave_no_gouge_and_their_levels(tmp_path: Path) -> None:
    part = small_torus()
    path, setup = made(
        part,
        strategy="contour",
        tool="flat 3",
        axial_depth_mm=0.5,
        layers=0,
        floor_z_mm=0.0,
        radial_depth_mm=1.2,
        stock_mm=(-11, -11, -2, 11, 11, 2),
        thin_mm=0.002,
        entry="plunge",
    )
    heights = {round(float(m.points_mm[0, 2]), 6) for m in path.of_kind(MoveKind.CUT)}
    assert heights == {0.0, 0.5, 1.0, 1.5}
    found = replayed(path, setup, part, tmp_path, 0.2, excess_mm=0.6)
    assert found.worst_gouge_mm < 0.005
    # steps of 0.5 mm on a tube of 2 mm radius, and fillets that a flat tool cannot reach
    assert found.worst_excess_mm < 0.5


def test_contours_are_the_outlines_at_the_radius() -> None:
    path, _ = made(box((0, 0, -2), (8, 8, 0)), strategy="contour", tool="flat 4", stock_mm=(-6, -6, -2, 14, 14, 0))
    rings = [m.points_mm for m in path.of_kind(MoveKind.CUT)]
    assert len(rings) == 2
    for ring in rings:
        gap = np.maximum(np.abs(ring[:, :2] - 4.0) - 4.0, 0.0)
        assert np.hypot(*gap.T) == pytest.approx(2.0, abs=0.002)


@pytest.mark.parametrize(("tool", "entry", "climb"), [("flat 4", "helix", True), ("ball 4", "ramp", False)])
def test_a_pocket_is_cleared_without_a_gouge(tmp_path: Path, tool: str, entry: str, climb: bool) -> None:
    part = pocket(9.0, 6.0, -2.0, -4.0)
    path, setup = made(
        part,
        strategy="contour",
        tool=tool,
        axial_depth_mm=1.0,
        layers=0,
        floor_z_mm=-2.0,
        overhang_mm=0.0,
        entry=entry,
        helix_mm=1.0,
        ramp_deg=10.0,
        climb=climb,
        arcs_mm=0.002,
        radial_depth_mm=1.5,
    )
    assert any(True for _ in path.of_kind(MoveKind(entry)))
    found = replayed(path, setup, part, tmp_path, 0.2, excess_mm=1.0)
    assert found.worst_gouge_mm < 0.003
    # a flat tool leaves material in the four vertical corners, a ball in those and along the floor
    corner = 2.0 * (math.sqrt(2.0) - 1.0)
    assert 0.5 * corner < found.worst_excess_mm < (corner if tool == "flat 4" else 2.0 * (math.sqrt(3.0) - 1.0)) + 0.05
    walls = [m.points_mm for m in path.of_kind(MoveKind.CUT) if m.points_mm[0, 2] == -2.0]
    reach = max(float(np.abs(w[:, :2]).max()) for w in walls)
    assert reach == pytest.approx(4.0, abs=0.003)


def test_a_tool_larger_than_any_pocket_cuts_nothing() -> None:
    pocket = prism([(0, -3), (10, -3), (10, 0), (6.5, 0), (6.5, -2), (3.5, -2), (3.5, 0), (0, 0)], 0.0, 6.0)
    path, _ = made(pocket, strategy="contour", tool="flat 4", overhang_mm=0.0, floor_z_mm=-2.0)
    assert path.empty and path.moves == ()


@pytest.mark.parametrize(
    ("values", "error", "message"),
    [
        ({"tool": "drill 8"}, ToolError, 'tool "drill 8"'),
        ({"tool": "taper 4 a5"}, ToolPathError, "expected one of these, or exact = true"),
        ({"stepover_mm": 5.0}, ToolPathError, "stepover_mm = 5: expected at most 4, the diameter"),
        ({"safe_z_mm": 0.0}, ToolPathError, "safe_z_mm = 0: expected at least"),
        ({"pitch_mm": 1e-7}, StockError, "slice pitch"),
        (
            {"strategy": "contour", "layers": 0, "radial_depth_mm": 3.0},
            ToolPathError,
            "radial_depth_mm = 3: expected at most 2, the radius, for layers that clear an area",
        ),
    ],
)
def test_settings_that_do_not_fit_are_refused(values: dict[str, Any], error: type[Exception], message: str) -> None:
    with pytest.raises(error, match=message):
        made(prism(SLOPE, 0.0, 6.0), **({"strategy": "scan"} | values))


@pytest.mark.parametrize(
    ("values", "message"),
    [
        (
            {"stepover_mm": 0.0},
            r"a.toml: stepover_mm = 0.0: expected a number above 0 \(scan: stepover, the distance between rows\)",
        ),
        ({"allowance_mm": -1.0}, r"allowance_mm = -1.0: expected a number at least 0"),
        ({"stepovr_mm": 1.0}, "stepovr_mm: unknown key; did you mean stepover_mm"),
        ({"region_mm": [0, 0, 1]}, "region_mm = .* expected a list of four numbers"),
        ({"region_mm": [5, 0, 1, 3]}, "region_mm must have its lower corner first"),
        ({"layers": 0}, "layers must be at least 1 for a scan"),
        ({"strategy": "contour", "exact": True}, "exact is for scans"),
        ({"direction": "z"}, 'direction = "z": expected one of "x", "y"'),
        ({"tool": 8}, "tool = 8: expected text"),
    ],
)
def test_mistakes_in_settings_name_key_value_and_what_is_allowed(values: dict[str, Any], message: str) -> None:
    with pytest.raises(SettingsError, match=message):
        checked(PathSettings, {"strategy": "scan", "tool": "ball 8", **values}, "a.toml")


def test_rest_material_determines_where_rapids_end() -> None:
    values = {"strategy": "scan", "stepover_mm": 2.0, "zigzag": False, "climb": False, "region_mm": (4, 1, 12, 5)}
    whole, setup = made(prism(SLOPE, 0.0, 6.0), **values)
    known, _ = made(prism(SLOPE, 0.0, 6.0), **values, remaining_mm=0.3)
    downs = [[m.end_mm[2] for m in p.of_kind(MoveKind.RAPID) if m.end_mm[2] < m.start_mm[2]] for p in (whole, known)]
    assert min(downs[0]) >= float(setup.stock_mm[1, 2])
    # one row begins over the floor and has 0.3 mm over it, and the clearance of 1 mm over that
    assert min(downs[1]) == pytest.approx(1.3, abs=0.1)


def test_the_bound_of_a_pitch_is_that_of_the_slope() -> None:
    part, ball = prism(SLOPE, 0.0, 6.0), parse_tool("ball 4")
    # slices normal to x meet the slope at pitch / cos(30 deg)
    apart = 0.5 / math.cos(math.radians(DEG))
    assert sag_mm(part, ball, slice_part(part, 0.5).sections(0)) == pytest.approx(
        2.0 - math.sqrt(4.0 - 0.25 * apart**2), rel=1e-6
    )
    # faces along the axis are the same on all slices, those across it are exact
    cube = box((0, 0, 0), (1, 1, 1))
    assert sag_mm(cube, ball, slice_part(cube, 0.5).sections(2)) == 0.0
    # a face that lies nearly across the axis is known to the pitch
    flat = prism([(0, -2), (20, -2), (20, 0.2), (0, 0)], 0.0, 20.0)
    assert sag_mm(flat, ball, slice_part(flat, 0.05).sections(2)) == pytest.approx(0.05, rel=1e-3)
