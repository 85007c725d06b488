"""Which dialect a program looks like, and what is said about it."""

from __future__ import annotations

from pathlib import Path

import pytest

from gcode.dialects import DIALECTS, dialect_named
from gcode.errors import GcodeError
from gcode.events import Notice
from gcode.flow.interpreter import check, examine, interpret
from gcode.language.likely_dialect import better, likeliest
from gcode.language.program import Program

PROGRAMS = Path(__file__).parent / "programs"

LINES = {
    "linuxcnc": ["#<depth> = 3", "o100 sub\no100 endsub", "G59.1", "G0 X[#1 ** 2]", "G33.1 Z-1 K1", "G92.2"],
    "fanuc": ["G5.1 Q1", "G66.1 P1", "M198 P1", "G10 L50\nG11"],
    "haas": ["G154 P3", "G187 P1", "G103 P1", "M97 P10"],
    "grbl": ["$H", "$32=1\nG0 X1"],
}


def program(text: str, name: str = "t.nc") -> Program:
    return Program(f"G21 G90\n{text}\nG0 X1\nM30\n".encode(), name)


@pytest.mark.parametrize(("name", "text"), [(name, text) for name, texts in LINES.items() for text in texts])
def test_the_language_of_a_program(name: str, text: str) -> None:
    assert likeliest(program(text)).dialect.name == name
    for other in DIALECTS.values():
        found = better(program(text), other)
        assert found is None or found.dialect.name == name


@pytest.mark.parametrize("path", sorted(PROGRAMS.iterdir()), ids=lambda path: path.name)
def test_real_programs_are_recognised_or_fit_several(path: Path) -> None:
    text = Program(path.read_bytes(), str(path))
    named = path.name.partition("_")[0]
    assert better(text, dialect_named(named)) is None
    assert likeliest(text).dialect.name in {named, "fanuc"} if named == "grbl" else named


@pytest.mark.parametrize(
    ("name", "text", "why"),
    [
        ("a.ngc", "G0 X2", "its name ends in .ngc"),
        ("a.nc", "(post: grbl 1.1)", "a comment names grbl"),
        ("a.nc", "(Post Processor: grbl_post)", "a comment names grbl"),
        ("a.nc", "G0 X2", "nothing in it contradicts fanuc"),
        ("a.nc", "O100", "nothing in it contradicts fanuc"),
        ("a.nc", "G43.4 H1", "linuxcnc does not have 'G43.4' in line 2, and nothing in it contradicts fanuc"),
    ],
)
def test_which_and_why(name: str, text: str, why: str) -> None:
    assert likeliest(program(text, name)).reason == why


def test_auto_takes_the_likeliest_and_says_so() -> None:
    first, *_ = interpret(program("#<depth> = 3"), dialect="auto")
    assert isinstance(first, Notice)
    assert (first.code, first.text) == (
        "auto-dialect",
        "the dialect is taken as linuxcnc: fanuc does not have '#<depth> = 3' in line 2",
    )
    assert check(program("#<depth> = 3"), dialect="auto") == []


def test_a_check_in_another_dialect_says_so_in_one_line() -> None:
    errors, notices = examine(program("#<depth> = 3\n#<width> = 4"))
    why = "fanuc does not have '#<depth> = 3' in line 2"
    text = f"the program looks like one for linuxcnc ({why}); expected dialect linuxcnc"
    assert len(errors) == 2
    assert [(notice.code, notice.text) for notice in notices] == [("other-dialect", text)]
    with pytest.raises(GcodeError) as caught:
        list(interpret(program("#<depth> = 3")))
    assert caught.value.underlined().splitlines()[-1] == text


def test_a_file_name_alone_is_a_hint_only_where_the_dialect_does_not_use_it() -> None:
    for dialect, count in (("fanuc", 1), ("haas", 1), ("linuxcnc", 0), ("grbl", 0)):
        _, notices = examine(program("G0 X2", "a.ngc"), dialect=dialect)
        assert len(notices) == count


def test_a_mistake_is_not_another_dialect() -> None:
    assert examine(program("G777 X1\nM123"))[1] == []


def test_a_control_that_was_made_from_linuxcnc_is_named_by_its_comment() -> None:
    text = "(Tormach PathPilot post)\nG21 G90 G64 G50 G91.1\nG30\nT1 G43 H1 M6\nG0 X1.\nM30\n"
    found = likeliest(program(text))
    assert (found.dialect.name, found.reason.rpartition(", and ")[2]) == ("linuxcnc", "a comment names PathPilot")
    assert examine(program(text), dialect="linuxcnc")[0] == []
