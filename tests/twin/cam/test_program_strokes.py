"""Programs cut from arrays are those cut from moves."""

from __future__ import annotations

import numpy as np
import pytest

from gcode.dialects import dialect_named
from gcode.errors import GcodeError
from gcode.flow.interpreter import interpret
from gcode.settings import ALL_OFFSETS, MachineSettings, ToolOffset
from twin.cam.stock.dexel import Dexels
from twin.cam.stock.program_strokes import cut_program
from twin.motion.from_nc import moves_from_nc
from twin.motion.path import Move
from twin.tools.text import parse_tool

PROGRAM = """G90 G21 G17 G54
T1 M6
G43 H1 G0 X-5. Y2. Z5.
G1 Z-1. F300
G1 X8. Y3. Z-1.5
G2 X8. Y3. I-2. J0.
G3 X6. Y5. Z-0.5 I-2. J0.
G18 G2 X8. Z-0.5 I1. K0.
G17 G0 Z50.
T2 M6
G43 H2 G0 X2. Y7.
G1 Z-0.7
G4 P200
X9. Y1.
G0 Z9.
M30
"""
TOOLS = {1: parse_tool("bull 3 r0.5"), 2: parse_tool("ball 2")}
LENGTHS = {1: 40.0, 2: 55.0}
ORIGIN = np.array([10.0, -3.0, -20.0])


def stock() -> Dexels:
    return Dexels((0.0, 0.0), (10.0, 8.0), 0.2, 0.0, -3.0)


def settings() -> MachineSettings:
    offsets = dict.fromkeys(ALL_OFFSETS, (0.0, 0.0, 0.0)) | {"G54": (10.0, -3.0, -20.0)}
    return MachineSettings(
        start_mm=(0.0, 0.0, 100.0),
        offsets=offsets,
        tools={n: ToolOffset(length_mm=length) for n, length in LENGTHS.items()},
    )


def test_arrays_leave_what_moves_leave() -> None:
    by_arrays, by_moves = stock(), stock()
    cut_program(by_arrays, PROGRAM, TOOLS, settings=settings(), origin_mm=ORIGIN, tool_length_mm=LENGTHS)
    moves = moves_from_nc(
        interpret(PROGRAM, settings=settings()),
        origin_mm=ORIGIN,
        start_mm=settings().start_mm,
        tool_length_mm=LENGTHS,
        rapid_mm_min=1000.0,
    )
    by_moves.cut_moves([m for m in moves if isinstance(m, Move)], TOOLS)
    assert by_arrays.heights_mm.min() == pytest.approx(-1.5, abs=0.1)
    assert np.abs(by_arrays.heights_mm - by_moves.heights_mm).max() < 1e-9


def test_tools_that_are_not_given_cut_nothing() -> None:
    only, both = stock(), stock()
    cut_program(only, PROGRAM, {2: TOOLS[2]}, settings=settings(), origin_mm=ORIGIN, tool_length_mm=LENGTHS)
    cut_program(both, PROGRAM, TOOLS, settings=settings(), origin_mm=ORIGIN, tool_length_mm=LENGTHS)
    assert only.heights_mm.min() == pytest.approx(-0.7, abs=0.01)
    assert (both.heights_mm <= only.heights_mm).all()


def test_a_turned_part_is_refused() -> None:
    with pytest.raises(
        GcodeError, match=r"turn\.nc:2:1: an axis besides X, Y, Z is not at 0; expected a program for three"
    ):
        cut_program(
            stock(),
            "G90 G21 G54 T1 M6\nG0 X1. A30.\nG1 X5. F100\nM30\n",
            TOOLS,
            file="turn.nc",
            dialect=dialect_named("linuxcnc"),
        )
