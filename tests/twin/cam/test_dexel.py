"""Dexels against closed forms, dense positions, the tri-slice model, and their laws."""

from __future__ import annotations

import math
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from support.golden_section import underside

from gcode.flow.interpreter import interpret
from twin.arrays import FloatArray
from twin.cam.path.toolpath import Move as PathMove
from twin.cam.path.toolpath import MoveKind, ToolPath
from twin.cam.stock.dexel import Dexels
from twin.cam.stock.strokes import CHORD_MM, Strokes
from twin.errors import StockError
from twin.motion.from_nc import moves_from_nc
from twin.motion.path import Arc, Move
from twin.motion.sweep import Body, Sweep
from twin.tolerance import Tolerance
from twin.tools.shape import ToolShape
from twin.tools.text import parse_tool
from twin.workpiece.removal import Removal
from twin.workpiece.stock import box_slices
from twin.workpiece.trislice import CellSlices

TOOLS = ("ball 4", "flat 3", "bull 4 r0.7", "bull 4 r1.6", "taper 2 r0.5 a15", "taper 2 r1 a30", "taper 1 a20")
PATH = np.array(
    [
        (1.0, 1.0, 1.5),
        (8.0, 1.5, 1.5),
        (8.0, 1.5, -0.7),
        (6.5, 6.0, 0.4),
        (6.5, 6.0, 3.0),
        (-0.5, 3.1, -0.4),
        (2.2, 2.7, -1.0),
        (2.3, 7.7, 2.9),
    ]
)


def stock(pitch_mm: float = 0.31, top_mm: float = 4.0, floor_mm: float = -2.0) -> Dexels:
    return Dexels((0.0, 0.0), (10.0, 8.0), pitch_mm, top_mm, floor_mm)


