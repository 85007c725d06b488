"""The page docs/gcode.md: what it says is what the tables say, and nothing is left out."""

from __future__ import annotations

import ast
import dataclasses
import importlib
import re
from collections.abc import Iterator
from pathlib import Path
from types import ModuleType

import pytest

from gcode.dialects import DIALECTS, Dialect
from gcode.dialects.macro_language import FANUC_MACRO, LINUXCNC_MACRO
from gcode.dialects.sources import NO_SOURCE, SOURCES

ROOT = Path(__file__).parents[2]
DOCS = ROOT / "docs"
#: Arguments of a call, counted from 0, that may be the code of an error, by the name of what is called.
CODE_ARGUMENTS = {
    "GcodeError": (1,),
    "WriteError": (2,),
    "EvaluationError": (0,),
    "CycleError": (0,),
    "error": (1,),
    "error_at": (1, 2),
    "_error": (1,),
    "number_at": (3,),
}
CODE = re.compile(r"[a-z][a-z0-9]*(-[a-z0-9]+)*")


@pytest.fixture
def docs(monkeypatch: pytest.MonkeyPatch) -> dict[str, ModuleType]:
    monkeypatch.syspath_prepend(str(ROOT / "tools"))
    names = ("gcode_tables", "gcode_diagnostics", "gcode_variables", "gcode_language", "gcode_words", "gcode_markdown")
    return {name: importlib.import_module(name) for name in names}


def cells(section: str, page: str) -> list[list[str]]:
    """The cells of a generated table, without its head."""
    begin = page.index(f"<!-- generated: {section} -->")
    part = page[begin : page.index("<!-- end -->", begin)]
    rows = [re.split(r"(?<!\\)\|", line)[1:-1] for line in part.splitlines() if line.startswith("|")]
    return [[cell.strip() for cell in row] for row in rows[2:]]


def page_text() -> str:
    return (DOCS / "gcode.md").read_text(encoding="utf-8")


def calls(name: str | None = None) -> Iterator[tuple[str, ast.Call]]:
    """Calls in the sources of the interpreter, by the last part of what is called."""
    for path in sorted((ROOT / "gcode").rglob("*.py")):
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            if isinstance(node, ast.Call):
                called = node.func
                last = called.attr if isinstance(called, ast.Attribute) else getattr(called, "id", "")
                if name in (None, last):
                    yield last, node


def constants(node: ast.expr) -> set[str]:
    """Texts that look like a code, of a constant or of a choice between two."""
    parts = [node.body, node.orelse] if isinstance(node, ast.IfExp) else [node]
    texts = {part.value for part in parts if isinstance(part, ast.Constant) and isinstance(part.value, str)}
    return {text for text in texts if CODE.fullmatch(text)}


def test_the_page_is_up_to_date(docs: dict[str, ModuleType]) -> None:
    page = page_text()
    assert docs["gcode_tables"].updated(page) == page, "python tools/gcode_tables.py rewrites the page"


