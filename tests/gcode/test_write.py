"""Programs that are written are read back to the motions they were written from."""

from __future__ import annotations

import itertools
import math
import random
from dataclasses import replace
from pathlib import Path as File
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from support.rs274 import RS274, moves_of, run_text
from support.rs274_compare import first_difference, lasting, moves_of_events
from support.streams import PLACE, START, TOOLS, Path, motions_of, random_stream

from gcode.dialects import DIALECTS, LINUXCNC
from gcode.events import ArcMotion, CoolantChange, Dwell, Event, LinearMotion, Motion, ProgramStop, SpindleChange
from gcode.flow.interpreter import interpret
from gcode.report.path_geometry import length_mm, points_mm
from gcode.settings import MachineSettings
from gcode.write import WriteError, WriteOptions, program_lines, write_program

SETTINGS = MachineSettings(tools=TOOLS, start_mm=START)
MANY_TOOLS = ["fanuc", "haas", "linuxcnc"]


def text_of(events: list[Event], dialect: str = "fanuc", **options: Any) -> str:
    return "\n".join(program_lines(events, WriteOptions(dialect=DIALECTS[dialect], **options))) + "\n"


def read_back(text: str, dialect: str = "fanuc", **settings: Any) -> list[Event]:
    return list(interpret(text, dialect=DIALECTS[dialect], settings=replace(SETTINGS, **settings)))


def assert_same_motions(made: list[Motion], wanted: list[Motion], step_mm: float) -> None:
    assert [type(motion) for motion in made] == [type(motion) for motion in wanted]
    for mine, theirs in zip(made, wanted, strict=True):
        assert math.dist(mine.end_mm, theirs.end_mm) <= 0.87 * step_mm + 1e-9
        helix = isinstance(theirs, ArcMotion)  # F may be for its arc, whose length is rounded with its ends
        assert mine.feed_mm_min == pytest.approx(theirs.feed_mm_min, rel=1e-2 if helix else 1e-5, abs=6e-4)
        held = ("tool", "spindle_rpm", "spindle_direction", "length_offset_mm", "length_number")
        assert [getattr(mine.state, n) for n in held] == [getattr(theirs.state, n) for n in held]
        if isinstance(mine, LinearMotion) and isinstance(theirs, LinearMotion):
            assert (mine.rapid, mine.tapping) == (theirs.rapid, theirs.tapping)
        if isinstance(mine, ArcMotion) and isinstance(theirs, ArcMotion):
            assert_same_arc(mine, theirs, step_mm)


def assert_same_arc(mine: ArcMotion, theirs: ArcMotion, step_mm: float) -> None:
    assert (mine.plane, mine.turns) == (theirs.plane, theirs.turns)
    radius = math.dist(theirs.start_mm, theirs.centre_mm)
    assert math.dist(mine.centre_mm, theirs.centre_mm) <= 2.5 * step_mm
    assert abs(mine.sweep_rad - theirs.sweep_rad) * radius <= 5.0 * step_mm + 1e-9


def only_single_turns(events: list[Event]) -> list[Event]:
    """Arcs of many turns left out, and with them all that follows where it would leave a gap."""
    kept = []
    for event in events:
        if isinstance(event, ArcMotion) and abs(event.turns) > 1:
            break
        kept.append(event)
    return kept


OPTIONS = st.fixed_dictionaries(
    {
        "units": st.sampled_from(["mm", "inch"]),
        "distance": st.sampled_from(["absolute", "incremental"]),
        "arcs": st.sampled_from(["centre", "radius"]),
        "modal": st.booleans(),
        "number_step": st.sampled_from([None, 1, 10]),
        "shift_mm": st.sampled_from([(0.0, 0.0, 0.0), (12.34567, -300.0, 7.1)]),
        "safe_start": st.booleans(),
    }
)


