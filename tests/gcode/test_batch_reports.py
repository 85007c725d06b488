"""Statistics and JSON lines of runs of plain lines are those of their events, to the last digit."""

from __future__ import annotations

import json
import math
from functools import partial
from typing import Any
from unittest.mock import patch

import numpy as np
from hypothesis import example, given, settings
from hypothesis import strategies as st
from support.nc_lines import ARC_WORDS, plain_lines

from gcode.bulk.plain_batch import PlainBatch
from gcode.bulk.plain_runs import plain_run
from gcode.errors import GcodeError
from gcode.events import Event
from gcode.flow.interpreter import interpret, run
from gcode.report.batch_lines import motion_lines, rounded
from gcode.report.motion_json import motion_objects
from gcode.report.stats import MOST_VALUES, program_stats
from gcode.settings import Limits, MachineSettings

START = (0.1, -0.2, 3.3)
SPIRALS = "".join(f"X{1 + n % 5}I{0.5 + n % 5 / 2 + 0.0001 * (n % 7)}\nG{2 + n % 2}Y1J.5Z-.1\n" for n in range(20))


def events_of(text: str, dialect: str) -> tuple[list[Event], list[Event | PlainBatch]]:
    """The events up to the first refusal: one by one, and with runs of plain lines together."""
    machine = MachineSettings(start_mm=START, limits=Limits(blocks=200))
    both: tuple[list[Any], list[Any]] = ([], [])
    with patch("gcode.flow.runner.plain_run", partial(plain_run, least_lines=1)):
        for found, read in zip(both, (interpret, run), strict=True):
            try:
                for event in read(text, file="\u202et.nc", dialect=dialect, settings=machine):
                    found.append(event)
            except GcodeError:
                pass
    return both


@settings(max_examples=100, deadline=None)
@given(
    st.lists(st.one_of(*[ARC_WORDS] * 4, plain_lines()), max_size=40).map("".join),
    st.sampled_from(["fanuc", "linuxcnc"]),
)
@example(f"S5M3\nG2\n{SPIRALS}", "fanuc")
@example(f"G18S5M4\nG3\n{SPIRALS}", "linuxcnc")
@example("".join(f"F{n + 1}S{n}X1\n" for n in range(MOST_VALUES + 3)), "fanuc")
def test_reports_of_runs_are_those_of_events(lines: str, dialect: str) -> None:
    single, together = events_of(f"G91 G1 F90\n{lines}M30\n", dialect)
    assert "".join(motion_lines(together, START)) == "".join(
        f"{json.dumps(made)}\n" for made in motion_objects(single, START)
    )
    assert program_stats(together) == program_stats(single)


@given(st.lists(st.floats(-1e8, 1e8), min_size=1))
@example([0.0000000005, 2.0000000015, 1e6, -0.0, -1e-12, 0.1 + 0.2, 123456.7890000005, 1000000.0000000005])
def test_rounding_is_that_of_python(values: list[float]) -> None:
    expected = [round(value, 9) + 0.0 for value in values]
    assert rounded(np.array(values)).tolist() == expected
    assert all(math.copysign(1.0, value) > 0 for value in rounded(np.array([-0.0, -1e-12])).tolist())


def test_a_batch_names_its_last_line() -> None:
    batch = next(event for event in run("G0 X1\n" * 9, file="t.nc") if isinstance(event, PlainBatch))
    assert (batch.place.file, batch.place.line) == ("t.nc", 9)
