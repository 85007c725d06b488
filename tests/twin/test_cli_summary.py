"""The tables of a summary, letter by letter; what is watched on the way; numbers in words; the line of progress."""

from __future__ import annotations

import io
import time
from dataclasses import replace

import pytest
from rich.console import Console
from support.fake_replay import FakeReplay
from support.slot_run import SlotRun

from twin import number_format as words
from twin.cli.show.heartbeat import COMPILING, LogProgress
from twin.cli.show.progress import LineProgress, NoProgress, doing, progress, working
from twin.cli.show.summary import Timing, mean_force, print_summary
from twin.jit.notice import compiling
from twin.record import Collision, NcEvent, RunSummary
from twin.run.watch import MOST_COLLISIONS, Watch

HEADER = SlotRun().header()
SUMMARY = FakeReplay().summary(complete=True)
COLLISION = next(r for r in SlotRun().records() if isinstance(r, Collision))


def printed(summary: RunSummary, watch: Watch | None = None, **options: object) -> list[str]:
    console = Console(file=io.StringIO(), width=100)
    print_summary(console, summary, HEADER, watch.groups if watch else (), **options)  # type: ignore[arg-type]
    assert isinstance(console.file, io.StringIO)
    return [line.rstrip() for line in console.file.getvalue().splitlines()]


def rule(lines: list[str]) -> list[str]:
    return ["---" if set(line) == {"─"} else line for line in lines]


def test_the_summary_of_a_run() -> None:
    watch = Watch()
    watch.take(COLLISION)
    watch.take(replace(COLLISION, t_s=9.0, volume_mm3=1.25))
    assert rule(printed(SUMMARY, watch, timing=Timing(setup_s=1.0, wall_s=3.8))) == [
        "slot.nc",
        "machine time  0:07.6                     removed     590.0 mm³",
        "cutting       0:06.0                     peak force  110.5 N",
        "not cutting   0:01.6                     mean force  58.1 N",
        "computed in   0:03.8  (2.00x real time)  collisions  1",
        "",
        "Time and material",
        "tool           cutting     air   rapid  removed, mm³  removal rate, cm³/min",
        "---",
        "T1 ball D8 z2   0:06.0  0:01.2  0:00.4         590.0                   5.90",
        "",
        "Forces on the tool, N",
        "tool                   Fx     Fy    Fz  resultant  torque, N·m  power, W  at line",
        "---",
        "T1 ball D8 z2  peak  40.0  100.0  25.0      110.5        0.200      75.0        4",
        "               mean  25.0   50.0  16.0       58.1        0.100",
        "",
        "NC lines with the highest force",
        "line  peak, N  block",
        "---",
        "   4    110.5  N40 G1 X66 F600",
        "",
        "1 collision",
        "line  tool  collision                count   mm³  first at       X       Y       Z",
        "---",
        "   5    T1  rapid through the stock      2  13.8    0:07.4  60.000  15.000  -2.000",
        "",
    ]


def test_a_run_that_ended_early_says_where() -> None:
    assert printed(replace(SUMMARY, complete=False, machine_time_s=3.21))[0] == (
        "slot.nc   ended early, at 0:03.2 of 0:07.6"
    )


def test_without_forces_there_are_no_tables_of_them() -> None:
    lines = printed(replace(SUMMARY, samples=0))
    assert any(line.endswith("peak force  not computed") for line in lines)
    assert not any(line.startswith(("Forces", "NC lines")) for line in lines)


def test_tools_without_a_cut_have_no_forces_and_no_rate() -> None:
    (tool,) = SUMMARY.tools
    idle = replace(tool, number=0, description="no tool", cutting_time_s=0.0, removed_volume_mm3=0.0)
    lines = printed(replace(SUMMARY, tools=(idle, tool)))
    assert "no tool         0:00.0  0:01.2  0:00.4           0.0" in lines
    assert sum(line.startswith("no tool") for line in lines) == 1