@given(st.randoms(use_true_random=False), st.integers(1, 30), st.sampled_from(MANY_TOOLS), OPTIONS)
@settings(max_examples=120)
def test_what_is_written_is_read_back(source: random.Random, steps: int, dialect: str, options: dict[str, Any]) -> None:
    events = random_stream(source, steps)
    if dialect != "linuxcnc":
        events = only_single_turns(events)
    written = WriteOptions(dialect=DIALECTS[dialect], tools=TOOLS, **options)
    text = "\n".join(program_lines(events, written))
    made = read_back(text, dialect, offsets={"G54": options["shift_mm"]})
    assert_same_motions(strokes_of(made), motions_of(events), written.grid.step_mm)
    assert between_motions(made) == between_motions(events)


def strokes_of(events: list[Event]) -> list[Motion]:
    """The motions that were written: a tapping cycle has besides its way to the hole, where the tool is already."""
    return [m for m in motions_of(events) if not (isinstance(m, LinearMotion) and m.rapid and "G99" in m.place.text)]


def between_motions(events: list[Event]) -> list[tuple[Any, ...]]:
    """Dwells and stops, each with the coolant that holds."""
    coolant, made = (False, False), []
    for event in events:
        if isinstance(event, CoolantChange):
            coolant = (event.mist, event.flood)
        elif isinstance(event, Dwell):
            made.append((round(event.seconds, 6), coolant))
        elif isinstance(event, ProgramStop) and not event.end:
            made.append((event.optional, coolant))
    return made


@given(st.randoms(use_true_random=False), st.integers(1, 12))
@settings(max_examples=60)
def test_grbl(source: random.Random, steps: int) -> None:
    events = only_single_turns(random_stream(source, steps, changes=False))
    made = read_back(text_of(events, dialect="grbl"), "grbl", tools=None)
    assert_same_motions(motions_of(made), motions_of(events), 1e-4)


@given(st.randoms(use_true_random=False), st.sampled_from(["fanuc", "grbl"]))
@settings(max_examples=60)
def test_turns_that_a_control_cannot_count_are_written_one_by_one(source: random.Random, dialect: str) -> None:
    path = Path(source)
    turns = source.randint(2, 5)
    path.line()
    path.arc(radius=source.uniform(1.0, 50.0), turns=turns)
    _, arc = motions_of(path.events)
    made = motions_of(read_back(text_of(path.events, dialect=dialect), dialect))[1:]
    assert len(made) == turns
    assert all(isinstance(one, ArcMotion) and abs(one.turns) == 1 for one in made)
    assert isinstance(arc, ArcMotion)
    assert sum(one.sweep_rad for one in made if isinstance(one, ArcMotion)) == pytest.approx(arc.sweep_rad, abs=0.02)
    assert sum(map(length_mm, made)) == pytest.approx(length_mm(arc), rel=1e-2)
    heights = {17: 2, 18: 1, 19: 0}[arc.plane]
    rise = arc.end_mm[heights] - arc.start_mm[heights]
    for one in made[:-1]:
        climbed = one.end_mm[heights] - one.start_mm[heights]
        assert climbed == pytest.approx(rise * math.tau / abs(arc.sweep_rad), abs=2e-3)


@given(
    st.randoms(use_true_random=False),
    st.floats(1e-5, 0.05),
    st.one_of(st.floats(1e-6, 0.05), st.floats(math.tau - 0.05, math.tau - 1e-9), st.floats(0.05, 6.2)),
    st.sampled_from(sorted(DIALECTS)),
    st.sampled_from(["mm", "inch"]),
    st.sampled_from(["centre", "radius"]),
)
@settings(max_examples=150)
def test_tiny_arcs_stay_tiny(
    source: random.Random, radius: float, sweep: float, dialect: str, units: str, arcs: str
) -> None:
    """Rounding never makes a full circle of next to nothing, or nothing of a full circle that can be seen."""
    path = Path(source)
    path.line()
    path.arc(radius=radius, sweep=sweep, turns=1, rise=0.0)
    _, arc = motions_of(path.events)
    options = WriteOptions(dialect=DIALECTS[dialect], units=units, arcs=arcs)  # type: ignore[arg-type]
    made = motions_of(read_back("\n".join(program_lines(path.events, options)), dialect))[1:]
    step = options.grid.step_mm
    reached = np.concatenate([points_mm(one, step / 500.0) for one in made])
    true = points_mm(arc, step / 500.0)
    apart = np.linalg.norm(reached[:, None, :] - true[None, :, :], axis=2)
    assert apart.min(axis=1).max() <= 5.0 * step
    assert apart.min(axis=0).max() <= 5.0 * step
    assert sum(map(length_mm, made)) <= 1.5 * length_mm(arc) + 10.0 * step


