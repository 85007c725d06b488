"""Subprograms of FANUC: calls, counts, nesting, returns, and where programs are found."""

from __future__ import annotations

from pathlib import Path

import pytest

from gcode.errors import GcodeError
from gcode.events import LinearMotion, Notice, ProgramStop
from gcode.flow.interpreter import interpret_file

STEP = "O1000\nG91 X1.\nG90\nM99"


@pytest.mark.parametrize(
    ("call", "count"),
    [
        ("M98 P1000", 1),
        ("M98 P1000 L4", 4),
        ("M98 L4 P1000", 4),
        ("M98 P31000", 3),
        ("M98 P011000", 1),
        ("M98 P00121000", 12),
        ("M98 P1000 L0", 0),
    ],
)
def test_how_often_a_subprogram_is_run(call: str, count: int, ends) -> None:
    """FANUC 30i user's manual, "Subprogram": M98 Pnnnnpppp, the last four digits name the program and those before
    count; M98 P51002 runs O1002 five times; or P names it and L counts; once where no count is given."""
    assert ends(f"O1\n{call}\nM30\n{STEP}") == [(n + 1, 0, 0) for n in range(count)]


def test_a_program_number_of_five_digits_is_given_beside_l(ends) -> None:
    assert ends("O1\nM98 P12345 L2\nM30\nO12345\nG91 X1.\nG90\nM99") == [(1, 0, 0), (2, 0, 0)]


def test_a_call_beside_a_motion_comes_after_it(ends) -> None:
    """The same: M98 P can stand in the block of a move command, which is made first."""
    assert ends(f"O1\nG0 X10. M98 P1000\nX50.\nM30\n{STEP}") == [(10, 0, 0), (11, 0, 0), (50, 0, 0)]


def test_subprograms_call_subprograms(ends) -> None:
    """The same: calls are nested, ten levels deep on newer controls."""
    programs = "".join(f"O{n}\nG0 X{n}.\nM98 P{n + 1}\nY{n}.\nM99\n" for n in range(2, 12))
    text = f"O1\nM98 P2\nM30\n{programs}O12\nM99\n"
    visited = [(x, 0.0) for x in range(2, 12)] + [(11, float(y)) for y in range(11, 1, -1)]
    assert [(x, y) for x, y, _ in ends(text)] == visited


def test_modes_of_a_subprogram_hold_on_after_it(ends) -> None:
    assert ends("O1\nG90 X1.\nM98 P2\nX1.\nM30\nO2\nG91\nM99") == [(1, 0, 0), (2, 0, 0)]


def test_m99_p_returns_to_a_block_of_the_caller(ends) -> None:
    """The same, special usage: M99 Pn returns to sequence number n of the calling program."""
    text = "O1\nN10 G0 X1.\nN20 M98 P2\nN30 X3.\nN40 X4.\nM30\nO2\nY1.\nM99 P40"
    assert ends(text) == [(1, 0, 0), (1, 1, 0), (4, 1, 0)]


def test_m99_p_ends_the_repeats(ends) -> None:
    assert ends("O1\nM98 P2 L9\nX9.\nN40 X4.\nM30\nO2\nG91 Y1.\nG90\nM99 P40") == [(0, 1, 0), (4, 1, 0)]


def test_m99_p_in_the_main_program_is_a_jump(ends) -> None:
    """The same, M99 in the main program: M99 Pn goes to sequence number n, /M99 P lets a switch decide."""
    assert ends("O1\nX1.\nM99 P60\nX2.\nN60 X3.\nM30") == [(1, 0, 0), (3, 0, 0)]
    assert ends("O1\nX1.\n/M99 P60\nX2.\nN60 X3.\nM30", block_delete=True) == [(1, 0, 0), (2, 0, 0), (3, 0, 0)]


def test_m99_in_the_main_program_ends_one_round(run) -> None:
    """The same: control returns to the start of the main program, again and again; one pass is run here."""
    events = run("O1\nG0 X1.\nM99\nX2.")
    assert [e.end_mm[0] for e in events if isinstance(e, LinearMotion)] == [1]
    assert [n.code for n in events if isinstance(n, Notice)] == ["round"]
    assert isinstance(events[-1], ProgramStop)


