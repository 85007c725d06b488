"""Rapids and links of molds with thin walls, pins and ribs between the stock's dexels clear part and stock."""

from __future__ import annotations

import math
from functools import cache
from itertools import pairwise
from typing import Any

import numpy as np
import pytest
import trimesh

from twin.arrays import FloatArray
from twin.cam.passes.clear_moves import ClearOptions, part_obstacle, with_clear_moves
from twin.cam.path.toolpath import Move, MoveKind, ToolPath, rapids
from twin.cam.stock.dexel import Dexels
from twin.cam.stock.rest import allowed_heights, grown, stock_heights
from twin.cam.stock.strokes import Strokes
from twin.cam.surface.surface import Surface, surface_of
from twin.moldmaking import STAGES, MoldPlan, mold_from_dict
from twin.tools.text import parse_tool
from twin.workpiece.solids.from_mesh import solid, stl_bytes

#: Distance of the points that moves are checked at, mm, and what rounding may take.
STEP, ROUNDING = 0.05, 1e-6


def box(low: tuple[float, float, float], high: tuple[float, float, float]) -> FloatArray:
    return np.array(trimesh.creation.box(bounds=[low, high]).triangles)


def ribbed() -> FloatArray:
    """A plate with a wall and a rib of 0.1 mm and two pins of 0.16 mm, none of which holds a dexel's centre."""
    pin = [box((x, y, 2.0), (x + 0.16, y + 0.16, z)) for x, y, z in ((6.52, 10.12, 7.0), (11.32, 4.12, 5.0))]
    thin = [box((0.0, 7.72, 2.0), (9.0, 7.82, 6.0)), box((14.12, 0.5, 2.0), (14.22, 13.0, 8.0))]
    return np.concatenate([box((0.0, 0.0, 0.0), (18.0, 14.0, 3.0)), *pin, *thin])


def points(moves: list[Move], step: float = STEP) -> FloatArray:
    """Tips along moves."""
    found = []
    for move in moves:
        for a, b in pairwise(move.chords_mm(1e-4)):
            share = np.linspace(0.0, 1.0, max(1, math.ceil(float(np.linalg.norm(b - a)) / step)) + 1)[:, None]
            found.append(a * (1.0 - share) + b * share)
    return np.concatenate([np.empty((0, 3)), *found])


def deepest_mm(path: ToolPath, surface: Surface, allowance: float, kind: MoveKind) -> float:
    """How far a rapid or link comes below the exact height of the tip."""
    at = points(list(path.of_kind(kind)))
    if not len(at):
        return -math.inf
    return float((allowed_heights(surface, path.tool, at[:, :2], allowance) - at[:, 2]).max())


def rises(move: Move) -> bool:
    return bool(np.all(move.start_mm[:2] == move.end_mm[:2]) and move.end_mm[2] > move.start_mm[2])


def into_stock_mm(path: ToolPath, stock: Dexels) -> float:
    """How far a rapid comes below the stock as it is then, the tool enlarged by half the grid's diagonal."""
    half = 0.5 * math.hypot(*stock.pitch_mm)
    worst, waiting = -math.inf, list[Move]()
    for move in path.moves:
        if move.rapid and not rises(move):
            stock.cut(path.tool, Strokes.of_path(ToolPath(moves=tuple(waiting), tool=path.tool)))
            waiting.clear()
            at = points([move], 0.2)
            worst = max(worst, float((stock_heights(stock, grown(path.tool, half), at[:, :2]) + half - at[:, 2]).max()))
        waiting.append(move)
    return worst


@pytest.fixture(scope="module")
def thin_plan(tmp_path_factory: pytest.TempPathFactory) -> MoldPlan:
    folder = tmp_path_factory.mktemp("thin")
    part = solid(ribbed(), "ribs")
    (folder / "ribs.stl").write_bytes(stl_bytes(part.vertices_mm, part.triangles))
    common: dict[str, Any] = {"spindle_rpm": 8000, "feed_mm_min": 2000, "plunge_mm_min": 500}
    tool = {"teeth": 2, "flute_length_mm": 15.0, "length_mm": 90.0}
    tables = {
        "part": {"stl": "ribs.stl"},
        "machine": {"clearance_mm": 0.2},
        "tools": [
            tool | {"number": 1, "kind": "bull", "diameter_mm": 4.0, "corner_radius_mm": 0.5},
            tool | {"number": 2, "kind": "ball", "diameter_mm": 3.0},
        ],
        "rough": common | {"tool": 1, "axial_depth_mm": 1.5, "radial_depth_mm": 1.8, "allowance_mm": 0.2},
        "semi": common
        | {"tool": 2, "axial_depth_mm": 0.8, "radial_depth_mm": 1.2, "allowance_mm": 0.1}
        | {"method": "greedy"},
        "finish": common | {"tool": 2, "stepover_mm": 0.6, "steep_deg": 55.0},
        "output": {"dexel_mm": 0.4},
    }
    return MoldPlan(mold_from_dict(tables, folder))


@pytest.mark.parametrize("name", STAGES)
def test_rapids_and_links_of_every_stage_clear_part_and_stock(thin_plan: MoldPlan, name: Any) -> None:
    path = thin_plan.stage(name).path
    allowance = {"rough": 0.2, "semi": 0.1, "finish": 0.0}[name]
    assert deepest_mm(path, thin_plan.surface, allowance, MoveKind.RAPID) <= ROUNDING
    assert deepest_mm(path, thin_plan.surface, allowance, MoveKind.LINK) <= ROUNDING
    before = {"rough": thin_plan.fresh_stock, "semi": lambda: thin_plan.rough.stock.copy()}
    assert into_stock_mm(path, before.get(name, lambda: thin_plan.semi.stock.copy())()) <= 1e-3


