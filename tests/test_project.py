"""The house in order: what the pages name exists, what the rules list is complete, and files stay short."""

from __future__ import annotations

import ast
import re
import tomllib
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from support.sources import nodes_of, text_of, tree_of

import twin.jit
from twin.cli.app import whole_app
from twin.job import JobFile

ROOT = Path(__file__).parents[1]
SOURCES = sorted(p for folder in ("gcode", "twin") for p in (ROOT / folder).rglob("*.py"))
PYTHON = SOURCES + sorted(
    p for folder in ("tests", "examples", "benchmarks", "docs", "tools") for p in (ROOT / folder).rglob("*.py")
)
PAGES = sorted((*ROOT.glob("*.md"), *(p for f in ("docs", "benchmarks", "tests") for p in (ROOT / f).rglob("*.md"))))
MOST_LINES = 400
MOST_PARAMETERS = 8

#: A name in backticks: words, perhaps joined by dots.
_QUOTED = re.compile(r"`([^`\n]+)`")
_LINK = re.compile(r"\]\(([^)\s]+)\)")
_FILE = re.compile(r"^(?:gcode|twin|tests|docs|examples|benchmarks|recordings|tools)/[\w./]+$")


def name(path: Path) -> str:
    return path.relative_to(ROOT).as_posix()


def is_kernels(path: Path) -> bool:
    return path.name.endswith("kernels.py")


def module(path: Path) -> str:
    return name(path).removesuffix(".py").removesuffix("/__init__").replace("/", ".")


@pytest.fixture(scope="module")
def settings() -> dict[str, Any]:
    return tomllib.loads((ROOT / "pyproject.toml").read_text())


def contract(settings: dict[str, Any], title: str) -> dict[str, Any]:
    found: list[dict[str, Any]] = settings["tool"]["importlinter"]["contracts"]
    return next(c for c in found if c["name"] == title)


def imported(path: Path) -> Iterator[str]:
    for node in nodes_of(path):
        if isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom) and node.module and not node.level:
            yield node.module


def decorated(function: ast.FunctionDef, *names: str) -> bool:
    return any(isinstance(d, ast.Name) and d.id in names for d in function.decorator_list)


def names_used_from_modules(path: Path) -> set[str]:
    """Full names of what a file imports, and of the attributes of that."""
    imports = {
        alias.asname or alias.name: f"{node.module}.{alias.name}"
        for node in nodes_of(path)
        if isinstance(node, ast.ImportFrom)
        for alias in node.names
    }
    attributes = {
        f"{imports[node.value.id]}.{node.attr}"
        for node in nodes_of(path)
        if isinstance(node, ast.Attribute) and isinstance(node.value, ast.Name) and node.value.id in imports
    }
    return attributes.union(imports.values())


def words_of(path: Path) -> set[str]:
    return set(re.findall(r"[A-Za-z_]\w*", text_of(path)))


def slug(heading: str) -> str:
    """How GitHub names a heading's anchor."""
    kept = re.sub(r"[^\w\s-]", "", heading.strip().lower())
    return re.sub(r"\s", "-", kept)


def test_files_stay_short() -> None:
    # kernels may be longer: their helpers stand next to them
    too_long = {
        name(p): lines for p in PYTHON if not is_kernels(p) and (lines := len(text_of(p).splitlines())) > MOST_LINES
    }
    assert too_long == {}


def test_kernels_have_at_most_eight_parameters() -> None:
    wide = {
        f"{name(path)}:{node.name}"
        for path in SOURCES
        for node in nodes_of(path)
        if isinstance(node, ast.FunctionDef)
        and decorated(node, *twin.jit.__all__)
        and len([*node.args.posonlyargs, *node.args.args, *node.args.kwonlyargs]) > MOST_PARAMETERS
    }
    assert wide == set()


def test_only_kernels_use_helpers_of_kernels() -> None:
    helpers = {
        f"{module(path)}.{node.name}"
        for path in SOURCES
        if is_kernels(path)
        for node in tree_of(path).body
        if isinstance(node, ast.FunctionDef) and decorated(node, "helper", "inlined")
    }
    assert helpers
    others = [path for path in PYTHON if not is_kernels(path) and "kernels" in text_of(path)]
    used = {name(path): sorted(helpers & names_used_from_modules(path)) for path in others}
    assert {file: names for file, names in used.items() if names} == {}


def test_numba_has_one_door() -> None:
    named = [p for p in SOURCES if "numba" in text_of(p)]
    users = [name(p) for p in named if any(m.split(".")[0] == "numba" for m in imported(p))]
    assert users == ["twin/jit/compiled.py", "twin/jit/kept_code.py"]


