"""Units of STL files: lengths, the guess of ``auto``, and doubts about a size."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from support.small_parts import box

from twin.errors import MeshError, SettingsError, StockError
from twin.job.load import job_from_dict
from twin.moldmaking import mold_from_dict
from twin.planning.part_reach import reach
from twin.planning.planned_path import plan_paths
from twin.record import RunSummary
from twin.run.watch import Watch
from twin.simulation.replay import Replay
from twin.simulation.setup import stock_slices
from twin.workpiece.solids.from_mesh import load_mesh, stl_bytes
from twin.workpiece.solids.units import UNITS_MM, size_doubts

SIZE = (30.0, 20.0, 10.0)


@pytest.fixture(scope="module")
def files(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Path]:
    """One block, as files in each unit."""
    folder = tmp_path_factory.mktemp("units")
    block = box((0, 0, 0), SIZE)
    paths = {unit: folder / f"{unit}.stl" for unit in UNITS_MM}
    for unit, path in paths.items():
        path.write_bytes(stl_bytes(block.vertices_mm / UNITS_MM[unit], block.triangles))
    return paths


@pytest.mark.parametrize("unit", UNITS_MM)
@pytest.mark.parametrize("given", [True, False], ids=["given", "auto"])
def test_every_unit_gives_the_same_part(files: dict[str, Path], unit: str, *, given: bool) -> None:
    part = load_mesh(files[unit], unit=unit if given else "auto", like_mm=72.0)
    assert part.box_mm[1] == pytest.approx(SIZE, abs=1e-4)
    name = "" if given else f"{files[unit]}: unit auto: taken to be in {unit}, so the part is 30 x 20 x 10 mm"
    assert part.notes == ((name,) if name else ())


def test_a_scale_is_a_further_factor(files: dict[str, Path]) -> None:
    assert load_mesh(files["inch"], unit="inch", scale=2.0).box_mm[1] == pytest.approx(np.array(SIZE) * 2.0, abs=1e-4)
    assert load_mesh(files["inch"], scale=25.4).box_mm[1] == pytest.approx(SIZE, abs=1e-4)
    with pytest.raises(MeshError, match=r"unit 'ft'; expected one of mm, inch, m, auto$"):
        load_mesh(files["mm"], unit="ft")


def test_paths_and_reach_take_the_unit_and_doubt_a_part_smaller_than_the_tool(files: dict[str, Path]) -> None:
    keys = {"strategy": "scan", "tool": "ball 6", "stepover_mm": 5.0, "pitch_mm": 0.5}
    same = [plan_paths(files[unit], unit=unit, **keys) for unit in ("mm", "inch")]
    lengths = [made.path.lengths_mm() for made in same]
    assert lengths[0] == pytest.approx(lengths[1], rel=1e-4) and same[1].warnings == ()
    small = plan_paths(files["inch"], **(keys | {"pitch_mm": 0.1}))
    assert small.warnings == (
        f"{files['inch']}: the part is 1.181 mm long, less than the tool's diameter 6 mm; check the unit of the file "
        "(unit, --unit): 30 mm if it is in inch, 1181 mm if it is in m",
    )
    found = reach(files["inch"], tools=["ball 6"], unit="auto", pitch_mm=1.0)
    assert "taken to be in inch" in found.warnings[0]
    with pytest.raises(SettingsError, match='unit = "ft": expected one of "mm", "inch", "m", "auto"'):
        plan_paths(files["mm"], unit="ft", **keys)


def test_a_part_too_large_to_slice_is_doubted_too(files: dict[str, Path]) -> None:
    with pytest.raises(
        StockError, match=r"do not fit in memory; .*mm.stl: the part is 3e\+04 mm long, larger than any"
    ):
        plan_paths(files["mm"], unit="m", strategy="scan", tool="ball 6", pitch_mm=0.5)


def test_jobs_have_the_same_key(files: dict[str, Path]) -> None:
    tool = {"number": 1, "kind": "flat", "diameter_mm": 6.0, "teeth": 2, "flute_length_mm": 9.0, "length_mm": 50.0}
    program = files["inch"].with_name("p.nc")
    program.write_text("M30\n")
    stock = {"stl": files["inch"].name, "unit": "inch"}
    tables = {"program": {"file": "p.nc"}, "tools": [tool], "stock": stock}
    tables["machine"] = {"offsets": {"G54": [0.0, 0.0, 0.0]}}
    job = job_from_dict(tables, program.parent)
    assert stock_slices(job.stock, 1.0).high_mm == pytest.approx(SIZE, abs=1e-4)
    common = {"tool": 1, "spindle_rpm": 1000, "feed_mm_min": 100, "plunge_mm_min": 100}
    level = common | {"axial_depth_mm": 1.0, "radial_depth_mm": 1.0, "allowance_mm": 0.1}
    stages = {"rough": level, "semi": level, "finish": common | {"stepover_mm": 1.0}}
    mold = mold_from_dict({"part": stock, "tools": [tool]} | stages, program.parent)
    assert mold.part.unit == "inch" and mold.with_unit("m").part.unit == "m"


@pytest.mark.parametrize(
    ("length", "tool", "stock", "doubt"),
    [
        (30.0, 6.0, 40.0, None),
        (1.2, 6.0, None, "less than the tool's diameter 6 mm"),
        (9.0, 6.0, 228.0, "its stock 228 mm; check the unit of the file (unit, --unit): 228.6 mm if it is in inch"),
        (762.0, 6.0, 30.0, "its stock only 30 mm"),
        (30_000.0, 6.0, None, "larger than any machine takes"),
    ],
)
def test_doubts_about_a_size(length: float, tool: float | None, stock: float | None, doubt: str | None) -> None:
    found = list(size_doubts("a.stl", np.array([[0, 0, 0], [length, 1, 1]]), tool_mm=tool, stock_mm=stock))
    assert found == [] if doubt is None else len(found) == 1 and doubt in found[0]


def test_a_run_states_what_was_mended_in_its_stock(tmp_path: Path) -> None:
    block = box((0, 0, 0), SIZE)
    corners = block.vertices_mm[block.triangles]
    corners[0, 0] += 4e-4
    (tmp_path / "block.stl").write_bytes(stl_bytes(corners.reshape(-1, 3), np.arange(3 * len(corners)).reshape(-1, 3)))
    (tmp_path / "p.nc").write_text("G21\nM30\n")
    tables = {"program": {"file": "p.nc"}, "machine": {"offsets": {"G54": [0.0, 0.0, 0.0]}}}
    tables |= {"stock": {"stl": "block.stl"}, "simulation": {"slice_pitch_mm": 5.0}}
    tables["tools"] = [{"number": 1, "kind": "flat", "diameter_mm": 6.0, "teeth": 2, "flute_length_mm": 9.0}]
    watch = Watch()
    records = list(Replay(job_from_dict(tables, tmp_path), threads=1))
    for record in records:
        watch.take(record)
    assert isinstance(records[-1], RunSummary)
    assert "1 vertex on open edges welded" in " ".join(watch.warnings(records[-1]))