def test_an_arc_is_led_in_where_no_word_has_named_its_start() -> None:
    """FANUC takes G43 together with G0 and G1 only, and the start of an arc decides its sweep."""
    path = Path(random.Random(5), at=(0.0, 0.0, 90.0))
    path.state = replace(path.state, length_number=1, length_offset_mm=75.0)
    path.arc(radius=10.0, sweep=1.0, turns=1, rise=0.0)
    lines = text_of(path.events).splitlines()
    assert lines[2].startswith("G43 H1 G1 X0. Y0. Z90. F")
    assert lines[3].startswith(("G2", "G3", "G18", "G19"))


def test_incremental_words_do_not_drift() -> None:
    """Each third of a count is lost or won by rounding: 1000 of them add up to what they are."""
    path = Path(random.Random(1), at=(0.0, 0.0, 0.0))
    path.line((0.0, 0.0, 0.0), rapid=True)
    for n in range(1, 3001):
        path.line((n / 3000.0, 0.0, n / 7000.0), rapid=False, feed=100.0)
    text = text_of(path.events, distance="incremental")
    assert "G91" in text
    last = motions_of(read_back(text))[-1]
    assert last.end_mm == pytest.approx((1.0, 0.0, 0.429), abs=5.1e-4)
    assert len(motions_of(read_back(text))) == 3001


@pytest.mark.skipif(RS274 is None, reason="rs274 is not installed")
@pytest.mark.parametrize("seed", range(24))
def test_rs274_reads_the_same_motions(seed: int, tmp_path: File) -> None:
    source = random.Random(seed)
    events = random_stream(source, 120, decimals=4)
    options = WriteOptions(
        dialect=LINUXCNC,
        units=source.choice(("mm", "inch")),  # type: ignore[arg-type]
        distance=source.choice(("absolute", "incremental")),  # type: ignore[arg-type]
        arcs=source.choice(("centre", "radius")),  # type: ignore[arg-type]
        decimals=5,
        modal=source.random() < 0.5,
    )
    table = tmp_path / "tool.tbl"
    rows = [f"T{n} P{n} Z{row.whole_length_mm / 25.4:.7f} D{row.radius_mm / 12.7:.6f}" for n, row in TOOLS.items()]
    table.write_text("\n".join(rows) + "\n")
    listing = run_text("\n".join(program_lines(events, options)) + "\n", tmp_path, table=table)
    assert listing.error == ""
    assert first_difference(lasting(moves_of(listing.calls, sorted(TOOLS))), lasting(moves_of_events(events))) == ""


