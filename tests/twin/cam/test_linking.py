from __future__ import annotations

import math

import numpy as np
import pytest

from twin.arrays import FloatArray
from twin.cam.path.linking import LinkOptions, Pass, link
from twin.cam.path.toolpath import Move, MoveKind, ToolPath
from twin.tools.shape import tool_shape

TOOL = tool_shape("flat", 6.0, 20.0)


class FakePlanner:
    """All free, or nothing; links straight."""

    def __init__(self, free: bool = True) -> None:
        self._free = free

    def between(self, start_mm: FloatArray, end_mm: FloatArray) -> FloatArray | None:
        return np.array([start_mm, end_mm]) if self._free else None

    def free(self, points_mm: FloatArray) -> bool:
        return self._free

    def clear_z_mm(self, start_mm: FloatArray, end_mm: FloatArray) -> float:
        return 1.0


def row(y: float, z: float = -2.0, top: float | None = 0.0, layer: int = 0) -> Pass:
    return Pass(points_mm=np.array([(0.0, y, z), (40.0, y, z)]), top_mm=top, layer=layer)


def kinds(moves: tuple[Move, ...]) -> list[str]:
    return [m.kind.value for m in ToolPath(moves=moves, tool=TOOL).moves]


def test_a_plunge_begins_at_clearance_above_the_material() -> None:
    moves = link([row(0.0)], LinkOptions(safe_z_mm=10.0))
    assert kinds(moves) == ["rapid", "plunge", "cut", "rapid"]
    assert moves[0].start_mm[2] == 10.0 and moves[1].start_mm[2] == 1.0 and moves[1].feed_mm_min == 200.0
    assert moves[-1].end_mm[2] == 10.0


@pytest.mark.parametrize("entry", ["ramp", "helix"])
def test_ramps_and_helices_keep_their_angle_and_end_at_the_start(entry: str) -> None:
    options = LinkOptions(safe_z_mm=10.0, entry=entry, ramp_deg=5.0, helix_mm=2.0)  # type: ignore[arg-type]
    moves = link([row(0.0)], options, FakePlanner())
    assert kinds(moves) == ["rapid", "plunge", entry, "cut", "rapid"]
    down = moves[2]
    assert down.start_mm[2] == 0.0 and down.end_mm.tolist() == [0.0, 0.0, -2.0]
    slope = np.diff(down.chords_mm(1e-4)[:, 2]) / np.linalg.norm(np.diff(down.chords_mm(1e-4), axis=0), axis=1)
    assert np.degrees(np.arcsin(-slope)).max() <= 5.0 + 0.01
    assert slope.max() < 0.0


def test_a_helix_that_finds_no_room_becomes_a_ramp() -> None:
    moves = link([row(0.0)], LinkOptions(safe_z_mm=10.0, entry="helix"), FakePlanner(free=False))
    assert kinds(moves)[2] == "ramp"


def test_a_closed_pass_is_ramped_along_and_then_cut_whole() -> None:
    angle = np.linspace(0.0, 2.0 * math.pi, 361)
    ring = np.column_stack((5.0 * np.cos(angle), 5.0 * np.sin(angle), np.full(361, -1.0)))
    ring[-1] = ring[0]
    moves = link([Pass(points_mm=ring, top_mm=0.0)], LinkOptions(safe_z_mm=10.0, entry="ramp", ramp_deg=1.0))
    ramp, whole = moves[2], moves[3]
    assert ramp.kind is MoveKind.RAMP and ramp.length_mm == pytest.approx(1.0 / math.sin(math.radians(1.0)), rel=1e-4)
    assert whole.length_mm == pytest.approx(10.0 * math.pi, rel=1e-4)
    assert np.array_equal(whole.start_mm, whole.end_mm)
    assert np.allclose(np.hypot(*ramp.points_mm[:, :2].T), 5.0, atol=1e-3)


def test_neighbouring_passes_are_linked_along_the_surface_within_reach() -> None:
    passes = [row(0.0), Pass(points_mm=np.array([(40.0, 1.0, -2.0), (0.0, 1.0, -2.0)])), row(5.0)]
    moves = link(passes, LinkOptions(safe_z_mm=10.0, stay_down_mm=2.0, link_mm_min=900.0), FakePlanner())
    assert kinds(moves) == [
        "rapid",
        "plunge",
        "cut",
        "link",
        "cut",
        "rapid",
        "rapid",
        "rapid",
        "plunge",
        "cut",
        "rapid",
    ]
    assert moves[3].feed_mm_min == 900.0


def test_layers_are_never_linked_along_the_surface() -> None:
    passes = [row(0.0), Pass(points_mm=np.array([(40.0, 1.0, -2.0), (0.0, 1.0, -2.0)]), layer=1)]
    moves = link(passes, LinkOptions(safe_z_mm=10.0, stay_down_mm=2.0), FakePlanner())
    assert "link" not in kinds(moves)


def test_low_links_stay_at_clearance_above_what_is_left() -> None:
    moves = link([row(0.0), row(5.0)], LinkOptions(safe_z_mm=10.0, low_links=True), FakePlanner())
    between = [m for m in moves[3:-1] if m.rapid]
    assert max(m.points_mm[:, 2].max() for m in between) == 2.0


def test_leads_are_tangent_quarter_circles() -> None:
    moves = link([row(0.0, top=None)], LinkOptions(safe_z_mm=10.0, lead_mm=3.0, lead_mm_min=300.0), FakePlanner())
    assert kinds(moves) == ["rapid", "plunge", "lead", "cut", "lead", "rapid"]
    lead = moves[2]
    assert lead.feed_mm_min == 300.0
    assert lead.length_mm == pytest.approx(1.5 * math.pi, rel=1e-3)
    last = lead.points_mm[-1] - lead.points_mm[-2]
    assert math.degrees(math.atan2(abs(last[1]), last[0])) < 4.0
    assert np.all(lead.points_mm[:, 2] == -2.0)


def test_a_pass_may_be_approached_through_air() -> None:
    one = Pass(
        points_mm=np.array([(0.0, 0.0, -2.0), (9.0, 0.0, -2.0)]), top_mm=0.0, approach_mm=np.array([-5.0, 0, -2])
    )
    moves = link([one], LinkOptions(safe_z_mm=10.0, entry="ramp"))
    assert kinds(moves) == ["rapid", "plunge", "lead", "cut", "rapid"]
    assert moves[1].end_mm.tolist() == [-5.0, 0.0, -2.0]


def test_a_safe_height_below_a_pass_is_refused() -> None:
    with pytest.raises(ValueError, match="safe_z_mm must be at least 3, the height of the highest pass: 2"):
        link([row(0.0, z=3.0)], LinkOptions(safe_z_mm=2.0))


@pytest.mark.parametrize("values", [{"clearance_mm": 0.0}, {"ramp_deg": 90.0}, {"feed_mm_min": -1.0}])
def test_options_that_cannot_be(values: dict[str, float]) -> None:
    with pytest.raises(ValueError, match="must be"):
        LinkOptions(safe_z_mm=1.0, **values)  # type: ignore[arg-type]
