"""Sections added where a part's surface runs along them, against the drop-cutter beside drafted walls."""

from __future__ import annotations

import math

import numpy as np
import pytest
from support import solids
from support.small_parts import box, prism

from twin.arrays import FloatArray
from twin.cam.slices.cl_lines import Profiles, cl_heights
from twin.cam.slices.polylines import Samples
from twin.cam.slices.sections import Sections, SlicedPart, slice_part
from twin.cam.slices.steep_sections import with_steep_sections
from twin.cam.slices.structuring_element import StructuringElement
from twin.cam.surface.drop_cutter import DropCutter
from twin.planning.accuracy import sag_mm
from twin.tools.text import parse_tool

HIGH = 6.0


def wall(draft_deg: float) -> SlicedPart:
    """A step of 6 mm along y whose wall faces -x, leaning back by a draft."""
    back = 6.0 + HIGH * math.tan(math.radians(draft_deg))
    return slice_part(prism([(0, -2), (12, -2), (12, HIGH), (back, HIGH), (6, 0), (0, 0)], 0.0, 6.0), 0.2)


def gouge_mm(part: SlicedPart, sections: Sections, text: str) -> float:
    """How far into the wall tips on rows along it are at most, square to the wall."""
    rows = np.arange(3.0, 8.0, 0.037)
    tool = StructuringElement.tool(parse_tool(text))
    heights = cl_heights(Profiles.of(sections), tool, rows, Samples.between(2.0, 4.0, 1.0))[:, 0]
    cutter = DropCutter(part.mesh.vertices_mm[part.mesh.triangles], text)

    def exact(x: FloatArray) -> FloatArray:
        return cutter.drop(np.column_stack((x, np.full(len(x), 2.0))))

    aside = np.linspace(0.0, 0.2, 401)
    free = np.array([np.maximum(heights, 0.0) >= exact(rows - a) - 1e-4 for a in aside])
    # at the wall's edge the tip is on top, and no way aside makes it free
    on_top = exact(rows) > HIGH - 0.5
    return float(aside[np.argmax(free, axis=0)][~on_top].max())


@pytest.mark.parametrize("text", ["ball 4", "bull 6 r1"])
@pytest.mark.parametrize("draft_deg", [1.0, 3.0, 10.0])
def test_a_drafted_wall_along_the_rows_is_known_well(text: str, draft_deg: float) -> None:
    part = wall(draft_deg)
    even, more = part.sections(0), with_steep_sections(part, 0)
    assert len(more.positions_mm) > len(even.positions_mm)
    found, shape = gouge_mm(part, more, text), parse_tool(text)
    # tips on lines that are three pitches apart along the wall, or a sixteenth of a pitch from one to the next
    assert found <= sag_mm(part.mesh, shape, more) <= min(0.6**2 / (7.9 * shape.corner_radius_mm), 0.2)
    assert gouge_mm(part, even, text) > 2.0 * found + 0.005


def test_where_nothing_runs_along_the_slices_nothing_is_added() -> None:
    for part in (slice_part(box((0, 0, 0), (8, 6, 4)), 0.3), slice_part(solids.torus(128, 48), 0.4)):
        for axis in (0, 1):
            assert len(with_steep_sections(part, axis).positions_mm) == len(part.sections(axis).positions_mm)


def test_sections_lie_where_the_wall_is_and_are_the_parts_own() -> None:
    part = wall(3.0)
    sections = with_steep_sections(part, 0)
    added = np.setdiff1d(sections.positions_mm, part.sections(0).positions_mm)
    pitch = float(part.slices.pitch_mm[0])
    assert 6.0 - pitch < added.min() and added.max() < 6.0 + HIGH * math.tan(math.radians(3.0)) + pitch
    assert (np.diff(sections.positions_mm) >= 0.0).all()
    for at, region in zip(sections.positions_mm, sections.regions, strict=True):
        if 6.0 < at < 6.0 + HIGH * math.tan(math.radians(3.0)):
            # as high as the wall is there, 6 mm wide, down to -2
            height = (at - 6.0) / math.tan(math.radians(3.0)) + 2.0
            assert region.area_mm2 == pytest.approx(6.0 * height, rel=1e-3)


def test_no_more_are_added_than_there_are_slices() -> None:
    # steps of 3 degrees everywhere
    steps = [(0.0, -2.0), (12.0, -2.0)]
    for k in range(12, 0, -1):
        steps += [(float(k), 0.5 * k), (k - 1.0, 0.5 * k - 0.45)] if k % 2 else [(float(k), 8.0), (k - 0.9, -1.0)]
    steps += [(0.0, 0.0)]
    part = slice_part(prism(steps, 0.0, 4.0), 0.25)
    even = len(part.slices.regions[0])
    added = len(with_steep_sections(part, 0).positions_mm) - len(part.sections(0).positions_mm)
    assert 0 < added <= even