def test_blocks_that_look_like_markup_or_are_long_are_shown_as_text() -> None:
    lines = printed(replace(SUMMARY, top_lines=((7, "G1 X[#1 + 2] [bold](A)", 10.0), (8, "(" + "long " * 40, 9.0))))
    assert "   7     10.0  G1 X[#1 + 2] [bold](A)" in lines
    assert max(map(len, lines)) <= 100


def test_collisions_beyond_the_first_ten_lines_are_counted() -> None:
    watch = Watch()
    for line in range(13):
        watch.take(replace(COLLISION, nc_line=line))
    lines = printed(replace(SUMMARY, collisions=13), watch)
    assert "13 collisions" in lines
    assert sum("rapid through the stock" in line for line in lines) == 10
    assert any("and on 3 further lines" in line for line in lines)


def test_everything_fits_a_terminal_of_100_columns() -> None:
    (tool,) = SUMMARY.tools
    big = replace(
        tool,
        description="taper D16 rc3.5 12.5deg z12",
        cutting_time_s=40000.0,
        removed_volume_mm3=1.25e7,
        peak_force_n=(12345.6, 23456.7, 3456.7, 34567.8),
        peak_power_w=23456.7,
        peak_line=123456,
    )
    watch = Watch()
    watch.take(replace(COLLISION, kind="spindle-stopped", nc_line=123456, tool=12, point_mm=(-1234.5, 2345.6, -345.6)))
    lines = printed(replace(SUMMARY, tools=(big,)), watch, timing=Timing(setup_s=1.0, wall_s=1e4))
    assert max(map(len, lines)) <= 100
    for number in ("34 568", "123456", "23 457", "12 500 000", "-1234.500"):
        assert any(number in line for line in lines)


def test_the_workpiece_feels_the_opposite_mean() -> None:
    assert mean_force((1.0, -2.0, 3.0, 4.0), "tool") == (1.0, -2.0, 3.0, 4.0)
    assert mean_force((1.0, -2.0, 3.0, 4.0), "workpiece") == (-1.0, 2.0, -3.0, 4.0)


def test_watch_keeps_a_bounded_number_of_collisions() -> None:
    watch = Watch()
    for i in range(MOST_COLLISIONS + 5):
        watch.take(replace(COLLISION, t_s=float(i)))
    assert len(watch.collisions) == MOST_COLLISIONS
    assert [(g.count, g.t_s) for g in watch.groups] == [(MOST_COLLISIONS + 5, 0.0)]


def test_words_without_effect_are_named_once_each() -> None:
    watch = Watch()
    for line, text in enumerate(["G64", "G64", "M50", "A", "B", "C", "D", "G64"], start=1):
        watch.take(NcEvent(t_s=0.0, nc_line=line, kind="notice", text=text))
    assert watch.warnings(replace(SUMMARY, collisions=0)) == [
        *("line 1: G64 (and 2 more like it)", "line 3: M50", "line 4: A", "line 5: B", "line 6: C"),
        "1 more kind of words without effect; see the archive",
    ]


def test_a_program_without_feed_motions_is_told_so() -> None:
    watch = Watch()
    watch.take(HEADER)
    (warning,) = watch.warnings(replace(SUMMARY, removed_volume_mm3=0.0))
    assert warning.startswith("no material was cut: there is no feed motion, the stock is at X 0..60 Y 0..30 Z -20..0;")


@pytest.mark.parametrize(
    ("seconds", "text"),
    [
        (0.0, "0:00.0"),
        (9.96, "0:10.0"),
        (59.96, "1:00.0"),
        (3599.9, "59:59.9"),
        (3599.96, "1:00:00"),
        (7384, "2:03:04"),
    ],
)
def test_clock(seconds: float, text: str) -> None:
    assert words.clock(seconds) == text


