"""Whatever is fed to the interpreter: events or one clear error, in bounded time; never a traceback, never silence."""

from __future__ import annotations

import gzip
import io
import json
import os
import random
import tracemalloc
import zipfile
from pathlib import Path

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from support.fuzz_gcode import MUTATIONS, SEEDS, SETTINGS, Mutation, assert_laws, mutated, own_dialect, time_bound

from gcode.cli import run as command
from gcode.dialects import DIALECTS, dialect_named
from gcode.errors import GcodeError
from gcode.events import Block
from gcode.flow.interpreter import check, interpret, interpret_file
from gcode.language.program import read_program
from gcode.settings import Limits, MachineSettings

NAMES = st.sampled_from(sorted(SEEDS))
DIALECT = st.sampled_from(sorted(DIALECTS))
RANDOMS = st.randoms(use_true_random=False)
LAWS = settings(max_examples=150, deadline=None, suppress_health_check=list(HealthCheck))


@pytest.mark.parametrize("name", sorted(SEEDS))
def test_the_seeds_run(name: str) -> None:
    met = assert_laws(SEEDS[name], dialect_named(own_dialect(name)))
    assert met.error is None
    assert sum(isinstance(event, Block) for event in met.events) > 20


@given(NAMES, RANDOMS)
@LAWS
def test_mutated_programs_in_their_own_dialect(name: str, source: random.Random) -> None:
    assert_laws(mutated(source, SEEDS[name], most=3), dialect_named(own_dialect(name)))


@given(NAMES, DIALECT, RANDOMS)
@LAWS
def test_mutated_programs_in_any_dialect(name: str, dialect: str, source: random.Random) -> None:
    assert_laws(mutated(source, SEEDS[name], most=12), dialect_named(dialect))


@pytest.mark.parametrize("mutation", sorted(set(MUTATIONS), key=lambda m: m.__name__), ids=lambda m: m.__name__)
@given(NAMES, RANDOMS)
@settings(parent=LAWS, max_examples=30)
def test_every_mutation_alone(mutation: Mutation, name: str, source: random.Random) -> None:
    assert_laws(mutation(source, SEEDS[name]), dialect_named(own_dialect(name)))


@given(st.text(max_size=300), DIALECT)
@LAWS
def test_any_text(text: str, dialect: str) -> None:
    assert_laws(text, dialect_named(dialect))


@given(st.binary(max_size=300), DIALECT)
@settings(parent=LAWS, max_examples=100)
def test_any_bytes(data: bytes, dialect: str) -> None:
    errors = check(data, dialect=dialect_named(dialect), settings=SETTINGS)
    assert all(error.underlined() for error in errors)


def zipped() -> bytes:
    buffer = io.BytesIO()
    with zipfile.ZipFile(buffer, "w") as archive:
        archive.writestr("part.nc", SEEDS["fanuc_plate.nc"])
    return buffer.getvalue()


