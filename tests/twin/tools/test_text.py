"""Tools as words."""

from __future__ import annotations

import pytest

from twin.errors import ToolError
from twin.tools.text import parse_tool, tool_text


@pytest.mark.parametrize(
    ("text", "disc", "corner", "taper", "flutes"),
    [
        ("ball 8", 0.0, 4.0, 0.0, 24.0),
        ("flat 10", 5.0, 0.0, 0.0, 30.0),
        ("bull 12 r2", 4.0, 2.0, 0.0, 36.0),
        ("  Bull D12 R.5 l20 ", 5.5, 0.5, 0.0, 20.0),
        ("taper 6 a45 r1 l9", 2.0, 1.0, 0.7853981633974483, 9.0),
    ],
)
def test_words_to_tools(text: str, disc: float, corner: float, taper: float, flutes: float) -> None:
    shape = parse_tool(text)
    assert (shape.disc_mm, shape.corner_radius_mm, shape.height_mm) == (disc, corner, flutes)
    assert shape.taper_rad == pytest.approx(taper)
    again = parse_tool(tool_text(shape))
    assert (again.disc_mm, again.corner_radius_mm) == (disc, corner)
    assert again.taper_rad == pytest.approx(taper)


@pytest.mark.parametrize(
    "text",
    ["", "ball", "8", "drill 8", "ball -8", "ball 8 r1", "bull 8", "bull 8 r1 r2", "taper 6", "ball 8 x", "ball 1e3"],
)
def test_other_words_are_refused(text: str) -> None:
    with pytest.raises(ToolError) as caught:
        parse_tool(text)
    assert str(caught.value) == (
        f'tool "{text}"; expected "ball D", "flat D", "bull D rC" or "taper D aDEG [rC]", lengths in mm, '
        'as in "bull 12 r2"'
    )


def test_shapes_that_cannot_be_are_refused_with_the_words() -> None:
    with pytest.raises(ToolError, match=r'tool "bull 8 r5": tool shape: corner_radius_mm = 5.0, expected at most half'):
        parse_tool("bull 8 r5")
    with pytest.raises(ToolError, match=r'tool "ball 0": tool shape: diameter and flute length'):
        parse_tool("ball 0")
