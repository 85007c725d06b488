"""Mold jobs: mistakes are all named at once; parts, stocks and tools that do not suit are refused or warned of."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from twin.errors import JobError, MeshError, StockError
from twin.moldmaking import MoldPlan, load_mold, mold_from_dict
from twin.moldmaking.checks import undercut_warnings
from twin.tool_library import LibraryTool
from twin.tool_library.formats.plain_csv import csv_text
from twin.workpiece.solids.from_mesh import Solid, solid, stl_bytes

Change = Callable[[dict[str, Any]], object]


def put(*keys: str | int, value: object) -> Change:
    def change(data: dict[str, Any]) -> None:
        table: Any = data
        for key in keys[:-1]:
            table = table.setdefault(key, {}) if isinstance(table, dict) else table[key]
        table[keys[-1]] = value

    return change


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (put("semi", "tool", value=9), "semi.tool = 9: expected the number of a tool: 1, 2, 3"),
        (put("finish", "tool", value=1), "finish.tool = 1: expected a tool no larger than that of"),
        (put("rough", "radial_depth_mm", value=5.0), "expected at most 4, the radius of tool 1"),
        (put("semi", "allowance_mm", value=0.5), "expected at most rough.allowance_mm = 0.3"),
        (put("finish", "scallop_mm", value=0.01), "finish.stepover_mm: missing; expected either"),
        (put("part", "stl", value="none.stl"), "does not exist"),
        (put("tools", 1, "number", value=1), "expected a unique number"),
        (put("tools", 0, "corner_radius_mm", value=7.0), "expected at most half the diameter"),
        (put("stock", "box_mm", value={"min": [0, 0, 0], "max": [40, 30, 0]}), "expected above 0 along z"),
        (put("rough", "axial_depth", value=1.0), "rough.axial_depth: unknown key; did you mean axial_depth_mm?"),
        (put("semi", "method", value="best"), "semi.method"),
    ],
)
def test_mistakes_are_named(job_tables: dict[str, Any], mold_folder: Path, change: Change, message: str) -> None:
    change(job_tables)
    with pytest.raises(JobError) as error:
        mold_from_dict(job_tables, mold_folder)
    assert message in str(error.value)


def test_all_mistakes_are_reported_at_once(job_tables: dict[str, Any], mold_folder: Path) -> None:
    put("semi", "tool", value=9)(job_tables)
    put("finish", "stepover_mm", value=None)(job_tables)
    del job_tables["finish"]["stepover_mm"]
    with pytest.raises(JobError) as error:
        mold_from_dict(job_tables, mold_folder)
    assert len(error.value.problems) == 2


def test_no_toml_and_no_file(tmp_path: Path) -> None:
    with pytest.raises(JobError, match="cannot be read"):
        load_mold(tmp_path / "none.toml")
    (tmp_path / "bad.toml").write_text("[part\n")
    with pytest.raises(JobError, match="not valid TOML"):
        load_mold(tmp_path / "bad.toml")


def test_an_open_stl_is_refused(job_tables: dict[str, Any], tmp_path: Path, small_mold: Solid) -> None:
    (tmp_path / "part.stl").write_bytes(stl_bytes(small_mold.vertices_mm, small_mold.triangles[5:]))
    with pytest.raises(MeshError):
        MoldPlan(mold_from_dict(job_tables, tmp_path))


def test_a_stock_smaller_than_the_part_is_refused(job_tables: dict[str, Any], mold_folder: Path) -> None:
    job_tables["stock"] = {"box_mm": {"min": [0, 0, -12], "max": [40, 29, 0]}}
    with pytest.raises(StockError, match="ends at y = 29; expected 30 or more"):
        MoldPlan(mold_from_dict(job_tables, mold_folder))


def with_a_bridge(part: Solid) -> Solid:
    """The mold with a bar across its pocket, free below."""
    low, high = np.array([2.0, 14.0, -3.0]), np.array([38.0, 16.0, 0.0])
    corners = np.array([[x, y, z] for x in (0, 1) for y in (0, 1) for z in (0, 1)]) * (high - low) + low
    quads = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
    bar = corners[[t for a, b, c, d in quads for t in ((a, b, c), (a, c, d))]]
    return solid(np.vstack((part.vertices_mm[part.triangles], bar)), "bridge")


def test_undercuts_are_reported_and_machined_as_seen_from_above(
    job_tables: dict[str, Any], tmp_path: Path, small_mold: Solid
) -> None:
    part = with_a_bridge(small_mold)
    (warning,) = undercut_warnings(part)
    assert "2 triangles with 72 mm2 face down" in warning
    assert not list(undercut_warnings(small_mold))
    (tmp_path / "part.stl").write_bytes(stl_bytes(part.vertices_mm, part.triangles))
    plan = MoldPlan(mold_from_dict(job_tables, tmp_path))
    path = plan.rough.path
    for move in path.moves:
        points = move.chords_mm(1e-4)
        assert (points[:, 2] >= plan.cutter(plan.job.rough).drop(np.ascontiguousarray(points[:, :2])) - 1e-6).all()


def test_a_holder_that_would_touch_is_warned_of_with_its_place(job_tables: dict[str, Any], mold_folder: Path) -> None:
    job_tables["tools"][0]["flute_length_mm"] = 4.0
    job_tables["tools"][0]["holder"] = [{"diameter_mm": 30.0, "length_mm": 40.0}]
    plan = MoldPlan(mold_from_dict(job_tables, mold_folder))
    (warning,) = plan.warnings(("rough",))
    assert "the holder of tool 1 would touch the part at X" in warning
    assert "mm too short there" in warning
    job_tables["rough"]["axial_depth_mm"] = 5.0
    plan = MoldPlan(mold_from_dict(job_tables, mold_folder))
    assert any("axial depth 5 mm is more than the flute length" in w for w in plan.warnings(("rough",)))


def test_the_former_name_of_the_raster_baseline_is_understood(job_tables: dict[str, Any], mold_folder: Path) -> None:
    job_tables["compare"] = {"conventional": False}
    assert not mold_from_dict(job_tables, mold_folder).compare.raster_baseline
    job_tables["compare"]["raster_baseline"] = True
    with pytest.raises(JobError, match=r"compare\.conventional: unknown key"):
        mold_from_dict(job_tables, mold_folder)


def test_tools_can_come_from_a_library(job_tables: dict[str, Any], mold_folder: Path) -> None:
    names = [f"tool {number}" for number in range(len(job_tables["tools"]))]
    tools = [LibraryTool(name=name, **keys) for name, keys in zip(names, map(_sizes, job_tables["tools"]), strict=True)]
    (mold_folder / "shop.csv").write_text(csv_text(tools))
    own = [
        {"from": "shop.csv", "name": name, "number": table["number"]}
        for name, table in zip(names, job_tables["tools"], strict=True)
    ]
    found = mold_from_dict({**job_tables, "tools": own}, mold_folder)
    assert [tool.diameter_mm for tool in found.tools] == [tool.diameter_mm for tool in tools]
    own[0]["name"] = "no such tool"
    with pytest.raises(JobError, match=r'tools\[0\]\.from = "shop.csv": .* no tool has the name "no such tool"'):
        mold_from_dict({**job_tables, "tools": own}, mold_folder)


def _sizes(table: dict[str, Any]) -> dict[str, Any]:
    keys = ("kind", "diameter_mm", "corner_radius_mm", "teeth", "flute_length_mm")
    return {key: table[key] for key in keys if key in table}
