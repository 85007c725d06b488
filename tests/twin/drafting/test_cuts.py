"""Feed motions of a program as arrays, against the events that the interpreter gives."""

from __future__ import annotations

import numpy as np
import pytest

import gcode
from gcode.language.program import Program
from twin.drafting.cuts import cuts_of

ARCS = """G21 G90 G94
T2 M6
S1000 M3
G0 X10. Y0. Z5.
G1 Z-1. F100.
G17 G2 X-10. Y0. I-10. J0. F200.
G3 X-10. Y0. Z-3. I5. J0.
G18 G3 X10. Z-3. I10. K-20.
G19 G2 Y20. Z-3. J10. K5.
G17 G1 X40. Y40. Z-3.
G4 P1000
G0 Z5.
M30
"""


def test_extents_and_lengths_are_those_of_the_events() -> None:
    settings = gcode.MachineSettings(home_mm=(0, 0, 500), start_mm=(0, 0, 500))
    motions = [
        e
        for e in gcode.interpret(ARCS, settings=settings)
        if isinstance(e, gcode.LinearMotion | gcode.ArcMotion) and not getattr(e, "rapid", False)
    ]
    cuts = cuts_of(Program(ARCS.encode(), "arcs.nc"), "fanuc")
    low, high = (np.array(points) for points in zip(*map(gcode.extremes_mm, motions), strict=True))
    np.testing.assert_allclose(cuts.feed.low_mm, low, atol=1e-9)
    np.testing.assert_allclose(cuts.feed.high_mm, high, atol=1e-9)
    np.testing.assert_allclose(cuts.feed.length_mm, [gcode.length_mm(m) for m in motions], rtol=1e-9)
    assert cuts.feed.first.tolist() == [True, False, False, False, False, False]
    assert (cuts.tools, cuts.offsets, cuts.dwell_s) == ((2,), ("G54",), 1.0)


def test_compensation_and_length_offsets_are_listed_by_tool() -> None:
    text = "G21 G90\nT1 M6\nS1 M3\nG43 H7 Z5.\nG0 X0 Y0\nG41 D12 X5. F10.\nG1 Y5.\nG40 X0\nG55 G1 X1.\nM30\n"
    cuts = cuts_of(Program(text.encode(), "part.nc"), "fanuc")
    assert cuts.length_offsets == {1: {7}}
    assert cuts.compensated == {1: {12}}
    assert cuts.offsets == ("G54", "G55")


def test_a_program_without_feed_has_no_cuts() -> None:
    cuts = cuts_of(Program(b"G0 X1.\nM30\n", "part.nc"), "fanuc")
    assert len(cuts.feed.tool) == 0
    assert cuts.rapid_mm == pytest.approx(1.0)