TOOL = parse_tool("ball 4")
OPTIONS = ClearOptions(safe_z_mm=20.0, clearance_mm=0.5, feed_mm_min=1000.0)


def over(z: float, kind: MoveKind = MoveKind.RAPID) -> ToolPath:
    """From a cut at one side of a pin across it to a cut at the other side."""
    left, right = np.array([-6.0, 0.03, 1.0]), np.array([6.0, 0.03, 1.0])
    high = np.array([[*left[:2], z], [*right[:2], z]])
    line = np.vstack((left, high, right))
    across = rapids(line) if kind is MoveKind.RAPID else (Move(kind=kind, points_mm=line, feed_mm_min=900.0),)
    aside = np.array([2.0, 0.0, 0.0])
    cuts = [np.array([left - aside, left]), np.array([right, right + aside])]
    before, after = (Move(kind=MoveKind.CUT, points_mm=p, feed_mm_min=600.0) for p in cuts)
    return ToolPath(moves=(before, *across, after), tool=TOOL)


@cache
def pin() -> Surface:
    """A plate with a pin upon it."""
    return surface_of(np.concatenate((box((-10, -10, -1), (10, 10, 0)), box((-0.05, -0.05, 0), (0.05, 0.05, 6)))))


@pytest.mark.parametrize("allowance", [0.0, 0.25])
def test_a_rapid_through_a_pin_is_raised_by_the_clearance(allowance: float) -> None:
    part = part_obstacle(pin(), TOOL, allowance)
    path = with_clear_moves(over(4.0), OPTIONS, part)
    z = path.moves[2].start_mm[2]
    assert 6.5 + allowance <= z <= 7.1 + allowance
    assert [m.kind for m in path.moves] == [m.kind for m in over(4.0).moves]
    assert with_clear_moves(path, OPTIONS, part) is path


def test_a_link_through_a_pin_goes_over_it() -> None:
    path = with_clear_moves(over(1.0, MoveKind.LINK), OPTIONS, part_obstacle(pin(), TOOL, 0.0))
    (link,) = path.of_kind(MoveKind.LINK)
    assert link.feed_mm_min == 900.0
    assert 6.0 <= link.points_mm[:, 2].max() <= 6.01
    assert deepest_mm(path, pin(), 0.0, MoveKind.LINK) <= ROUNDING


def test_a_clear_path_is_returned_as_is() -> None:
    path = over(6.001)
    assert with_clear_moves(path, OPTIONS, part_obstacle(pin(), TOOL, 0.0)) is path


def test_a_rapid_down_next_to_a_wall_of_the_stock_ends_above_it() -> None:
    """The dexel nearest to the wall is 0.2 mm away from the tool, closer than half the grid's diagonal."""
    stock = Dexels((-10.0, -10.0), (10.0, 10.0), 0.4, 0.0, -5.0)
    stock.heights_mm[stock.x_mm > 8.15, :] = 5.0
    stock = Dexels((-10.0, -10.0), (10.0, 10.0), 0.4, stock.heights_mm, -5.0)
    path = with_clear_moves(over(8.0), OPTIONS, part_obstacle(pin(), TOOL, 0.0), stock)
    down, plunge = path.moves[-3:-1]
    assert down.rapid and plunge.kind is MoveKind.PLUNGE and plunge.feed_mm_min == 1000.0
    assert down.end_mm[2] == plunge.start_mm[2] > 3.0
    assert np.all(plunge.end_mm == (6.0, 0.03, 1.0))


def along_the_pin(x: float) -> ToolPath:
    """A cut along a side of the pin, with an allowance of 0.2 mm at X-2.25, and a rise from there."""
    cut = Move(kind=MoveKind.CUT, points_mm=np.array([[x, -5.0, 1.0], [x, 0.0, 1.0]]), feed_mm_min=600.0)
    return ToolPath(moves=(cut, *rapids(np.array([cut.end_mm, (x, 0.0, 15.0)]))), tool=TOOL)


@pytest.mark.parametrize("x", [-2.247, -2.25, -2.2503])
def test_a_rise_from_below_the_allowance_or_along_a_wall_begins_at_feed(x: float) -> None:
    """3 um too close to a wall of 6 mm; or so close that the rounding of the program may take the tool into it."""
    path, part = along_the_pin(x), part_obstacle(pin(), TOOL, 0.2)
    cut = path.moves[0]
    first, retract, rise = with_clear_moves(path, OPTIONS, part).moves
    assert first is cut and (retract.kind, retract.feed_mm_min) == (MoveKind.RETRACT, 1000.0)
    assert rise.rapid and rise.end_mm[2] == 15.0 and 3.5 < rise.start_mm[2] < 6.2
    assert deepest_mm(with_clear_moves(path, OPTIONS, part), pin(), 0.2, MoveKind.RAPID) <= ROUNDING


def test_a_rise_away_from_a_wall_is_left_as_is() -> None:
    path = along_the_pin(-2.252)
    assert with_clear_moves(path, OPTIONS, part_obstacle(pin(), TOOL, 0.2)) is path
