"""Reading the canonical calls of ``rs274``, which the comparisons rest on: every expectation is worked out by hand."""

from __future__ import annotations

import math
from pathlib import Path

import pytest
from support.rs274 import RS274, Move, moves_of, rows_of, run

needs_rs274 = pytest.mark.skipif(RS274 is None, reason="rs274 is not installed")
TABLE = "T7 P2 Z2.0 D0.25\nT1 P5 Z3.5 X0.5 D0.5\nT9 P6 Z1 D0.1\n"


def ends(moves: list[Move]) -> list[tuple[float, float, float]]:
    return [move.end for move in moves]


def listed(text: str, folder: Path, table: str = TABLE) -> list[Move]:
    """The moves of a program that runs."""
    (folder / "program.ngc").write_text(text)
    (folder / "tools.tbl").write_text(table)
    listing = run(folder / "program.ngc", table=folder / "tools.tbl")
    assert not listing.error
    return moves_of(listing.calls, rows_of(folder / "tools.tbl"))


def test_a_point_is_shifted_then_turned_then_offset() -> None:
    calls = [
        ("SET_G5X_OFFSET", "1, 10.0000, 20.0000, 30.0000, 0.0000, 0.0000, 0.0000"),
        ("SET_G92_OFFSET", "1.0000, 2.0000, 3.0000, 0.0000, 0.0000, 0.0000"),
        ("SET_XY_ROTATION", "90.0000"),
        ("STRAIGHT_TRAVERSE", "4.0000, 0.0000, 5.0000, 6.0000, 0.0000, 0.0000"),
    ]
    (move,) = moves_of(calls)
    assert move.end == pytest.approx((10.0 - 2.0, 20.0 + 5.0, 38.0))
    assert move.abc == (6.0, 0.0, 0.0)


def test_offsets_keep_their_place_over_a_change_of_units() -> None:
    offset, go = "1, 1.0000, 0.0000, 0.0000, 0.0000, 0.0000, 0.0000", "1.0000, 0.0000, 0.0000, 0.0000, 0.0000, 0.0000"
    inch, mm = ("USE_LENGTH_UNITS", "CANON_UNITS_INCHES"), ("USE_LENGTH_UNITS", "CANON_UNITS_MM")
    moves = moves_of([inch, ("SET_G5X_OFFSET", offset), ("STRAIGHT_FEED", go), mm, ("STRAIGHT_FEED", go)])
    assert ends(moves) == [(50.8, 0.0, 0.0), (26.4, 0.0, 0.0)]


@pytest.mark.parametrize(("plane", "name"), [(17, "XY"), (18, "XZ"), (19, "YZ")])
def test_an_arc_is_read_in_its_plane(plane: int, name: str) -> None:
    calls = [
        ("SELECT_PLANE", f"CANON_PLANE_{name}"),
        ("ARC_FEED", "1.0000, 2.0000, 3.0000, 4.0000, -2, 5.0000, 0.0, 0.0, 0.0"),
    ]
    (arc,) = moves_of(calls)
    order = {17: (1.0, 2.0, 5.0), 18: (2.0, 5.0, 1.0), 19: (5.0, 1.0, 2.0)}
    middle = {17: (3.0, 4.0, 0.0), 18: (4.0, 0.0, 3.0), 19: (0.0, 3.0, 4.0)}
    assert (arc.kind, arc.plane, arc.turns) == ("arc", plane, -2)
    assert (arc.end, arc.centre) == (order[plane], middle[plane])


def test_comments_that_look_like_calls_are_none() -> None:
    assert not moves_of([("COMMENT", '"STRAIGHT_FEED(1, 2, 3, 0, 0, 0)"')])


@needs_rs274
def test_machine_coordinates_are_the_tip_where_a_length_holds(tmp_path: Path) -> None:
    """G53 Z0 puts the gauge point to 0, so the tip of a tool of 2 inches is at -50.8."""
    moves = listed("G21 G10 L2 P1 X5 Z7 R30\nT7 M6 G43\nG53 G0 X1 Y2 Z0\nM2\n", tmp_path)
    assert moves[-1].end == pytest.approx((1.0, 2.0, -50.8), abs=1e-3)


@needs_rs274
def test_tools_are_told_by_number_whatever_their_row(tmp_path: Path) -> None:
    moves = listed("T1 M6\nG0 X1\nM61 Q9\nG0 X2\nT0 M6\nG0 X3\n" + "M2\n", tmp_path)
    assert [move.tool for move in moves] == [1, 9, 0]


@needs_rs274
def test_a_program_is_in_mm_until_it_says_otherwise_and_its_parameters_in_inches(tmp_path: Path) -> None:
    moves = listed("G10 L2 P1 X25.4\nG0 X[#5221 * 10]\nG20 X1\nM2\n", tmp_path)
    assert [move.end[0] for move in moves] == pytest.approx([35.4, 50.8], abs=3e-3)


@needs_rs274
def test_feeds(tmp_path: Path) -> None:
    """F is taken before a change of units in the same block: F10 with G20 is 10 mm/min after G21."""
    text = "S500 M3 G1 F100 X10\nG93 X20 F3\nG95 F.1 X30\nG94 F50\nG33 X40 K.5\nG33.1 Z-5 K.5\nG20 G1 X0 F10\nM2\n"
    moves = listed(text, tmp_path)
    assert [move.feed for move in moves] == pytest.approx([100.0, 30.0, 0.1, 250.0, 250.0, 10.0])
    assert [move.per_revolution for move in moves] == [False, False, True, False, False, False]
    assert [move.kind for move in moves] == ["feed", "feed", "feed", "feed", "tap", "feed"]
    assert math.isclose(moves[-1].end[2], 0.0)  # after tapping the tool is where it was before


@needs_rs274
def test_subroutine_files_are_found_beside_the_program_and_on_the_search_path(tmp_path: Path) -> None:
    other = tmp_path / "other"
    other.mkdir()
    (tmp_path / "near.ngc").write_text("o<near> sub\nG0 X#1\no<near> endsub\n")
    (other / "far.ngc").write_text("o<far> sub\nG0 Y#1\no<far> endsub\n")
    program = tmp_path / "program.ngc"
    program.write_text("o<near> call [3]\no<far> call [4]\nM2\n")
    assert "far" in run(program).error
    listing = run(program, search_path=other)
    assert ends(moves_of(listing.calls)) == [(3.0, 0.0, 0.0), (3.0, 4.0, 0.0)]


@needs_rs274
@pytest.mark.parametrize(("text", "open_end"), [("G0 X1\n", True), ("G1 X1\nM2\n", False)])
def test_refusals_are_told_from_an_open_end(text: str, open_end: bool, tmp_path: Path) -> None:
    (tmp_path / "program.ngc").write_text(text)
    listing = run(tmp_path / "program.ngc")
    assert listing.error
    assert listing.open_end == open_end
