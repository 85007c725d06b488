"""Motion arrays hold what the events say, however they are cut."""

from __future__ import annotations

import math
from collections.abc import Iterator
from pathlib import Path
from typing import Any, TypeVar

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from gcode.dialects import dialect_named
from gcode.errors import GcodeError
from gcode.events import NO_EXTRA, ArcMotion, Dwell, Event, LinearMotion
from gcode.flow.interpreter import interpret
from gcode.report.motion_arrays import MotionArrays, MotionKind, concatenate, motion_arrays
from gcode.report.motion_json import type_of
from gcode.settings import MachineSettings

_T = TypeVar("_T")

SURFACE = "".join(f"X{i * 0.1:.3f} Z{-i % 7}.\n" for i in range(40))
PROGRAM = f"""%
O1
G21 G90 G54
T3 M6
S1000 M3
G0 X1. Y2. Z3.
G4 P1500
G1 Z0. F300.
{SURFACE}G3 X5. Y5. R9.
G18 G2 X1. Z1. R9. F80.
M4 S500
G1
{SURFACE}G17 G3 I1. J1. Z-2.
G91 G1
{SURFACE}G90
M29 S200
G84 X1. Y1. Z-3. R2. F200.
G80
G0 Z9.
M30
"""
COLUMNS = (
    *("kind", "line", "start_mm", "end_mm", "centre_mm", "plane", "turns", "feed_mm_min", "seconds", "extra"),
    *("tool", "spindle_rpm", "spindle_direction"),
)


def whole(text: str | Path, **options: Any) -> MotionArrays:
    return concatenate(motion_arrays(text, **options))


def of_events(events: list[Event], start_mm: tuple[float, float, float]) -> dict[str, list[Any]]:
    """The columns, from one event after another."""
    rows: list[tuple[Any, ...]] = []
    at, extra = start_mm, NO_EXTRA
    for event in events:
        arc: tuple[Any, ...] = ((math.nan,) * 3, 0, 0)
        start = at
        if isinstance(event, LinearMotion | ArcMotion):
            start, at, extra = event.start_mm, event.end_mm, event.extra
            feed, seconds = event.feed_mm_min, 0.0
            if isinstance(event, ArcMotion):
                arc = (event.centre_mm, event.plane, event.turns)
        elif isinstance(event, Dwell):
            feed, seconds = 0.0, event.seconds
        else:
            continue
        state = event.state
        modal = (state.tool, state.spindle_rpm, state.spindle_direction)
        kind = MotionKind[type_of(event).upper()]
        rows.append((kind, event.place.line, start, at, *arc, feed, seconds, extra, *modal))
    return {name: [row[index] for row in rows] for index, name in enumerate(COLUMNS)}


def until_refused(source: Iterator[_T]) -> tuple[list[_T], str]:
    """What comes before a refusal, and the refusal."""
    taken: list[_T] = []
    try:
        for one in source:
            taken.append(one)  # noqa: PERF402 what comes before a refusal counts
    except GcodeError as error:
        return taken, str(error)
    return taken, ""


def check(made: MotionArrays, expected: dict[str, list[Any]]) -> None:
    for name in COLUMNS:
        column = getattr(made, name)
        assert column.tobytes() == np.array(expected[name], dtype=column.dtype).tobytes(), name


@pytest.mark.parametrize("rows", [1, 7, 64, 65536])
def test_arrays_are_the_events(rows: int) -> None:
    start = MachineSettings(start_mm=(0.5, -0.5, 40.0), offsets={"G54": (0.1, 0.2, 0.3)})
    parts = list(motion_arrays(PROGRAM, settings=start, rows=rows))
    made = concatenate(parts)
    events = list(interpret(PROGRAM, settings=start))
    check(made, of_events(events, start.start_mm))
    assert set(made.kind) == set(MotionKind)
    assert {len(part) for part in parts[:-1]} <= {rows}
    assert 0 < len(parts[-1]) <= rows
    states = [e.state for e in events if isinstance(e, LinearMotion | ArcMotion | Dwell)]
    assert [made.states[index] for index in made.state] == states


