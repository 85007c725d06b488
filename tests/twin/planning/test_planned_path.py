"""`plan_paths`, `reach` and `verify` from Python: keywords or settings in, a frozen result out, nothing printed."""

from __future__ import annotations

from pathlib import Path

import pytest
from support.small_parts import prism, write_stl

from gcode.cli import run as gcode
from twin.errors import SettingsError, ToolError, ToolPathError
from twin.job import load_job
from twin.planning.part_reach import reach
from twin.planning.planned_path import PlannedPath, plan_paths, write_paths
from twin.planning.settings import PathSettings, ReachSettings
from twin.verification.settings import VerifySettings
from twin.verification.verification import verify

#: A step of 4 mm, 1 mm high, on a plate of 8 x 6 mm.
STEP = prism([(0, -2), (8, -2), (8, 0), (4, 0), (4, 1), (0, 1)], 0.0, 6.0)


@pytest.fixture(scope="module")
def part(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return write_stl(tmp_path_factory.mktemp("planned") / "part.stl", STEP)


@pytest.fixture(scope="module")
def planned(part: Path) -> PlannedPath:
    return plan_paths(part, strategy="scan", tool="ball 4", pitch_mm=0.2, stepover_mm=0.4)


def test_a_planned_path_is_written_and_verified(
    planned: PlannedPath, part: Path, tmp_path: Path, capfd: pytest.CaptureFixture[str]
) -> None:
    lines = planned.write(tmp_path / "a.nc")
    assert lines == len((tmp_path / "a.nc").read_text().splitlines())
    result = verify(tmp_path / "a.toml", part, region_mm=(0.5, 0.5, 1.5, 5.5))
    assert result.within_tolerance and result.collisions == () and result.deviation.worst_gouge_mm < 0.005
    tight = verify(tmp_path / "a.toml", part, VerifySettings(region_mm=(0.5, 0.5, 7.5, 5.5)), tolerance_mm=0.001)
    assert not tight.within_tolerance and tight.settings.tolerance_mm == 0.001
    assert tight.settings.region_mm == (0.5, 0.5, 7.5, 5.5)
    assert capfd.readouterr() == ("", "")
    assert gcode(["check", str(tmp_path / "a.nc")]) == 0


def test_several_paths_make_one_program_and_its_job(planned: PlannedPath, part: Path, tmp_path: Path) -> None:
    rough = plan_paths(planned.setup.part, planned.settings, allowance_mm=0.2, tool_number=2)
    tables = {"simulation": {"angle_step_deg": 5.0}, "output": {"mcap": "run.mcap"}}
    lines = write_paths([rough, planned], tmp_path / "a.nc", header=["two paths"], tables=tables)
    text = (tmp_path / "a.nc").read_text()
    assert lines == len(text.splitlines())
    assert text.count("M6") == 2 and text.index("T2 M6") < text.index("T1 M6")
    assert "(two paths)" in text
    job = load_job(tmp_path / "a.toml")
    assert [tool.number for tool in job.tools] == [1, 2]
    assert job.simulation.angle_step_deg == 5.0
    assert job.simulation.slice_pitch_mm == planned.settings.pitch_mm
    assert job.output.mcap == tmp_path / "run.mcap"


def test_a_path_is_drawn(planned: PlannedPath, tmp_path: Path) -> None:
    planned.plot(tmp_path / "path.png")
    assert (tmp_path / "path.png").read_bytes().startswith(b"\x89PNG")


def test_values_go_before_those_of_the_settings(planned: PlannedPath, part: Path) -> None:
    settings = PathSettings(strategy="scan", tool="ball 4", pitch_mm=0.2, stepover_mm=2.0)
    again = plan_paths(part, settings, stepover_mm=0.4)
    assert again.settings == planned.settings
    assert again.path.lengths_mm() == planned.path.lengths_mm() and again.machine_time_s == planned.machine_time_s
    assert plan_paths(part, settings).settings == settings


def test_files_that_exist_are_replaced_only_on_request(planned: PlannedPath, tmp_path: Path) -> None:
    (tmp_path / "mine.toml").write_text("mine")
    with pytest.raises(ToolPathError, match=r"mine\.toml: already exists"):
        planned.write(tmp_path / "a.nc", tmp_path / "mine.toml")
    assert not (tmp_path / "a.nc").exists()
    planned.write(tmp_path / "a.nc", tmp_path / "mine.toml", force=True)
    assert "mine" not in (tmp_path / "mine.toml").read_text()[:4]


def test_a_coarse_pitch_gives_a_warning(planned: PlannedPath, part: Path) -> None:
    assert planned.warnings == ()
    slope = write_stl(part.with_name("slope.stl"), prism([(0, -3), (10, -3), (10, 6), (0, 0)], 0.0, 6.0))
    coarse = plan_paths(
        slope, strategy="scan", tool="ball 4", direction="y", pitch_mm=0.5, stepover_mm=2.0, tolerance_mm=0.001
    )
    gouge, warning = coarse.warnings
    assert "pitch_mm = 0.5 may be too coarse" in warning and coarse.pitch_bound_mm > 0.001
    assert coarse.gouge is not None and 0.001 < coarse.gouge.depth_mm < coarse.pitch_bound_mm
    assert gouge.startswith(f"the path gouges the part by {coarse.gouge.depth_mm:.3g} mm at X")


def test_an_empty_path_is_not_written(part: Path, tmp_path: Path) -> None:
    empty = plan_paths(part, strategy="scan", tool="ball 4", pitch_mm=0.5, floor_z_mm=9.0)
    assert empty.path.empty
    with pytest.raises(ToolPathError, match="no file is written, as ball D4 cannot cut anything"):
        empty.write(tmp_path / "a.nc")
    assert list(tmp_path.iterdir()) == []


def test_mistakes_are_all_reported(part: Path) -> None:
    with pytest.raises(SettingsError) as error:
        plan_paths(part, strategy="scan", tool="ball 4", stepover_mm=0.0, fed_mm_min=600.0)
    assert len(error.value.problems) == 2 and "fed_mm_min: unknown key; did you mean feed_mm_min?" in str(error.value)
    with pytest.raises(SettingsError, match=r"reach: above = 1: expected true or false"):
        reach(part, above=1)
    with pytest.raises(SettingsError, match="region_mm must have its lower corner first"):
        verify("none.toml", part, region_mm=(1.0, 0.0, 0.0, 1.0))


def test_the_reach_of_tools(part: Path, tmp_path: Path) -> None:
    found = reach(part, tools=["ball 2", "flat 2"], pitch_mm=0.1)
    assert list(found.tools) == ["ball 2", "flat 2"] and found.largest_ball_mm is None and found.warnings == ()
    # a ball of radius r leaves r^2 (1 - pi / 4) of an inner edge of 6 mm, a flat tool nothing
    assert found.tools["ball 2"].volume_mm3 == pytest.approx(6.0 * (1.0 - 3.14159 / 4.0), rel=0.03)
    assert found.tools["flat 2"].uncut_regions == ()
    assert found.write_meshes(tmp_path / "uncut") == [tmp_path / "uncut" / "ball_2.stl"]
    with pytest.raises(ToolPathError, match="already exists"):
        found.write_meshes(tmp_path / "uncut")
    thin = reach(part, ReachSettings(tools=("ball 2",), pitch_mm=0.2), thin_mm=0.01)
    assert len(thin.warnings) == 1 and "for 0.01 mm expected a pitch of at most 0.01 mm" in thin.warnings[0]
    with pytest.raises(ToolError, match="no tool; expected"):
        reach(part)
