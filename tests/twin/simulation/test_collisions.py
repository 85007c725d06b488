"""Collisions: reported from a stated depth on, whatever the pictures and the division of motions; paths of rapids."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

from twin.job import job_from_dict
from twin.record import Collision
from twin.simulation.replay import Replay

HEAD = "G21 G90 G54\nS1000 M3\nG0 X-20. Y20. Z5.\n"
FLAT: dict[str, Any] = {"number": 1, "kind": "flat", "diameter_mm": 10.0, "teeth": 2, "flute_length_mm": 25.0}
FINENESS = {
    "slice_pitch_mm": 0.2,
    "step_mm": 5.0,
    "axial_step_mm": 2.0,
    "angle_step_deg": 10.0,
    "preview_pitch_mm": 4.0,
}
BLOCK = {"min": [0, 0, -20], "max": [60, 40, 0]}


def collisions(folder: Path, blocks: str, *, preview: bool = True, **changes: Any) -> list[Collision]:
    """The collisions of a program in a block, without forces."""
    (folder / "p.nc").write_text(HEAD + blocks + "\nM30\n")
    data: dict[str, Any] = {
        "program": {"file": "p.nc", "tool": 1},
        "stock": {"box_mm": BLOCK},
        "tools": [FLAT],
        "simulation": FINENESS,
    }
    with Replay(job_from_dict(data | changes, folder), preview=preview) as replay:
        return [record for record in replay if isinstance(record, Collision)]


@pytest.mark.parametrize("preview", [True, False])
@pytest.mark.parametrize(
    "shape",
    [
        {},
        {"kind": "ball"},
        {"kind": "bull", "corner_radius_mm": 1.0},
        {"kind": "taper", "taper_deg": 10.0, "flute_length_mm": 20.0},
    ],
    ids=lambda shape: shape.get("kind", "flat"),
)
def test_a_rapid_back_through_its_own_slot_is_none(tmp_path: Path, preview: bool, shape: dict[str, Any]) -> None:
    program = "G1 X30. Y13. Z-8. F500\nX42. Z-9.\nG0 X30. Z-8.\nX-20. Y20. Z5."
    straight = {"rapid": "straight"}
    assert collisions(tmp_path, program, preview=preview, tools=[FLAT | shape], machine=straight) == []


def test_with_the_spindle_stopped_the_tool_may_go_back_along_an_arc(tmp_path: Path) -> None:
    program = "G1 Z-3. F500\nX20.\nG2 X30. Y10. R10.\nM5\nG3 X20. Y20. R10.\nG1 X-20."
    assert collisions(tmp_path, program) == []


@pytest.mark.parametrize("cuts", [1, 7])
@pytest.mark.parametrize(("y", "count"), [(-5.0, 0), (-4.997, 0), (-4.99, 1)])
def test_a_rapid_along_the_side_collides_from_the_clearance_on(tmp_path: Path, cuts: int, y: float, count: int) -> None:
    ends = "\n".join(f"X{-20.0 + 100.0 * (i + 1) / cuts:.4f}" for i in range(cuts))
    found = collisions(tmp_path, f"Y{y}\nZ-10.\n{ends}")
    assert bool(found) == bool(count)
    assert {c.kind for c in found} <= {"rapid"}


@pytest.mark.parametrize("depth", [0.003, 0.01])
def test_a_rapid_down_onto_the_stock_collides_from_the_clearance_on(tmp_path: Path, depth: float) -> None:
    assert bool(collisions(tmp_path, f"X30.\nZ{-depth}")) == (depth == 0.01)


def test_a_tool_without_shank_goes_on_above_its_flutes(tmp_path: Path) -> None:
    short = FLAT | {"flute_length_mm": 10.0}
    deep = "G1 Z-9. F500\nX30.\nX-20.\nZ-18.\nX30."
    assert collisions(tmp_path, deep, tools=[short]) == []  # along the wall that it cut itself
    found = collisions(tmp_path, "Z-18.\nG1 X30. F500\nX31.", tools=[short])
    assert [(c.kind, c.nc_line) for c in found] == [("shank", 5), ("shank", 6)]
    assert "above its flutes" in found[0].message
    given = short | {"shank": {"diameter_mm": 6.0, "length_mm": 30.0}}
    assert collisions(tmp_path, "Z-18.\nG1 X30. F500", tools=[given])[0].message.count("the shank touches")
    assert collisions(tmp_path, "Z-9.\nG1 X30. F500", tools=[short]) == []


#: A pillar between start and end of a rapid; the straight line misses it, the path of independent axes does not.
PILLAR = {"box_mm": {"min": [35, 35, -10], "max": [45, 45, 20]}}
DIAGONAL = "G0 X0. Y0. Z50.\nZ5.\nX100. Y40.\nZ50."


@pytest.mark.parametrize(
    ("dialect", "rapid", "hit"),
    [
        ("fanuc", None, True),
        ("haas", None, True),
        ("linuxcnc", None, False),
        ("grbl", None, False),
        ("haas", "straight", False),
        ("auto", None, True),
        ("linuxcnc", "independent", True),
    ],
)
def test_the_path_of_rapids_is_that_of_the_control(tmp_path: Path, dialect: str, rapid: str | None, hit: bool) -> None:
    program: dict[str, Any] = {"file": "p.nc", "dialect": dialect, "tool": 1}
    machine = {} if rapid is None else {"rapid": rapid}
    tool = FLAT | {"diameter_mm": 6.0}
    found = collisions(tmp_path, DIAGONAL, program=program, machine=machine, stock=PILLAR, tools=[tool])
    assert {(c.kind, c.nc_line) for c in found} == ({("rapid", 6)} if hit else set())