def test_every_kernels_module_is_under_the_rules_for_kernels(settings: dict[str, Any]) -> None:
    kernels = [module(p) for p in SOURCES if is_kernels(p)]
    rule = contract(settings, "kernels know arrays and numbers only")
    untyped = [o["module"] for o in settings["tool"]["mypy"]["overrides"] if "warn_return_any" in o]
    assert sorted(rule["source_modules"]) == kernels
    assert [sorted(m) for m in untyped] == [kernels]


def test_every_part_of_twin_has_its_layer(settings: dict[str, Any]) -> None:
    layers = contract(settings, "a folder of twin uses only those below it in this list")["layers"]
    listed = {part.strip() for layer in layers for part in layer.split("|")}
    parts = {".".join(module(p).split(".")[:2]) for p in SOURCES if module(p).startswith("twin.")}
    assert listed == parts


def test_names_of_the_nomenclature_are_in_the_code() -> None:
    known = set().union(*(words_of(p) | set(module(p).split(".")) for p in SOURCES))
    page = (ROOT / "docs" / "nomenclature.md").read_text()
    words = {w for quoted in _QUOTED.findall(page) for w in re.findall(r"[A-Za-z_]\w*", quoted)}
    assert len(words) > 30
    assert words - known == set()


@pytest.mark.parametrize("page", PAGES, ids=name)
def test_links_of_pages_lead_somewhere(page: Path) -> None:
    for target in _LINK.findall(page.read_text()):
        if re.match(r"[a-z]+:", target):
            continue
        file, _, anchor = target.partition("#")
        aim = page.parent / file if file else page
        assert aim.exists(), f"{name(page)}: {target}"
        if anchor:
            slugs = {slug(line.lstrip("#")) for line in aim.read_text().splitlines() if line.startswith("#")}
            assert anchor in slugs, f"{name(page)}: {target}"


@pytest.mark.parametrize("page", PAGES, ids=name)
def test_files_named_by_pages_exist(page: Path) -> None:
    named = [q for q in _QUOTED.findall(page.read_text()) if _FILE.match(q) and "/recordings/" not in q]
    assert [n for n in named if not (ROOT / n).exists()] == []


def test_the_job_files_page_has_every_key() -> None:
    page = (ROOT / "docs" / "job-file.md").read_text()
    sections = dict(re.findall(r"^## `\[+(\w+)\]+`\n(.*?)(?=^## |\Z)", page, flags=re.M | re.S))
    schema = JobFile.model_json_schema()
    assert set(sections) == set(schema["properties"])
    for section, text in sections.items():
        entry = schema["properties"][section]
        ref = re.search(r"'\$ref': '#/\$defs/(\w+)'", str(entry))
        assert ref is not None, section
        keys = set(schema["$defs"][ref[1]]["properties"])
        rows = {q for row in re.findall(r"^\| (`[^|]+) \|", text, flags=re.M) for q in _QUOTED.findall(row)}
        assert rows == keys, section


def test_the_command_lines_page_has_every_command_and_option() -> None:
    page = (ROOT / "docs" / "command-line.md").read_text()
    commands = [c.callback.__name__ for c in whole_app().registered_commands if c.callback is not None and not c.hidden]
    assert commands == re.findall(r"^\| `twin (\w+)", page, flags=re.M)
    options = set(re.findall(r'"(--[a-z-]+)"', (ROOT / "twin" / "cli" / "commands" / "runs" / "replay.py").read_text()))
    assert options
    assert {o for o in options if o not in page} == set()


def test_the_citation_has_the_package_s_version_and_licence(settings: dict[str, Any]) -> None:
    citation = dict(re.findall(r"^([a-z-]+): (\S.*)$", (ROOT / "CITATION.cff").read_text(), flags=re.M))
    project = settings["project"]
    assert (citation["version"], citation["license"]) == (project["version"], project["license"])
    assert f"name: {project['authors'][0]['name']}" in (ROOT / "CITATION.cff").read_text()


def test_the_nomenclature_has_each_symbol_and_each_name_once() -> None:
    page = (ROOT / "docs" / "nomenclature.md").read_text()
    rows = [[cell.strip() for cell in row.split("|")] for row in re.findall(r"^\|(.*)\|$", page, flags=re.M)]
    rows = [row for row in rows if len(row) == 4 and row[0] not in ("symbol", "---")]
    symbols = [symbol for row in rows for symbol in row[0].split(", ") if symbol]
    names = [name for row in rows for name in _QUOTED.findall(row[1])]
    assert min(len(symbols), len(names)) > 50
    assert sorted(s for s in set(symbols) if symbols.count(s) > 1) == []
    assert sorted(n for n in set(names) if names.count(n) > 1) == []