@pytest.mark.parametrize(
    ("value", "text"),
    [(0.0, "0.000"), (0.1436, "0.144"), (1.0, "1.00"), (66.53, "66.5"), (999.96, "1 000"), (-12345.6, "-12 346")],
)
def test_digits(value: float, text: str) -> None:
    assert words.digits(value) == text


def test_a_column_has_the_decimals_of_its_largest_number() -> None:
    assert words.column([0.123, -0.5]) == ["0.123", "-0.500"]
    assert words.column([0.123, 66.55]) == ["0.1", "66.5"]
    assert words.column([12345.6, 0.3]) == ["12 346", "0"]
    assert words.column([]) == []


@pytest.mark.parametrize(("count", "text"), [(0, "0 B"), (999, "999 B"), (20448820, "20.4 MB"), (3e9, "3.0 GB")])
def test_size(count: float, text: str) -> None:
    assert words.size(count) == text


@pytest.mark.parametrize(("mm3", "text"), [(422.27, "422.3 mm³"), (9999.0, "9 999 mm³"), (10100.0, "10.1 cm³")])
def test_volume(mm3: float, text: str) -> None:
    assert words.volume(mm3) == text


def test_short_work_is_silent_where_standard_error_is_no_terminal(capsys: pytest.CaptureFixture[str]) -> None:
    assert isinstance(progress(quiet=True), NoProgress)
    with progress(quiet=False) as line, working(quiet=False) as share, doing("comparing") as task:
        assert isinstance(line, LogProgress)
        line.start(10.0)
        line.at(1.0, 3)
        share("roughing", 0.5)
        task("reading")
    captured = capsys.readouterr()
    assert (captured.out, captured.err) == ("", "")


def test_lines_without_a_terminal_have_task_share_pace_and_time_left() -> None:
    clock = iter([100.0, 104.0, 105.0, 107.0, 107.0])
    line = LogProgress(lambda: next(clock))
    line.task("slicing the stock")
    assert line.text() == "preparing: slicing the stock (0:04.0)"
    line.start(60.0)
    line.at(30.0, 12)
    assert line.text() == "replaying: 50 %, 0:30.0 of 1:00.0, 15.0x real time, line 12, about 2 s left"


def test_the_time_left_after_compiling_is_that_of_the_last_lines() -> None:
    clock = iter([100.0, 100.0, 110.0, 120.0, 130.0])
    line = LogProgress(lambda: next(clock))
    line.start(60.0)
    line._beat.compiled = True
    line.at(6.0, 12)
    assert line.text().endswith("0.6x real time, line 12, about 90 s left")
    assert line.text().endswith("line 12")  # it stands still: code is being compiled
    line.at(36.0, 15)
    assert line.text().endswith("about 8 s left")


def test_long_work_without_a_terminal_prints_lines(capsys: pytest.CaptureFixture[str]) -> None:
    with LogProgress(every_s=0.01) as line:
        line.task("slicing the stock")
        compiling()
        compiling()
        time.sleep(0.1)
    time.sleep(0.02)
    lines = capsys.readouterr().err.splitlines()
    assert lines[0] == COMPILING and lines.count(COMPILING) == 1
    assert lines[1].startswith("preparing: slicing the stock (0:00.")
    assert not capsys.readouterr().err


def test_progress_shows_time_place_and_pace(monkeypatch: pytest.MonkeyPatch) -> None:
    shown = io.StringIO()
    console = Console(file=shown, force_terminal=True, width=120, color_system=None)
    monkeypatch.setattr("twin.cli.show.progress.errors", lambda: console)
    clock = iter([100.0, 102.0, 102.05])
    with LineProgress(lambda: next(clock)) as line:
        line.task("reading slot.nc")
        line._bar.refresh()
        compiling()
        line.start(60.0)
        line.at(30.0, 12)
        line.at(31.0, 13)
    text = shown.getvalue()
    assert "preparing: reading" in text and COMPILING in text
    assert " 50% 0:30.0 of 1:00.0  15.0x real time  line 12" in text
    assert "line 13" not in text