def test_a_fanuc_program_in_full() -> None:
    """What a machinist reads: known modes, the tool, its length beside the first motion, modal words once."""
    path = Path(random.Random(1), at=(0.0, 0.0, 200.0))
    path.tool(1)
    path.events.pop()
    path.at = (0.0, 0.0, 200.0)
    path.state = replace(path.state, spindle_rpm=3600.0, spindle_direction=1)
    path.length(1)
    path.events.pop()
    path.at = (0.0, 0.0, 125.0)
    path.line((10.0, 5.0, 20.0), rapid=True)
    path.line((10.0, 5.0, -2.0), rapid=False, feed=120.0)
    path.line((30.0, 5.0, -2.0), rapid=False, feed=400.0)
    path.events.append(
        ArcMotion(
            place=PLACE, state=path.state, start_mm=path.at, end_mm=(40.0, 15.0, -2.0), centre_mm=(30.0, 15.0, -2.0),
            plane=17, turns=1, feed_mm_min=400.0,
        )
    )  # fmt: skip
    path.at = (40.0, 15.0, -2.0)
    path.line((40.0, 15.0, 20.0), rapid=True)
    path.events.append(CoolantChange(place=PLACE, mist=False, flood=False))
    path.events.append(ProgramStop(place=PLACE, optional=False, end=True))
    options = {"program_number": 12, "header": ("SLOT", "T1 BALL D10")}
    assert text_of(path.events, **options).splitlines() == [
        "%",
        "O0012",
        "(SLOT)",
        "(T1 BALL D10)",
        "G21 G17 G40 G49 G80 G90 G94 G54",
        *([f"S{path.events[0].spindle_rpm:g}"] if isinstance(path.events[0], SpindleChange) else []),
        "T1 M6",
        "S3600 M3",
        "G43 H1 G0 X10. Y5. Z20.",
        "G1 Z-2. F120",
        "X30. F400",
        "G3 X40. Y15. I0. J10.",
        "G0 Z20.",
        "M30",
        "%",
    ]


@pytest.mark.parametrize("dialect", MANY_TOOLS)
@pytest.mark.parametrize("forward", [1, -1])
@pytest.mark.parametrize(("seconds", "rigid"), [(0.0, False), (0.0, True), (0.25, False), (0.25, True)])
def test_taps(dialect: str, forward: int, seconds: float, rigid: bool) -> None:
    path = Path(random.Random(1))
    path.tool(2)
    path.line((1.0, 2.0, 10.0), rapid=True)
    path.tap(seconds=seconds, rigid=rigid, forward=forward)
    path.line((5.0, 2.0, 10.0), rapid=True)
    if dialect == "linuxcnc" and seconds:
        with pytest.raises(WriteError, match=r"a tap with a dwell of 0[.]25 s; expected a tap without a dwell"):
            text_of(path.events, dialect=dialect)
        return
    made = read_back(text_of(path.events, dialect=dialect), dialect)
    assert_same_motions(strokes_of(made), motions_of(path.events), 1e-3)


def test_a_length_that_is_subtracted_is_g44() -> None:
    path = Path(random.Random(1))
    path.line()
    path.length(1, sign=-1.0)
    assert "\nG44 H1 " in text_of(path.events, tools=TOOLS)
    made = motions_of(read_back(text_of(path.events, tools=TOOLS)))
    assert_same_motions(made, motions_of(path.events), 1e-3)


def test_block_numbers_begin_anew_where_a_control_has_no_more() -> None:
    path = Path(random.Random(1))
    for n in range(250):
        path.line((float(n), 0.0, 0.0), rapid=True)
    lines = text_of(path.events, number_step=1000).splitlines()
    assert [line.split()[0] for line in lines[1:4]] == ["N1000", "N2000", "N3000"]
    assert lines[99].startswith("N99000 ")
    assert lines[100].startswith("N1000 ")


def test_a_file_is_written_whole_or_not_at_all(tmp_path: File) -> None:
    path = tmp_path / "part.nc"
    good = random_stream(random.Random(3), 20)
    assert write_program(path, good) == len(path.read_text().splitlines())
    before = path.read_text()
    with pytest.raises(WriteError):
        write_program(path, [*good, replace(motions_of(good)[0], start_mm=(1e6, 0.0, 0.0))])
    assert path.read_text() == before
    assert [file.name for file in tmp_path.iterdir()] == ["part.nc"]


def test_lines_come_while_events_come() -> None:
    """Nothing is collected: a long tool path is written in the memory of one motion."""

    def endless() -> Any:
        for n in itertools.count():
            yield LinearMotion(
                place=PLACE, state=Path(random.Random(1)).state, start_mm=(float(n), 0.0, 0.0),
                end_mm=(n + 1.0, 0.0, 0.0), rapid=False, feed_mm_min=100.0,
            )  # fmt: skip

    assert list(itertools.islice(program_lines(endless()), 4))[-1] == "X2."