#: Contents of a file, and the code of its first error, None where it runs.
ODD_FILES: dict[str, tuple[bytes, str | None]] = {
    "empty": (b"", None),
    "blanks": (b" \t \n\n   \n", None),
    "wide-blanks": (b" " * 4000 + b"\nM30\n", None),
    "too-wide-blanks": (b" " * 40_000 + b"\nM30\n", "line-too-long"),
    "png": (b"\x89PNG\r\n\x1a\n\x00\x00\x00\rIHDR" + bytes(range(256)), "unexpected-character"),
    "elf": (b"\x7fELF\x02\x01\x01" + b"\x00" * 9 + b"\x03\x00>\x00", "control-character"),
    "zip": (zipped(), "foreign-control"),
    "gzip": (gzip.compress(SEEDS["fanuc_plate.nc"].encode(), mtime=0), "control-character"),
    "nul": (b"G0 X1\x00\nM30\n", "control-character"),
    "all-nul": (b"\x00" * 5000, "line-too-long"),
    "lone-cr": (b"G0 X1\rG0 X2\rM30\r", "control-character"),
    "crlf": (SEEDS["fanuc_plate.nc"].replace("\n", "\r\n").encode(), None),
    "bom": (b"\xef\xbb\xbf" + SEEDS["fanuc_plate.nc"].encode(), None),
    "utf-16": ("G0 X1\nM30\n".encode("utf-16"), "foreign-control"),
    "utf-16-be": (b"\xfe\xff" + "G0 X1\nM30\n".encode("utf-16-be"), "foreign-control"),
    "latin-1": ("G0 X1 (Fräser Ø12)\nM30\n".encode("latin-1"), None),
    "no-line-end": (b"G0 X1\nM30", None),
    "ctrl-z": (b"G0 X1\nX2\n\x1a", None),
    "many-empty-lines": (b"\n" * 20_000, None),
    "comment": (b"(" + b"x" * 4000 + b")\nM30\n", None),
    "long-comment": (b"(" + b"x" * 100_000 + b")\nM30\n", "line-too-long"),
    "brackets": (b"#1=" + b"[" * 1500 + b"1" + b"]" * 1500 + b"\nM30\n", "nesting"),
    "many-brackets": (b"#1=" + b"[" * 10_000 + b"1" + b"]" * 10_000 + b"\nM30\n", "line-too-long"),
    "signs": (b"#1=" + b"-" * 4000 + b"1\nM30\n", "nesting"),
    "operators": (b"#1=1" + b"+1" * 2000 + b"\nG0 X#1\nM30\n", None),
    "digits": (b"G0 X" + b"1" * 4000 + b"\nM30\n", "number-too-large"),
    "zeros": (b"G0 X" + b"0" * 4000 + b"1\nM30\n", None),
    "points": (b"G0 X" + b"1" * 2000 + b".." + b"\nM30\n", "bad-number"),
    "many-digits": (b"G0 X" + b"1" * 10_000 + b"\nM30\n", "line-too-long"),
    "numbers": (b"X12345 " * 500 + b"!\nM30\n", "unexpected-character"),
    "label-of-many-digits": (b"GOTO 5\nN" + b"1" * 10_000 + b"\nM30\n", "unknown-label"),
    "program-of-many-digits": (b"M98 P5\nO" + b"1" * 10_000 + b"\nM30\n", "unknown-program"),
    "label-of-zeros": (b"GOTO 5\nN" + b"0" * 300_000 + b".\nM30\n", "unknown-label"),
    "name-of-no-file": (b"M98 P[" + b"9" * 300 + b"]\nM30\n", "unknown-program"),
    "surrogate": ("G0 X1 \udc80\nM30".encode("utf-8", "surrogatepass"), "unexpected-character"),
}


@pytest.fixture(params=sorted(ODD_FILES))
def odd(request: pytest.FixtureRequest, tmp_path: Path) -> tuple[Path, str | None]:
    content, code = ODD_FILES[request.param]
    path = tmp_path / f"{request.param}.nc"
    path.write_bytes(content)
    return path, code


def first_code(path: Path, dialect: str = "fanuc", **limits: int) -> str | None:
    """Code of the error that ends a file, None where it runs to its end; `check` says the same."""
    machine = MachineSettings(tools=SETTINGS.tools, limits=Limits(**{"blocks": 1_100_000, **limits}))
    errors = check(read_program(path), dialect=dialect_named(dialect), settings=machine)
    try:
        for _ in interpret_file(path, dialect=dialect_named(dialect), settings=machine):
            pass
    except GcodeError as error:
        assert str(error) == str(errors[0])
        return error.code
    assert errors == []
    return None


def test_odd_files(odd: tuple[Path, str | None]) -> None:
    path, code = odd
    with time_bound(10.0):
        assert first_code(path) == code


def test_odd_files_on_the_command_line(odd: tuple[Path, str | None], capsys: pytest.CaptureFixture[str]) -> None:
    path, code = odd
    tools = path.with_name("tools.tbl")
    tools.write_text("T1 P1 Z50 D10\nT2 P2 Z60 D6.8\nT3 P3 Z70 D8\n")
    expected = 0 if code is None else 1
    assert command(["check", str(path), "--tool-table", str(tools)]) == expected
    printed = capsys.readouterr()
    assert (code is None) == (": no errors" in printed.out)
    assert code is None or f"[{code}]" in printed.out
    assert command(["motions", str(path), "--tool-table", str(tools)]) == expected
    printed = capsys.readouterr()
    assert all(json.loads(line) for line in printed.out.splitlines())
    assert printed.err == "" if code is None else f"[{code}]" in printed.err
    assert "Traceback" not in printed.out + printed.err