def test_check_says_whether_the_page_is_out_of_date(
    docs: dict[str, ModuleType], tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    copy = tmp_path / "gcode.md"
    copy.write_text(page_text().replace("| rapid positioning |", "| slow positioning |"), encoding="utf-8")
    monkeypatch.setattr(docs["gcode_tables"], "PAGE", copy)
    assert docs["gcode_tables"].main(["--check"]) == 1
    assert "gcode.md is out of date" in capsys.readouterr().err
    assert docs["gcode_tables"].main([]) == 0
    assert docs["gcode_tables"].main(["--check"]) == 0
    assert "slow positioning" not in copy.read_text(encoding="utf-8")


def test_a_part_that_is_missing_or_given_twice_is_refused(docs: dict[str, ModuleType]) -> None:
    part = "<!-- generated: limits -->\n<!-- end -->\n"
    for page in (page_text().replace("generated: limits", "limits"), page_text() + part):
        with pytest.raises(ValueError, match="generated parts"):
            docs["gcode_tables"].updated(page)


@pytest.mark.parametrize("name", DIALECTS)
def test_every_code_of_a_dialect_has_its_status(name: str, docs: dict[str, ModuleType]) -> None:
    column = 2 + list(DIALECTS).index(name)
    page = page_text()
    found = {row[0]: row[column] for section in ("g-codes", "m-codes") for row in cells(section, page)}
    status = docs["gcode_tables"].STATUS
    assert {code: text for code, text in found.items() if text != "–"} == {
        code: status[rule.status] for code, rule in DIALECTS[name].codes.items()
    }


def test_every_letter_that_anything_takes_is_on_the_page(docs: dict[str, ModuleType]) -> None:
    shown = {letter for letter, _ in docs["gcode_words"].LETTERS}
    taken = {letter for d in DIALECTS.values() for rule in d.codes.values() for letter in rule.letters} - {"*"}
    free = {letter for d in DIALECTS.values() for letter in (*d.free_letters, *d.corner_letters, *d.refused_letters)}
    assert taken | free <= shown


@pytest.mark.parametrize("name", ["fanuc", "haas", "linuxcnc"])
def test_every_variable_that_can_be_read_or_set_is_on_the_page(name: str, docs: dict[str, ModuleType]) -> None:
    variables = docs["gcode_variables"]
    access = variables.access_of(DIALECTS[name], range(variables.NUMBERS_END))
    there = {number for number, one in access.items() if one != variables.NO_ACCESS}
    assert there == {number for row in variables.rows_of(DIALECTS[name]) for number in row.numbers}


def test_every_function_and_operator_is_on_the_page(docs: dict[str, ModuleType]) -> None:
    shown = {name for name, _, _ in docs["gcode_language"].EXAMPLES} | {"+", "-", "*", "/"}
    for language in (FANUC_MACRO, LINUXCNC_MACRO):
        assert {*language.operators, *language.functions, *language.pairs, *language.refused} <= shown


def test_the_error_codes_are_those_of_the_sources(docs: dict[str, ModuleType]) -> None:
    used = {
        code
        for called, call in calls()
        for position in CODE_ARGUMENTS.get(called, ())
        if position < len(call.args)
        for code in constants(call.args[position])
    }
    assert used == set(docs["gcode_diagnostics"].ERRORS)


def test_the_notice_codes_are_those_of_the_sources(docs: dict[str, ModuleType]) -> None:
    keywords = (word.value for _, call in calls("Notice") for word in call.keywords if word.arg == "code")
    assert {code for value in keywords for code in constants(value)} == set(docs["gcode_diagnostics"].NOTICES)


@pytest.mark.parametrize("name", ["README.md", "docs/gcode.md"])
def test_links_lead_to_files_and_headings(name: str) -> None:
    text = (ROOT / name).read_text(encoding="utf-8")
    for target, heading in re.findall(r"\]\((?!https?:)([^)#]*)(#[^)]*)?\)", text):
        assert ((ROOT / name).parent / target).exists(), target
        headings = re.findall(r"^#+ (.*)$", text, re.MULTILINE)
        anchors = {"#" + re.sub(r"[^\w\- ]", "", h).strip().lower().replace(" ", "-") for h in headings}
        assert target or heading in anchors, heading


def test_haas_has_no_data_entry_that_only_g11_ends() -> None:
    assert "G11" not in DIALECTS["haas"].codes
    assert "ignored" not in DIALECTS["haas"].data_kinds.values()


def test_every_rule_of_a_dialect_has_a_source_or_says_that_it_has_none(docs: dict[str, ModuleType]) -> None:
    rules = {field.name for field in dataclasses.fields(Dialect)} - {*docs["gcode_tables"].ELSEWHERE}
    assert set(SOURCES) == set(DIALECTS)
    for name, sources in SOURCES.items():
        assert set(sources) <= rules, name
        assert all(text.strip() for text in sources.values())
    page = page_text()
    for name in DIALECTS:
        assert len(cells(f"{name}-rules", page)) == len(rules)


def test_rules_without_a_source_are_not_those_of_open_controls(docs: dict[str, ModuleType]) -> None:
    for name in ("linuxcnc", "grbl"):
        without = [row[0] for row in cells(f"{name}-rules", page_text()) if row[2] == NO_SOURCE]
        assert len(without) <= 5, without
