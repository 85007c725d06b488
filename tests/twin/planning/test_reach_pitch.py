"""The pitch of `twin reach` for parts and tools of very different sizes."""

from __future__ import annotations

from pathlib import Path

import pytest
import trimesh

import twin
from twin.errors import ToolError
from twin.planning.part_reach import slice_pitch_mm
from twin.planning.settings import ReachSettings


@pytest.fixture
def tiny(tmp_path: Path) -> Path:
    """A block drawn in metres and read in mm."""
    trimesh.creation.box((0.025, 0.020, 0.010)).export(tmp_path / "tiny.stl")
    return tmp_path / "tiny.stl"


def test_the_largest_tool_spans_a_bounded_number_of_slices() -> None:
    settings = ReachSettings(tools=("ball 6",))
    assert slice_pitch_mm(settings, 0.025, 6.0) == 6.0 / 500
    assert slice_pitch_mm(settings, 60.0, 6.0) == 60.0 / 600


def test_a_pitch_far_too_small_for_the_tool_is_refused(tiny: Path) -> None:
    with pytest.raises(ToolError, match=r"pitch_mm = 4e-05: expected at least 0\.00075 for a tool of 6 mm"):
        twin.reach(tiny, tools=("ball 6",), pitch_mm=4e-5)
