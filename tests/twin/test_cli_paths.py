"""`twin paths` and `twin verify`: outputs, exit codes, and messages for mistakes."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
from support.small_parts import pocket, prism, prism_corners, write_stl

from gcode.cli.entry import run as gcode
from twin.cli import run
from twin.workpiece.solids.from_mesh import stl_bytes

STEP = prism([(0, -2), (8, -2), (8, 0), (4, 0), (4, 1), (0, 1)], 0.0, 6.0)
SCAN = ["--tool", "ball 4", "--pitch", "0.2", "--stepover", "0.4", "--arcs", "0.001"]


@pytest.fixture
def part(tmp_path: Path) -> Path:
    return write_stl(tmp_path / "part.stl", STEP)


def test_a_scan_is_written_replayed_and_verified(part: Path, tmp_path: Path, capfd: pytest.CaptureFixture[str]) -> None:
    out, picture, rrd = tmp_path / "a.nc", tmp_path / "a.png", tmp_path / "a.rrd"
    options = ["-o", str(out), "--plot", str(picture), "--rrd", str(rrd)]
    assert run(["paths", "scan", str(part), *SCAN, *options]) == 0
    printed = capfd.readouterr().out
    assert "scan step-over 0.4 mm" in printed and "Job " in printed
    assert picture.stat().st_size > 10_000 and rrd.stat().st_size > 1_000
    assert gcode(["check", str(out)]) == 0
    assert "stepover_mm 0.4" in out.read_text()

    capfd.readouterr()
    picture, rrd = tmp_path / "v.png", tmp_path / "v.rrd"
    command = ["verify", str(tmp_path / "a.toml"), str(part), "--json", "--plot", str(picture), "--rrd", str(rrd)]
    assert run([*command, "--excess", "0.02"]) == 4
    found = json.loads(capfd.readouterr().out)
    assert found["worst_gouge_mm"] < 0.005
    # the ball leaves its own radius's share in the inner corner: r (sqrt(2) - 1) away from the edge
    assert found["worst_excess_mm"] == pytest.approx(2.0 - np.sqrt(3.0), abs=0.35)
    assert found["places"][0]["kind"] == "excess"
    assert not found["within_tolerance"] and found["collisions"] == []
    assert picture.stat().st_size > 10_000 and rrd.stat().st_size > 1_000


def test_the_tables_of_verify_print_the_verdict(part: Path, tmp_path: Path, capfd: pytest.CaptureFixture[str]) -> None:
    assert run(["paths", "scan", str(part), *SCAN, "-o", str(tmp_path / "a.nc"), "-q"]) == 0
    assert run(["verify", str(tmp_path / "a.toml"), str(part), "--region", "0.5", "0.5", "1.5", "5.5"]) == 0
    printed = capfd.readouterr().out
    assert "Deviation of the machined surface" in printed and "within tolerance (20.0 µm)" in printed
    assert "on rays 0.2 mm apart" in printed


def test_settings_files_and_options_go_together(part: Path, tmp_path: Path) -> None:
    file = tmp_path / "s.toml"
    file.write_text('tool = "ball 4"\npitch_mm = 0.2\nstepover_mm = 3.0\nfeed_mm_min = 432.0\n')
    out = tmp_path / "a.nc"
    assert run(["paths", "scan", str(part), "--settings", str(file), "--stepover", "1.5", "-o", str(out), "-q"]) == 0
    text = out.read_text()
    assert "stepover_mm 1.5" in text and "F432" in text


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("tool = ", "s.toml:1:8: not valid TOML"),
        ('tool = "ball 4"\nfeed_mm_min = 0.0', "s.toml: feed_mm_min = 0.0: expected a number above 0 (cutting feed)"),
        ('tool = "ball 4"\nlayers = 0', "s.toml: layers must be at least 1 for a scan"),
        ('tool = "ball 4"\nregion_mm = [0, 0, 1]', "s.toml: region_mm = [0, 0, 1]: expected a list of four numbers"),
    ],
)
def test_mistakes_of_settings_files(
    part: Path, tmp_path: Path, text: str, message: str, capfd: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "s.toml").write_text(text)
    command = ["paths", "scan", str(part), "--settings", str(tmp_path / "s.toml"), "-o", str(tmp_path / "a.nc")]
    assert run(command) == 1
    assert message in capfd.readouterr().err


def test_contours_for_grbl_have_no_tool_change(part: Path, tmp_path: Path) -> None:
    out = tmp_path / "a.nc"
    options = ["--tool", "flat 3", "--pitch", "0.2", "--axial-depth", "0.5", "--layers", "0", "--dialect", "grbl"]
    assert run(["paths", "contour", str(part), *options, "-o", str(out), "-q"]) == 0
    assert "M6" not in out.read_text()
    assert run(["verify", str(tmp_path / "a.toml"), str(part), "--excess", "0.6", "-q"]) == 0


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["--tool", "drill 8"], 'tool "drill 8"; expected'),
        ([], "twin paths: tool: missing; expected text"),
        (["--tool", "ball 4", "--stepover", "0"], "twin paths: --stepover = 0.0: expected a number above 0"),
        (["--tool", "ball 4", "--stepover", "-1"], "twin paths: --stepover = -1.0: expected a number above 0"),
        (["--tool", "ball 4", "--plot", "no/a.png"], "there is no folder no"),
        (["--tool", "ball 4", "--plot", "a.jpg"], "expected a file name that ends in .png, .svg, .pdf"),
        (["--tool", "ball 4", "--rrd", "a.bin"], "a.bin: expected a file name that ends in .rrd"),
        (["--tool", "ball 4", "--settings", "none.toml"], "none.toml: cannot be read"),
        (["--tool", "ball 4", "--floor-z", "9"], "cannot cut anything of this stock"),
    ],
)
def test_mistakes_are_one_message_and_leave_nothing(
    part: Path, tmp_path: Path, arguments: list[str], message: str, capfd: pytest.CaptureFixture[str]
) -> None:
    before = sorted(tmp_path.iterdir())
    assert run(["paths", "scan", str(part), "--pitch", "0.5", *arguments, "-o", str(tmp_path / "a.nc")]) == 1
    printed = capfd.readouterr().err
    assert printed.startswith("error: ") and message in printed and "Traceback" not in printed
    assert sorted(tmp_path.iterdir()) == before


def test_a_tool_larger_than_any_pocket_is_refused_and_no_file_is_written(
    tmp_path: Path, capfd: pytest.CaptureFixture[str]
) -> None:
    part = write_stl(tmp_path / "pocket.stl", pocket(9.0, 3.0, -2.0, -4.0))
    options = ["--tool", "flat 8", "--pitch", "0.5", "--floor-z", "-2", "--overhang", "0", "--layers", "0"]
    assert run(["paths", "contour", str(part), *options, "-o", str(tmp_path / "a.nc")]) == 1
    assert "flat D8 cannot cut anything of this stock: no pocket is wide enough" in capfd.readouterr().err
    assert [p.name for p in tmp_path.iterdir()] == ["pocket.stl"]


def test_files_that_are_there_are_kept(part: Path, tmp_path: Path, capfd: pytest.CaptureFixture[str]) -> None:
    out = tmp_path / "a.nc"
    out.write_text("mine")
    assert run(["paths", "scan", str(part), *SCAN, "-o", str(out)]) == 1
    assert "already exists" in capfd.readouterr().err and out.read_text() == "mine"
    assert run(["paths", "scan", str(part), *SCAN, "-o", str(out), "-q", "--force"]) == 0
    assert out.read_text() != "mine"


def test_open_and_crossing_parts_are_refused(tmp_path: Path, capfd: pytest.CaptureFixture[str]) -> None:
    corners = prism_corners([(0, -2), (8, -2), (8, 0), (0, 0)], 0.0, 6.0)
    file = tmp_path / "open.stl"
    file.write_bytes(stl_bytes(corners[:-1].reshape(-1, 3), np.arange(3 * (len(corners) - 1)).reshape(-1, 3)))
    assert run(["paths", "scan", str(file), *SCAN, "-o", str(tmp_path / "a.nc")]) == 1
    assert "the surface leaks" in capfd.readouterr().err
    file = tmp_path / "inside_out.stl"
    file.write_bytes(stl_bytes(corners[:, ::-1].reshape(-1, 3), np.arange(3 * len(corners)).reshape(-1, 3)))
    assert run(["paths", "scan", str(file), *SCAN, "-o", str(tmp_path / "a.nc")]) == 1
    assert "inside out" in capfd.readouterr().err
    assert not (tmp_path / "a.nc").exists()


def test_bodies_that_cross_count_as_their_union(tmp_path: Path) -> None:
    both = np.concatenate(
        (
            prism_corners([(0, -2), (8, -2), (8, 0), (0, 0)], 0.0, 6.0),
            prism_corners([(3, -1), (5, -1), (5, 1), (3, 1)], 2.0, 4.0),
        )
    )
    file = tmp_path / "both.stl"
    file.write_bytes(stl_bytes(both.reshape(-1, 3), np.arange(3 * len(both)).reshape(-1, 3)))
    assert run(["paths", "scan", str(file), *SCAN, "-o", str(tmp_path / "a.nc"), "-q"]) == 0
    assert run(["verify", str(tmp_path / "a.toml"), str(file), "--excess", "1.2", "-q"]) == 0


def test_a_pitch_too_coarse_for_the_tolerance_gives_a_warning(
    part: Path, tmp_path: Path, capfd: pytest.CaptureFixture[str]
) -> None:
    slope = write_stl(tmp_path / "slope.stl", prism([(0, -3), (10, -3), (10, 6), (0, 0)], 0.0, 6.0))
    options = ["--tool", "ball 4", "--stepover", "2", "--tolerance", "0.001", "-q", "--direction", "y"]
    assert run(["paths", "scan", str(slope), *options, "--pitch", "0.5", "-o", str(tmp_path / "a.nc")]) == 0
    printed = capfd.readouterr().err
    assert "pitch_mm = 0.5 may be too coarse" in printed and "more than tolerance_mm = 0.001" in printed


def test_wrong_tolerances_of_verify_are_refused(part: Path, tmp_path: Path, capfd: pytest.CaptureFixture[str]) -> None:
    assert run(["paths", "scan", str(part), *SCAN, "-o", str(tmp_path / "a.nc"), "-q"]) == 0
    assert run(["verify", str(tmp_path / "a.toml"), str(part), "--tolerance", "0"]) == 1
    assert "twin verify: --tolerance = 0.0: expected a number above 0" in capfd.readouterr().err
    assert run(["verify", str(tmp_path / "a.toml"), str(tmp_path / "none.stl")]) == 1
    assert "none.stl: cannot be read" in capfd.readouterr().err