@settings(max_examples=40, deadline=None)
@given(
    st.lists(
        st.sampled_from([*PROGRAM.splitlines()[2:-1], "G20", "G55", "G53 G0 Z0", "M5", "X1 A5", "U2", "M6 T4"]),
        max_size=40,
    ),
    st.sampled_from(["fanuc", "linuxcnc"]),
    st.integers(1, 20),
)
def test_arrays_are_the_events_up_to_a_refusal(lines: list[str], dialect: str, rows: int) -> None:
    text = "\n".join([*lines, "M30", ""])
    events, refused = until_refused(interpret(text, dialect=dialect_named(dialect)))
    parts, refused_too = until_refused(motion_arrays(text, dialect=dialect_named(dialect), rows=rows))
    assert refused_too == refused
    check(concatenate(parts), of_events(events, (0.0, 0.0, 0.0)))


def test_motions_before_a_refusal_come_first() -> None:
    source = motion_arrays(f"G1 F100\n{SURFACE}G999\n")
    assert len(next(source)) == 40
    with pytest.raises(GcodeError, match="unknown-code"):
        next(source)


def test_a_path_and_the_files_it_calls(tmp_path: Path) -> None:
    main, called = tmp_path / "main.nc", tmp_path / "O200.nc"
    main.write_text(f"O1\nG1 F100\n{SURFACE}M98 P200\nG0 X0\nM30\n")
    called.write_text(f"O200\n{SURFACE}G4 P10\nM99\n")
    made = whole(main)
    assert [made.files[index] for index in made.file] == [str(main)] * 40 + [str(called)] * 41 + [str(main)]
    assert made.line.tolist() == [*range(3, 43), *range(2, 43), 44]


def test_a_dwell_is_where_the_last_motion_ended() -> None:
    made = whole("G4 P500\nG0 X1.\nG4 P1000\nM30\n", settings=MachineSettings(start_mm=(7.0, 8.0, 9.0)))
    assert made.kind.tolist() == [MotionKind.DWELL, MotionKind.RAPID, MotionKind.DWELL]
    assert made.start_mm.tolist() == [[7, 8, 9], [7, 8, 9], [1, 8, 9]]
    assert made.end_mm.tolist() == [[7, 8, 9], [1, 8, 9], [1, 8, 9]]
    assert made.seconds.tolist() == [0.5, 0, 1]


def test_states_that_no_motion_has_are_left_out() -> None:
    text = "".join(f"S{number} M3\nG0 X{number}.\n" for number in range(1, 31)) + "M30\n"
    parts = list(motion_arrays(text, rows=10))
    assert [len(concatenate([part]).states) for part in parts] == [10, 10, 10]
    assert len(concatenate(parts).states) == 30
    assert concatenate(parts).spindle_rpm.tolist() == [*range(1, 31)]


def test_no_motions() -> None:
    assert list(motion_arrays("M3 S1\nM30\n")) == []
    made = concatenate([])
    assert len(made) == 0
    assert made.end_mm.shape == (0, 3)
    assert made.tool.tolist() == []


def test_a_part_of_the_motions() -> None:
    made = whole(PROGRAM)[5:9]
    assert len(made) == 4
    assert made.line.tolist() == whole(PROGRAM).line[5:9].tolist()


def test_arrays_are_read_only() -> None:
    made = whole(PROGRAM)
    for name in COLUMNS[:10]:
        with pytest.raises(ValueError, match="read-only"):
            getattr(made, name)[0] = 0


def test_columns_have_one_length() -> None:
    made = whole(PROGRAM)
    values = {name: getattr(made, name) for name in MotionArrays.__dataclass_fields__}
    with pytest.raises(ValueError, match="turns has 1 rows, kind has"):
        MotionArrays(**(values | {"turns": np.zeros(1, np.int32)}))


def test_rows_below_one_are_refused() -> None:
    with pytest.raises(ValueError, match="rows must be 1 or more, got 0"):
        next(motion_arrays("M30\n", rows=0))
