"""``twin reach``."""

from __future__ import annotations

import json
import struct
from pathlib import Path

import numpy as np
import pytest
from support import solids

from tests.support.recording import Recording
from twin.cli import run
from twin.workpiece.solids.from_mesh import load_mesh


@pytest.fixture
def pocket(tmp_path: Path) -> Path:
    path = tmp_path / "pocket.stl"
    solids.torus_example().write_stl(path, solids.pocket())
    return path


def test_a_table_of_tools_and_all_outputs(pocket: Path, capsys: pytest.CaptureFixture[str]) -> None:
    folder = pocket.parent
    words = ["reach", str(pocket), "--tool", "flat 4", "--tool", "flat 16", "--pitch", "0.25", "--above"]
    outputs = ["--rrd", str(folder / "a.rrd"), "--mesh", str(folder / "left"), "--plot", str(folder / "a.png")]
    assert run([*words, *outputs]) == 0
    text = capsys.readouterr().out
    assert "26 x 26 x 10 mm, 28 triangles, slices 0.25 mm apart" in text
    assert "flat 4: 4 regions" in text and "flat 16: 1 region" in text
    assert (folder / "a.png").read_bytes().startswith(b"\x89PNG")
    scene = Recording(folder / "a.rrd")
    assert {"part", "uncut/flat_4", "uncut/flat_16", "thickest/flat_16"} <= set(scene.tables)
    (report,) = scene.column("report", "TextDocument:text")
    assert "| flat 16 | " in str(report) and "| 1 |" in str(report)
    whole = load_mesh(folder / "left" / "flat_16.stl")
    np.testing.assert_allclose(whole.vertices_mm.max(axis=0), (5.0, 5.0, 0.0), atol=1e-3)
    assert load_mesh(folder / "left" / "flat_4.stl").volume_mm3 == pytest.approx(
        6.0 * 4.0 * (1.0 - np.pi / 4) * 4.0, rel=0.03
    )
    # nothing is replaced unasked, and nothing is left half written
    assert run([*words, *outputs]) == 1
    assert "already exists" in capsys.readouterr().err
    assert run([*words, *outputs, "--force"]) == 0
    assert not list(folder.rglob("*.partial"))


def test_json_and_the_largest_ball(pocket: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert run(["reach", str(pocket), "--tool", "ball 4", "--largest", "--pitch", "0.25", "--json"]) == 0
    printed = json.loads(capsys.readouterr().out)
    (tool,) = printed["tools"]
    assert printed["pitch_mm"] == [0.25, 0.25, 0.25] and printed["largest_ball_diameter_mm"] is None
    assert tool["tool"] == "ball 4" and not tool["from_above"]
    assert tool["volume_mm3"] == pytest.approx(sum(r["volume_mm3"] for r in tool["regions"]))
    assert set(tool["regions"][0]) == {"volume_mm3", "thickness_mm", "deepest_mm", "low_mm", "high_mm", "centroid_mm"}


def test_no_uncut_material(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    block = tmp_path / "block.stl"
    solids.torus_example().write_stl(block, solids.box((0, 0, 0), (20, 20, 8)))
    words = ["reach", str(block), "--tool", "ball 6", "--largest", "--mesh", str(tmp_path / "left")]
    assert run([*words, "--pitch", "0.5", "--plot", str(tmp_path / "a.png")]) == 0
    text = capsys.readouterr().out
    assert "none" in text and "Largest ball that finishes the part: diameter 8 mm." in text
    assert list((tmp_path / "left").iterdir()) == []


def test_a_pitch_too_coarse_for_the_requested_thickness_gives_a_warning(
    pocket: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert run(["reach", str(pocket), "--tool", "ball 4", "--pitch", "0.5", "--thin", "0.01"]) == 0
    warned = capsys.readouterr().err
    assert (
        "slices 0.5 mm apart may show uncut material up to 0.375 mm thick where there is none; for 0.01 mm expected"
        in warned
    )


@pytest.mark.parametrize(
    ("words", "message"),
    [
        ([], 'no tool; expected --tool "ball 8", or --largest'),
        (["--tool", "ball"], 'tool "ball"; expected "ball D"'),
        (["--tool", "ball 8", "--pitch", "0"], "twin reach: --pitch = 0.0: expected a number above 0"),
        (["--tool", "taper 4 a5"], "offsets with taper tools: not possible"),
        (["--tool", "ball 8", "--rrd", "a.txt"], "a.txt: expected a file name that ends in .rrd"),
        (["--tool", "ball 8", "--plot", "no/a.png"], "there is no folder no; expected one that exists"),
    ],
)
def test_mistakes(pocket: Path, words: list[str], message: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert run(["reach", str(pocket), *words]) == 1
    assert message in capsys.readouterr().err


def test_an_open_part_is_refused(pocket: Path, capsys: pytest.CaptureFixture[str]) -> None:
    data = pocket.read_bytes()
    pocket.write_bytes(data[:80] + struct.pack("<I", 27) + data[84:-50])
    assert run(["reach", str(pocket), "--tool", "ball 4"]) == 1
    assert "the surface leaks: 1 hole of 3 open edges, " in capsys.readouterr().err
