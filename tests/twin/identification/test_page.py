"""The page on identification has every key and every option, and the example is what it says it is."""

from __future__ import annotations

import importlib.util
import math
import re
import sys
import tomllib
from pathlib import Path
from types import ModuleType

import numpy as np
import pytest
from support.edge_integral import BALL_CUTS

from twin.identification.cuts.cuts_file import Cut, CutsFile
from twin.identification.cuts.fit_settings import Fit
from twin.identification.cuts.load import cuts_from_dict
from twin.identification.models.model import pass_model

ROOT = Path(__file__).parents[3]
EXAMPLE = ROOT / "examples" / "test_cuts"
PAGE = (ROOT / "docs" / "identify.md").read_text()


def test_the_page_has_every_key() -> None:
    for model in (Cut, Fit):
        assert f"<!-- keys of {model.__module__}.{model.__name__} -->" in PAGE
    assert all(f"[{key}]" in PAGE for key in CutsFile.model_fields)


def test_the_command_lines_page_has_every_option() -> None:
    page = (ROOT / "docs" / "command-line.md").read_text().split("## Options of `twin identify`")[1].split("\n## ")[0]
    assert f"<!-- options of {Fit.__module__}.{Fit.__name__} -->" in page
    source = (ROOT / "twin" / "cli" / "commands" / "logs" / "identify.py").read_text()
    options = {*re.findall(r'"(--[a-z/-]+)"', source), "--plot"}
    assert options == {"--out", "--plot", "--force", "--json", "--verbose"}
    assert {o for o in options if f"`{o}" not in page} == set()


@pytest.fixture(scope="module")
def make_logs() -> ModuleType:
    spec = importlib.util.spec_from_file_location("make_logs", EXAMPLE / "make_logs.py")
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    sys.modules["make_logs"] = module
    spec.loader.exec_module(module)
    return module


def example_cuts() -> dict[str, object]:
    """The example's file with means in place of its logs, which are made when it is run."""
    data = tomllib.loads((EXAMPLE / "cuts.toml").read_text())
    data["cuts"] = [{k: v for k, v in c.items() if k != "log"} | {"mean_force_n": [0, 0, 0]} for c in data["cuts"]]
    return data


def test_the_example_has_the_nine_cuts_of_table_5() -> None:
    cuts = cuts_from_dict(example_cuts(), EXAMPLE / "cuts.toml")
    sizes = [(c.axial_depth_mm, c.radial_depth_mm, c.feed_mm_min) for c in cuts.cuts]
    assert sizes == [(p.axial, pytest.approx(p.radial), p.feed) for p in BALL_CUTS]


def test_the_examples_model_is_right_and_not_the_simulators(make_logs: ModuleType) -> None:
    assert "twin" not in re.findall(r"^(?:from|import) (\w+)", (EXAMPLE / "make_logs.py").read_text(), flags=re.M)
    cuts = cuts_from_dict(example_cuts(), EXAMPLE / "cuts.toml")
    assert cuts.tool is not None
    tool = cuts.tool.model_copy(update={"runout_mm": make_logs.RUNOUT_MM, "runout_angle_deg": make_logs.RUNOUT_DEG})
    k = np.array([make_logs.KTC, make_logs.KTE, make_logs.KRC, make_logs.KRE, make_logs.KAC, make_logs.KAE])
    angle = (np.arange(360) + 0.5) * math.pi / 180.0
    for cut in cuts.cuts[::4]:
        assert cut.axial_depth_mm and cut.radial_depth_mm and cut.feed_mm_min
        got = make_logs.forces_on_tool(
            np.tile([20.0, 0.0, -cut.axial_depth_mm], (360, 1)),
            np.tile([1.0, 0.0, 0.0], (360, 1)),
            angle,
            cut.feed_mm_min / 3600.0 / 2.0,
            make_logs.edges(cut.axial_depth_mm),
            1e9,
            cut.radial_depth_mm - 4.0,
        )
        want = pass_model(tool, cut, "").means() @ k
        assert got.mean(axis=0) == pytest.approx(want, abs=0.002 * float(np.linalg.norm(want)))


def test_everything_of_the_example_says_that_it_is_synthetic() -> None:
    data = tomllib.loads((EXAMPLE / "cuts.toml").read_text())
    assert all("synthetic" in c["log"] for c in data["cuts"])
    assert "SYNTHETIC" in data["fit"]["source"]
    for name in ("README.md", "make_logs.py", "cuts.toml", "run.py"):
        assert "SYNTHETIC" in (EXAMPLE / name).read_text(), name