@pytest.mark.parametrize("dialect", ["linuxcnc", "grbl"])
def test_odd_files_in_other_languages(odd: tuple[Path, str | None], dialect: str) -> None:
    """The codes may be others; that there is one, and that `check` agrees, may not."""
    with time_bound(10.0):
        first_code(odd[0], dialect)


@pytest.mark.parametrize(("name", "reason"), [("none.nc", "no such file"), ("folder", "is a directory")])
def test_a_path_without_a_file(name: str, reason: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "folder").mkdir()
    path = tmp_path / name
    for read in (read_program, interpret_file):
        with pytest.raises(GcodeError, match=reason) as caught:
            read(path)
        assert caught.value.code == "unreadable-file"
    assert command(["check", str(path)]) == 1
    assert command(["motions", str(path)]) == 1
    printed = capsys.readouterr()
    assert printed.out == ""
    assert name in printed.err
    assert "Traceback" not in printed.err


@pytest.mark.skipif(os.geteuid() == 0, reason="nothing is closed to root")
def test_a_file_without_permission(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / "closed.nc"
    path.write_text("M30\n")
    path.chmod(0)
    with pytest.raises(GcodeError, match="Permission denied") as caught:
        read_program(path)
    assert caught.value.code == "unreadable-file"
    assert command(["check", str(path)]) == 1
    assert "Traceback" not in capsys.readouterr().err


def test_a_hundred_megabytes_in_one_line(tmp_path: Path) -> None:
    """The text is held once and the line is never decoded."""
    path = tmp_path / "long.nc"
    with path.open("wb") as file:
        for _ in range(100):
            file.write(b"G1X1.5Y2" * (1 << 17))
    size = path.stat().st_size
    tracemalloc.start()
    try:
        with time_bound(30.0):
            errors = check(read_program(path))
        _, peak = tracemalloc.get_traced_memory()
    finally:
        tracemalloc.stop()
    assert [error.code for error in errors] == ["line-too-long"]
    assert len(errors[0].place.text) < 200
    assert peak < size + 20e6


def test_a_million_empty_lines() -> None:
    machine = MachineSettings(limits=Limits(blocks=1_000_000))
    with time_bound(60.0):
        (last,) = interpret(b"\n" * 1_000_000, settings=machine)
    assert last.place.line == 1_000_000


#: Programs that would never end, or as good as never: dialect, text, and what ends them, None where they do.
ENDLESS: dict[str, tuple[str, str, str | None]] = {
    "M98-itself": ("fanuc", "O1\nM98 P1\nM99", "nesting"),
    "M98-main": ("fanuc", "O1\nM98 P2\nM30\nO2\nM98 P2\nM99", "nesting"),
    "M97-itself": ("haas", "N5 M97 P5\nM30", "nesting"),
    "G65-itself": ("fanuc", "G65 P5\nM30\nO5\nG65 P5\nM99", "nesting"),
    "G66-itself": ("fanuc", "G66 P5\nG0 X1\nM30\nO5\nG0 X2\nM99", None),
    "o-call-itself": ("linuxcnc", "o<a> sub\no<a> call\no<a> endsub\no<a> call\nM2", "nesting"),
    "while": ("fanuc", "WHILE[1 EQ 1]DO1\nG91 G0 X1\nEND1\nM30", "runaway"),
    "do": ("fanuc", "DO1\nEND1\nM30", "runaway"),
    "goto-itself": ("fanuc", "N1 GOTO 1", "runaway"),
    "goto-back": ("haas", "N1 G91 G0 X1\nGOTO 1", "runaway"),
    "M99-main": ("fanuc", "O1\nG0 X1\nM99", None),
    "M99-back": ("fanuc", "N1 G0 X1\nM99 P1", "runaway"),
    "M99-to-caller": ("fanuc", "N1 M98 P2\nM30\nO2\nM99 P1", "runaway"),
    "M98-often": ("fanuc", "M98 P2 L9999999\nM30\nO2\nM99", "runaway"),
    "G65-often": ("fanuc", "G65 P2 L9999999\nM30\nO2\nG4 P1\nM99", "runaway"),
    "o-while": ("linuxcnc", "o1 while [1]\no1 endwhile\nM2", "runaway"),
    "o-do": ("linuxcnc", "o1 do\nG4 P1\no1 while [1]\nM2", "runaway"),
    "o-repeat": ("linuxcnc", "o1 repeat [1000000000]\no1 endrepeat\nM2", "runaway"),
    "o-repeat-huge": ("linuxcnc", f"o1 repeat [{'9' * 300}]\no1 endrepeat\nM2", "runaway"),
    "cycle-often": ("fanuc", "G91 G81 X1 Z-1 R-1 K99999999 F100\nM30", "cycle-repeat"),
    "many-pecks": ("fanuc", "G83 X1 Z-999999 R1 Q.001 F100\nM30", "cycle-peck"),
    "many-turns": ("linuxcnc", "G0 X0 Y0\nG2 X0 Y0 I1 P99999999 F100\nM2", "bad-value"),
}


@pytest.mark.parametrize("name", sorted(ENDLESS))
def test_programs_that_would_not_end(name: str) -> None:
    dialect, text, code = ENDLESS[name]
    with time_bound(20.0):
        met = assert_laws(text, dialect_named(dialect))
    assert (met.error.code if met.error else None) == code


def test_many_loops_without_an_end() -> None:
    """What pairs the loops takes time in proportion to them."""
    text = "DO1\n" * 50_000 + "M30"
    with time_bound(20.0):
        (error, *_) = check(text, settings=SETTINGS)
    assert error.code == "bad-loop"


@pytest.mark.parametrize(
    ("dialect", "text", "code", "column"),
    [
        ("linuxcnc", "o<²> call", "unknown-program", 1),
        ("linuxcnc", f"#1=[{'9' * 300}*{'9' * 300} MOD 2]", "bad-operation", 607),
        ("fanuc", "/²G0X1", "unexpected-character", 2),
        ("fanuc", "G0 ſ1000", "unexpected-character", 4),
        ("linuxcnc", "#<ßß>=1 ?", "unexpected-character", 9),
        ("fanuc", "G65 P1.5", "bad-value", 5),
        ("fanuc", "G65 P1 L-1", "bad-value", 8),
    ],
)
def test_what_is_no_number_is_no_number(dialect: str, text: str, code: str, column: int) -> None:
    error = assert_laws(text, dialect_named(dialect)).error
    assert error is not None
    assert (error.code, error.place.column) == (code, column)


def test_a_block_with_too_many_errors_is_given_up() -> None:
    """`check` does not look for what is left of a block word by word for ever."""
    text = f"{'G1 ' * 1300}\nG0 X1\n" * 10 + "M30"
    with time_bound(20.0):
        errors = check(text, dialect="haas")
    assert [(error.code, error.place.line) for error in errors] == [("group-conflict", n) for n in range(1, 20, 2)]


def test_a_name_that_no_file_can_have(tmp_path: Path) -> None:
    for dialect, line in (("linuxcnc", f"o<{'a' * 4000}> call"), ("fanuc", f"M98 P[{'9' * 300}]")):
        path = tmp_path / f"{dialect}.nc"
        path.write_text(f"{line}\nM2\n")
        assert first_code(path, dialect) == "unknown-program"


def test_where_a_text_without_an_end_ends() -> None:
    """The place is the last line, also behind lines that are run together."""
    *_, last = interpret("G0 X1\n" + "X2 Y3\n" * 20)
    assert (last.place.line, last.place.text) == (21, "X2 Y3")
    with pytest.raises(GcodeError) as caught:
        list(interpret("M98 P2\nM30\nO2\nG0 X1\n" + "X2 Y3\n" * 20, dialect=dialect_named("haas")))
    assert (caught.value.code, caught.value.place.line) == ("missing-return", 24)
