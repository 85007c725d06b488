"""Mistakes in a file of test cuts: each one named, with its place, its value and what is expected; all at once."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

from twin.errors import CutsError
from twin.identification.cuts.load import cuts_from_dict, load_cuts

TOOL = {"kind": "bull", "diameter_mm": 16.0, "corner_radius_mm": 3.0, "teeth": 2, "helix_deg": 25.0}
CUT = {
    "name": "ap1",
    "axial_depth_mm": 1.0,
    "radial_depth_mm": 16.0,
    "direction": "slot",
    "spindle_rpm": 800,
    "feed_mm_min": 160,
    "mean_force_n": [1.0, 2.0, 3.0],
}


def problems(data: dict[str, Any], folder: Path = Path("there"), **options: Any) -> list[str]:
    with pytest.raises(CutsError) as caught:
        cuts_from_dict(data, folder / "cuts.toml", **options)
    return caught.value.problems


def with_cut(**changes: object) -> dict[str, Any]:
    return {"tool": TOOL, "cuts": [{k: v for k, v in {**CUT, **changes}.items() if v is not None}]}


def test_the_form_that_the_page_shows(tmp_path: Path) -> None:
    (tmp_path / "ap1.csv").write_text("")
    text = """
[tool]
kind = "bull"
diameter_mm = 16.0
corner_radius_mm = 3.0
teeth = 2
helix_deg = 25.0
[[cuts]]
name = "ap1"
axial_depth_mm = 1.0
radial_depth_mm = 16.0
direction = "slot"
spindle_rpm = 800
feed_mm_min = 160
log = "ap1.csv"
map = "x=Fx_N,y=Fy_N,z=Fz_N"
force_on = "tool"
"""
    (tmp_path / "cuts.toml").write_text(text)
    cuts = load_cuts(tmp_path / "cuts.toml")
    assert cuts.cuts[0].log == tmp_path / "ap1.csv"
    assert cuts.fit.method == "mean"


def test_defaults_hold_where_a_cut_is_silent_and_names_are_made_up() -> None:
    own = {k: CUT[k] for k in ("axial_depth_mm", "mean_force_n")}
    data = {
        "tool": TOOL,
        "defaults": {"direction": "slot", "spindle_rpm": 700, "feed_mm_min": 90},
        "cuts": [own, own | {"spindle_rpm": 900}],
    }
    cuts = cuts_from_dict(data, "cuts.toml")
    assert [(c.name, c.spindle_rpm, c.feed_mm_min) for c in cuts.cuts] == [("cut1", 700, 90), ("cut2", 900, 90)]


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"direction": "climb"}, 'cuts[0].direction (cut ap1) = "climb": expected one of "slot", "up", "down"'),
        ({"direction": None}, 'cuts[0].direction (cut ap1): missing; expected slot, "up" or "down" (or job = "...")'),
        ({"feed_mm_min": None}, "cuts[0].feed_mm_min (cut ap1): missing; expected the feed in mm/min"),
        ({"feed_mm_min": 0}, "cuts[0].feed_mm_min (cut ap1) = 0: expected a number above 0"),
        ({"spindle_rpm": "800"}, 'cuts[0].spindle_rpm (cut ap1) = "800": expected a number above 0'),
        ({"axial_depth_mm": -1.0}, "cuts[0].axial_depth_mm (cut ap1) = -1.0: expected a number above 0"),
        ({"radial_depth_mm": 5.0}, "cuts[0].radial_depth_mm (cut ap1) = 5.0: expected 16, the diameter, for a slot"),
        (
            {"radial_depth_mm": 17.0, "direction": "up"},
            "cuts[0].radial_depth_mm (cut ap1) = 17.0: expected at most 16, the diameter",
        ),
        (
            {"radial_depth_mm": None, "direction": "down"},
            "cuts[0].radial_depth_mm (cut ap1): missing; expected the radial depth of cut in mm",
        ),
        ({"feed_mm": 3.0}, "cuts[0].feed_mm (cut ap1): unknown key; did you mean feed_mm_min?"),
        ({"mean_force_n": [1.0, 2.0]}, "cuts[0].mean_force_n (cut ap1) = [1.0, 2.0]: expected a list of three numbers"),
        ({"mean_force_n": None}, "cuts[0] (cut ap1) has neither: expected one of log and mean_force_n"),
        ({"log": "a.csv"}, "cuts[0] (cut ap1) has log and mean_force_n: expected one of log and mean_force_n"),
        ({"mean_error_n": [1, 0, 1]}, "cuts[0].mean_error_n (cut ap1) = [1, 0, 1]: expected three numbers above 0"),
        ({"window_s": [1.0, 2.0]}, "cuts[0].window_s (cut ap1) = [1.0, 2.0]: expected it only with log"),
        ({"lag_s": 1.0}, "cuts[0].lag_s (cut ap1) = 1.0: expected it only with job"),
        ({"map": "q=Fx"}, "cuts[0].map (cut ap1) = \"q=Fx\": 'q=Fx' is not axis = column"),
        (
            {"log": "a.csv", "mean_force_n": None},
            'cuts[0].log (cut ap1) = "a.csv": expected a measured log; there/a.csv does not exist',
        ),
        (
            {"log": "a.csv", "mean_force_n": None, "window_s": [3.0, 2.0]},
            "cuts[0].window_s (cut ap1) = [3.0, 2.0]: expected from, to with from below to",
        ),
        (
            {"log": "a.csv", "mean_force_n": None, "air_s": [[0.0, 1.0], [3.0, 3.0]]},
            "cuts[0].air_s (cut ap1) = [3.0, 3.0]: expected from, to with from below to",
        ),
        (
            {"log": "a.csv", "mean_force_n": None, "mean_error_n": [1, 1, 1]},
            "cuts[0].mean_error_n (cut ap1) = [1, 1, 1]: expected it only with mean_force_n",
        ),
        ({"job": "job.toml"}, 'cuts[0].direction (cut ap1) = "slot": expected no such key with job'),
        ({"force_on": "table"}, 'cuts[0].force_on (cut ap1) = "table": expected one of "tool", "workpiece"'),
        ({"columns": 3}, "cuts[0].columns (cut ap1) = 3: expected a list of texts"),
    ],
)
def test_mistakes_in_a_cut(changes: dict[str, object], message: str) -> None:
    found = problems(with_cut(**changes))
    assert any(p.startswith(message) for p in found), found


@pytest.mark.parametrize(
    ("data", "message"),
    [
        ({"cuts": [CUT]}, "tool: missing; expected the tool of the cuts"),
        ({"tool": TOOL}, "cuts: missing; expected a list of tables"),
        ({"tool": TOOL, "cuts": []}, "cuts = []: expected at least one table [[cuts]]"),
        (
            {"tool": TOOL, "cuts": [CUT, CUT]},
            'cuts[1].name = "ap1": expected a unique name, cuts[0] already has it',
        ),
        (
            {"tool": TOOL | {"corner_radius_mm": 9.0}, "cuts": [CUT]},
            "tool.corner_radius_mm = 9.0: expected at most 8, half the diameter",
        ),
        (
            {"tool": {k: v for k, v in TOOL.items() if k != "corner_radius_mm"}, "cuts": [CUT]},
            "tool.corner_radius_mm: missing; expected the corner radius of a bull tool",
        ),
        (
            {"tool": TOOL | {"flute_length_mm": 5.0}, "cuts": [CUT | {"axial_depth_mm": 6.0}]},
            "cuts[0].axial_depth_mm (cut ap1) = 6.0: expected at most 5, tool.flute_length_mm",
        ),
        (
            {"tool": TOOL, "cuts": [CUT], "defaults": {"map": "x"}},
            "defaults.map = \"x\": 'x' is not axis = column",
        ),
        ({"tool": TOOL, "cuts": [CUT], "defaults": {"log": "x"}}, "defaults.log: unknown key"),
        (
            {"tool": TOOL, "cuts": [CUT], "fit": {"method": "guess"}},
            'fit.method = "guess": expected one of "mean", "iterative", "waveform"',
        ),
        ({"tool": TOOL, "cuts": [CUT], "fit": {"fixed": {"Kt": 1.0}}}, "fit.fixed.Kt: unknown key; did you mean Kt"),
        (
            {"tool": TOOL, "cuts": [CUT], "fit": {"holdout": ["x"]}},
            'fit.holdout = "x": expected the name of a cut: ap1',
        ),
        ({"tool": TOOL, "cuts": [CUT], "fit": {"holdout": ["ap1"]}}, "cuts: all are held out"),
        (
            {"tool": TOOL, "cuts": [CUT], "fit": {"lower": {"Ktc": 5.0}, "upper": {"Ktc": 4.0}}},
            "fit.upper.Ktc = 4.0: expected above fit.lower.Ktc = 5",
        ),
        (
            {"tool": TOOL, "cuts": [CUT], "fit": {"lower": {"Kte": 5.0}, "start": {"Kte": 4.0}}},
            "fit.start.Kte = 4.0: expected a value within the bounds",
        ),
    ],
)
def test_mistakes_in_the_file(data: dict[str, Any], message: str) -> None:
    found = problems(data)
    assert any(p.startswith(message) for p in found), found


def test_every_mistake_is_said_at_once() -> None:
    data = {
        "tool": TOOL | {"teeth": 0},
        "cuts": [CUT | {"direction": "sideways", "feed_mm_min": -1}, CUT | {"name": "b", "map": "q"}],
        "fit": {"holdout": ["nobody"]},
    }
    assert len(problems(data)) == 5


def test_a_name_on_the_command_line_is_checked_too() -> None:
    assert problems(with_cut(), fit={"holdout": ["ap7"]}) == ['fit.holdout = "ap7": expected the name of a cut: ap1']


@pytest.mark.parametrize(
    ("content", "message"),
    [
        (None, "cannot be read: no such file or directory; expected a file of test cuts (TOML)"),
        (b"[tool\n", "not valid TOML"),
        (b"\xff\xfe\x00", "the text is in UTF-16; expected a file of test cuts (TOML) in UTF-8"),
    ],
)
def test_files_that_cannot_be_read(tmp_path: Path, content: bytes | None, message: str) -> None:
    path = tmp_path / "cuts.toml"
    if content is not None:
        path.write_bytes(content)
    with pytest.raises(CutsError, match=r"cuts\.toml") as caught:
        load_cuts(path)
    assert message in str(caught.value)


def test_the_tool_can_come_from_a_library(tmp_path: Path) -> None:
    (tmp_path / "shop.csv").write_text("number,kind,diameter_mm,teeth,flute_length_mm\n3,ball,16,2,18\n")
    cuts = cuts_from_dict({**with_cut(), "tool": {"from": "shop.csv", "number": 3}}, tmp_path / "cuts.toml")
    assert cuts.tool is not None
    assert (cuts.tool.kind, cuts.tool.diameter_mm, cuts.tool.flute_length_mm) == ("ball", 16.0, 18.0)