def by_positions(dexels: Dexels, tool: ToolShape, positions: FloatArray) -> FloatArray:
    """Heights after the tool stood at many places, by the definition alone."""
    points, heights = dexels.points_mm, dexels.heights_mm.ravel().copy()
    for part in np.array_split(positions, max(1, len(positions) // 100)):
        away = np.hypot(points[:, None, 0] - part[:, 0], points[:, None, 1] - part[:, 1])
        inside = away <= tool.max_radius_mm
        heights = np.minimum(heights, np.where(inside, part[:, 2] + underside(tool, away), np.inf).min(axis=1))
    return np.maximum(heights, dexels.floor_mm).reshape(dexels.heights_mm.shape)


@pytest.mark.parametrize("text", TOOLS)
def test_a_plunge_leaves_the_meridian(text: str) -> None:
    tool, dexels = parse_tool(text), stock()
    expected = by_positions(dexels, tool, np.array([(4.2, 3.7, -0.5)]))
    dexels.cut(tool, Strokes.through([(4.2, 3.7, 3.0), (4.2, 3.7, -0.5)]))
    assert dexels.heights_mm == pytest.approx(expected, abs=1e-12)


@pytest.mark.parametrize("text", TOOLS)
def test_slanted_motions_leave_the_envelope_of_all_positions(text: str) -> None:
    tool, dexels = parse_tool(text), stock()
    parts = np.linspace(0.0, 1.0, 801)[:, None]
    positions = np.concatenate([a + parts * (b - a) for a, b in pairwise(PATH)])
    dense = by_positions(dexels, tool, positions)
    dexels.cut(tool, Strokes.through(PATH))
    # positions are 0.01 mm apart: a rounded underside stands off by its curve, a sharp edge by the slope times that
    assert (dexels.heights_mm <= dense + 1e-12).all()
    off = (dense - dexels.heights_mm).ravel()
    assert np.sort(off)[:-8].max() < (5e-3 if tool.corner_radius_mm == 0.0 else 5e-4)


def test_a_ball_slot_has_its_closed_form() -> None:
    dexels = Dexels((0.0, -6.0), (20.0, 6.0), 0.1, 0.0, -4.0)
    dexels.cut(parse_tool("ball 8"), Strokes.through([(-6.0, 0.0, -2.0), (26.0, 0.0, -2.0)]))
    y = dexels.y_mm
    expected = np.minimum(0.0, np.where(np.abs(y) < 4.0, 2.0 - np.sqrt(np.maximum(16.0 - y * y, 0.0)), 0.0))
    assert np.abs(dexels.heights_mm - expected).max() < 1e-12
    segment = 16.0 * math.acos(0.5) - 2.0 * math.sqrt(12.0)
    removed = -dexels.heights_mm.sum() * dexels.cell_mm2
    assert removed == pytest.approx(20.0 * segment, rel=2e-4)


def test_a_climbing_ball_leaves_a_slanted_cylinder() -> None:
    # across a motion at an angle the ball's trace is a circle seen from the side: R sqrt(1 + m m) instead of R
    slope = 0.6
    dexels = Dexels((0.0, -3.0), (20.0, 3.0), 0.25, 50.0)
    dexels.cut(parse_tool("ball 8"), Strokes.through([(-30.0, 0.0, -18.0), (50.0, 0.0, 30.0)]))
    x, y = np.meshgrid(dexels.x_mm, dexels.y_mm, indexing="ij")
    expected = slope * x + 4.0 - np.sqrt(16.0 - y * y) * math.hypot(1.0, slope)
    assert dexels.heights_mm == pytest.approx(expected, abs=1e-12)


def test_removed_volumes_of_a_flat_tool_are_within_the_borders_dexels() -> None:
    dexels = stock(0.05, top_mm=0.0)
    before = dexels.volume_above_mm3(dexels.floor_mm)
    dexels.cut(parse_tool("flat 3"), Strokes.through([(3.0, 4.0, -1.5), (7.0, 4.0, -1.5)]))
    removed = before - dexels.volume_above_mm3(dexels.floor_mm)
    border = 8.0 + 3.0 * math.pi
    assert abs(removed - 1.5 * (4.0 * 3.0 + math.pi * 1.5**2)) < 1.5 * border * 0.05 * 0.5


@pytest.mark.parametrize("text", TOOLS)
def test_order_and_threads_do_not_change_a_bit(text: str) -> None:
    tool = parse_tool(text)
    parts = np.linspace(0.0, 1.0, 21)
    dense = np.concatenate([a + parts[:-1, None] * (b - a) for a, b in pairwise(PATH)] + [PATH[-1:]])
    starts, ends = dense[:-1], dense[1:]
    found = []
    for order, threads in ((slice(None), 1), (slice(None, None, -1), 1), (slice(None), 2)):
        dexels = stock(0.13)
        dexels.cut(tool, Strokes(starts[order].copy(), ends[order].copy(), np.empty((0, 8))), threads)
        found.append(dexels.heights_mm)
    assert np.array_equal(found[0], found[2])
    assert np.array_equal(found[0], found[1])


@settings(max_examples=30, deadline=None)
@given(text=st.sampled_from(TOOLS), part=st.floats(0.01, 0.99), seed=st.integers(0, 1000))
def test_a_motion_in_two_parts_leaves_the_same(text: str, part: float, seed: int) -> None:
    tool, rng = parse_tool(text), np.random.default_rng(seed)
    a, b = rng.uniform((0.0, 0.0, -1.0), (10.0, 8.0, 2.0), (2, 3))
    whole, halves = stock(), stock()
    whole.cut(tool, Strokes.through([a, b]))
    halves.cut(tool, Strokes.through([a, a + part * (b - a), b]))
    # where the side of a tool just reaches a dexel, or not, rounding decides
    off = np.sort(np.abs(whole.heights_mm - halves.heights_mm).ravel())
    assert off[:-2].max() < 1e-9


@pytest.mark.parametrize("text", TOOLS)
@pytest.mark.parametrize("sweep", [1.0, -2.5, 2.0 * math.pi])
def test_level_arcs_are_exact(text: str, sweep: float) -> None:
    tool, dexels = parse_tool(text), stock()
    angle = 0.4 + sweep * np.linspace(0.0, 1.0, 6001)
    path = np.column_stack((5.0 + 2.7 * np.cos(angle), 4.0 + 2.7 * np.sin(angle), np.full(6001, 0.5)))
    dense = by_positions(dexels, tool, path)
    dexels.cut(tool, Strokes.of_moves([arc_move(path[0], path[-1], (5.0, 4.0, 0.5), sweep)]))
    off = np.sort((dense - dexels.heights_mm).ravel())
    assert off[0] > -1e-7
    assert off[:-4].max() < 1e-4


def test_arcs_of_any_part_of_a_circle() -> None:
    tool, rng = parse_tool("bull 2 r0.4"), np.random.default_rng(15)
    arcs, lines = stock(), stock()
    for _ in range(40):
        centre, radius = rng.uniform((-4.0, -4.0), (14.0, 12.0)), rng.uniform(0.3, 9.0)
        begin, sweep, z = rng.uniform(-4.0, 4.0), rng.uniform(-6.0, 6.0), rng.uniform(-1.0, 3.0)
        angle = begin + sweep * np.linspace(0.0, 1.0, 3001)
        path = np.column_stack(
            (centre[0] + radius * np.cos(angle), centre[1] + radius * np.sin(angle), 0.0 * angle + z)
        )
        arcs.cut(tool, Strokes.of_moves([arc_move(path[0], path[-1], (*centre, z), sweep)]))
        lines.cut(tool, Strokes.through(path))
    off = np.sort(np.abs(arcs.heights_mm - lines.heights_mm).ravel())
    assert off[:-6].max() < 1e-4
    assert (arcs.heights_mm < 4.0).mean() > 0.5


def arc_move(start: FloatArray, end: FloatArray, centre: tuple[float, float, float], sweep: float) -> Move:
    return Move(
        start_mm=start,
        end_mm=end,
        arc=Arc(centre_mm=np.array(centre), plane=17, sweep_rad=sweep),
        duration_s=1.0,
        feed_mm_min=100.0,
        spindle_rpm=1.0,
        tool=1,
        rapid=False,
        nc_line=1,
    )


def test_a_helix_is_cut_by_chords_within_the_tolerance() -> None:
    tool = parse_tool("ball 4")
    move = arc_move(np.array([7.0, 4.0, 1.0]), np.array([7.0, 4.0, -1.0]), (5.0, 4.0, 1.0), 4.0 * math.pi)
    strokes = Strokes.of_moves([move])
    assert len(strokes.arcs) == 0
    fine, coarse = stock(), stock()
    fine.cut(tool, Strokes.of_moves([move], 1e-7))
    coarse.cut(tool, strokes)
    # tangents of the ball's side that are cut are less steep than 80 degrees here
    steep = 1.0 / math.cos(math.radians(80.0))
    off = np.sort(np.abs(fine.heights_mm - coarse.heights_mm).ravel())
    assert off[:-4].max() < CHORD_MM * steep


def test_strokes_of_a_tool_path_are_those_of_its_program() -> None:
    points = np.array([(1.0, 1.0, 0.0), (4.0, 1.0, -0.5), (4.0, 5.0, -0.5)])
    end = np.array([4.0, 7.0, -0.5])
    arc = Arc(centre_mm=np.array([4.0, 6.0, -0.5]), plane=17, sweep_rad=math.pi)
    path = ToolPath(
        moves=(
            PathMove(kind=MoveKind.CUT, points_mm=points, feed_mm_min=100.0),
            PathMove(kind=MoveKind.CUT, points_mm=np.array([points[-1], end]), feed_mm_min=100.0, arc=arc),
        ),
        tool=parse_tool("ball 4"),
    )
    program = "G90 G21 G17 G1 F100\nX1. Y1. Z0.\nX4. Y1. Z-0.5\nX4. Y5.\nG3 X4. Y7. I0. J1.\nM30\n"
    moves = moves_from_nc(
        interpret(program), origin_mm=np.zeros(3), start_mm=(1.0, 1.0, 0.0), tool_length_mm={}, rapid_mm_min=1000.0
    )
    own, read = stock(), stock()
    own.cut(path.tool, Strokes.of_path(path))
    read.cut(path.tool, Strokes.of_moves([m for m in moves if isinstance(m, Move)][1:]))
    assert len(Strokes.of_path(path).arcs) == 1
    assert np.abs(own.heights_mm - read.heights_mm).max() < 1e-9
    assert own.heights_mm.min() < 0.0


def test_programs_of_several_tools() -> None:
    def line(tool: int, y: float) -> Move:
        start, end = np.array([1.0, y, 0.5]), np.array([9.0, y, 0.5])
        return Move(
            start_mm=start,
            end_mm=end,
            duration_s=1.0,
            feed_mm_min=9.0,
            spindle_rpm=1.0,
            tool=tool,
            rapid=False,
            nc_line=1,
        )

    tools = {1: parse_tool("flat 2"), 2: parse_tool("ball 2")}
    together, apart = stock(), stock()
    together.cut_moves([line(1, 2.0), line(2, 6.0), line(1, 3.0), line(0, 4.0)], tools)
    apart.cut(tools[1], Strokes.through([(1.0, 2.0, 0.5), (9.0, 2.0, 0.5)]))
    apart.cut(tools[1], Strokes.through([(1.0, 3.0, 0.5), (9.0, 3.0, 0.5)]))
    apart.cut(tools[2], Strokes.through([(1.0, 6.0, 0.5), (9.0, 6.0, 0.5)]))
    assert np.array_equal(together.heights_mm, apart.heights_mm)
    assert together.heights_mm.min() == 0.5


@pytest.mark.parametrize("text", ["ball 4", "flat 3", "bull 4 r0.7"])
def test_the_tri_slice_model_leaves_the_same(text: str) -> None:
    tool = parse_tool(text, flute_length_mm=12.0)
    tolerance = Tolerance.for_pitch(0.2)
    piece = CellSlices(box_slices((0.0, 0.0, -2.0), (10.0, 8.0, 4.0), 0.2))
    with Removal(piece, tolerance.chord_mm) as removal:
        for a, b in pairwise(PATH):
            removal.cut(Sweep(Body.of(tool, chord_mm=tolerance.chord_mm), a, b))
    dexels = stock(0.2)
    dexels.cut(tool, Strokes.through(PATH))
    tops = np.empty_like(dexels.heights_mm)
    for i in range(len(tops)):
        lines = piece.line_ends(0, np.array([i]), 0, dexels.y_mm, (-9.0, 9.0))
        ends = [lines.ends_mm[a:b] for a, b in zip(lines.offsets[:-1], lines.offsets[1:], strict=True)]
        tops[i] = [e[-1] if len(e) else -2.0 for e in ends]
    # slices are cut by tools that are larger by a chord tolerance: on slopes that shows more, at walls most
    off = dexels.heights_mm - tops
    assert np.quantile(np.abs(off), 0.97) < 6.0 * tolerance.chord_mm
    assert off.min() > -4.0 * tolerance.chord_mm
    # walls lie anywhere in a dexel's cell: half a pitch along 40 mm of borders 2 mm deep, with errors of both signs
    assert dexels.volume_above_mm3(-2.0) == pytest.approx(piece.volume_mm3(0), abs=2.0)


def test_a_floor_stops_and_a_plan_ends() -> None:
    dexels = stock(floor_mm=0.5)
    dexels.cut(parse_tool("flat 3"), Strokes.through([(-20.0, 4.0, -9.0), (30.0, 4.0, -9.0)]))
    assert dexels.heights_mm.min() == 0.5
    dexels.cut(parse_tool("ball 4"), Strokes.through([(50.0, 50.0, -9.0), (90.0, 90.0, -9.0)]))
    assert dexels.heights_mm.max() == 4.0


def test_a_copy_is_its_own() -> None:
    first = stock()
    second = first.copy()
    second.cut(parse_tool("flat 3"), Strokes.through([(5.0, 4.0, 0.0)]))
    assert first.heights_mm.min() == 4.0
    assert second.heights_mm.min() == 0.0


def test_stock_of_any_top() -> None:
    top = np.arange(33 * 26, dtype=float).reshape(33, 26)
    dexels = Dexels((0.0, 0.0), (10.0, 8.0), 0.31, top)
    assert np.array_equal(dexels.heights_mm, top)
    dexels.cut(parse_tool("flat 1"), Strokes.through([(5.0, 0.0, 100.0), (5.0, 8.0, 100.0)]))
    near = np.abs(dexels.x_mm - 5.0) <= 0.5
    assert dexels.heights_mm[near].max() == 100.0
    assert np.array_equal(dexels.heights_mm[~near], top[~near])


@pytest.mark.parametrize(
    ("values", "message"),
    [
        ({"high_mm": (0.0, 8.0)}, "expected an extent above 0"),
        ({"pitch_mm": 0.0}, "dexels: pitch_mm = 0; expected a number above 0"),
        ({"pitch_mm": math.nan}, "dexels: pitch_mm = nan; expected a number above 0"),
        ({"pitch_mm": 1e-5}, "dexels: pitch_mm = 1e-05 makes 1000000 x 800000 dexels; expected at most 400000000"),
        ({"floor_mm": 9.0}, "dexels: top_mm below floor_mm = 9; expected a top not below the floor"),
    ],
)
def test_stock_that_cannot_be_is_refused(values: dict[str, object], message: str) -> None:
    arguments = {"low_mm": (0.0, 0.0), "high_mm": (10.0, 8.0), "pitch_mm": 0.5, "top_mm": 1.0, "floor_mm": 0.0} | values
    with pytest.raises(StockError) as error:
        Dexels(**arguments)  # type: ignore[arg-type]
    assert message in str(error.value)


def test_the_lowest_strokes_are_cut_first() -> None:
    lines = Strokes.through([(0.0, 0.0, 3.0), (1.0, 0.0, 2.0), (2.0, 0.0, 2.5), (3.0, 0.0, -1.0)])
    arcs = np.arange(24.0).reshape(3, 8)[::-1]
    ordered = Strokes(lines.starts_mm, lines.ends_mm, arcs).from_lowest()
    assert ordered.starts_mm[:, 0].tolist() == [2.0, 0.0, 1.0]
    assert ordered.ends_mm[:, 2].tolist() == [-1.0, 2.0, 2.5]
    assert np.array_equal(ordered.arcs, arcs[::-1])