def test_the_main_program_ends_before_those_behind_it(ends) -> None:
    assert ends(f"O1\nX5.\nM30\n{STEP}") == [(5, 0, 0)]
    assert ends(f"%\nO1\nM98 P1000\nM30\n{STEP}\n%") == [(1, 0, 0)]


def test_a_program_that_is_not_there(refusal) -> None:
    """FANUC alarm PS0078: sequence number (program) not found."""
    error = refusal("O1\nM98 P77\nM30")
    assert (error.code, error.place.line) == ("unknown-program", 2)
    assert refusal("O1\nM98\nM30").code == "missing-word"


def test_a_subprogram_without_m99(refusal) -> None:
    assert refusal("O1\nM98 P2\nM30\nO2\nG0 X1.").code == "missing-return"


def test_a_program_that_calls_itself_for_ever(refusal) -> None:
    """FANUC alarm PS0077: too many levels of subprograms."""
    assert refusal("O1\nM98 P2\nM30\nO2\nM98 P2\nM99").code == "nesting"


@pytest.mark.parametrize("name", ["O1000", "O1000.nc", "o1000.NC", "1000.txt"])
def test_a_file_of_the_search_path(name: str, ends, tmp_path: Path) -> None:
    (tmp_path / name).write_text(f"%\n{STEP}\n%\n")
    assert ends("O1\nM98 P21000\nM30", search_path=(tmp_path,)) == [(1, 0, 0), (2, 0, 0)]


def test_a_file_with_four_digits(ends, tmp_path: Path) -> None:
    (tmp_path / "O0007.nc").write_text("O0007\nG0 X7.\nM99\n")
    assert ends("O1\nM98 P7\nM30", search_path=(tmp_path,)) == [(7, 0, 0)]
    assert ends("O1\nG65 P0007\nM30", search_path=(tmp_path,)) == [(7, 0, 0)]


def test_a_file_beside_the_program_comes_before_the_search_path(tmp_path: Path) -> None:
    far = tmp_path / "far"
    far.mkdir()
    (far / "O0002").write_text("O2\nG0 X2.\nM99\n")
    (tmp_path / "O0002").write_text("O2\nG0 X1.\nM99\n")
    main = tmp_path / "main.nc"
    main.write_text("O1\nM98 P2\nM30\n")
    told = [e for e in interpret_file(main) if isinstance(e, LinearMotion)]
    assert [(e.end_mm[0], e.place.file, e.place.line) for e in told] == [(1, str(tmp_path / "O0002"), 2)]
    assert [str(call) for call in told[0].place.calls] == [f"O2 called at {main}:2"]


def test_a_program_in_the_file_comes_before_files(ends, tmp_path: Path) -> None:
    (tmp_path / "O1000").write_text("O1000\nG0 X99.\nM99\n")
    assert ends(f"O1\nM98 P1000\nM30\n{STEP}", search_path=(tmp_path,)) == [(1, 0, 0)]


def test_a_mistake_in_a_file_is_told_at_its_place_there(tmp_path: Path) -> None:
    (tmp_path / "O0002").write_text("O2\nG0 X1.\nG777\nM99\n")
    main = tmp_path / "main.nc"
    main.write_text("O1\nM98 P2\nM30\n")
    with pytest.raises(GcodeError) as caught:
        list(interpret_file(main))
    assert (caught.value.place.file, caught.value.place.line) == (str(tmp_path / "O0002"), 3)


def test_m198_calls_from_external_memory(ends, tmp_path: Path) -> None:
    """FANUC 30i user's manual, "External subprogram call": M198 Pn, a program in an input/output device."""
    (tmp_path / "O1000").write_text(f"{STEP}\n")
    assert ends("O1\nM198 P1000\nM30", search_path=(tmp_path,)) == [(1, 0, 0)]


def test_names_in_brackets_and_colons_number_programs(ends) -> None:
    assert ends(":1 (MAIN)\nM98 P2\nM30\n:0002\nG0 X1.\nM99") == [(1, 0, 0)]
