"""The tables of docs/gcode.md, made from the tables that the interpreter runs on.

python tools/gcode_tables.py            # rewrites the parts of docs/gcode.md between the markers
python tools/gcode_tables.py --check    # reports whether the page is out of date: exit code 1
"""

from __future__ import annotations

import argparse
import re
import sys
import textwrap
from collections.abc import Callable, Iterable, Mapping
from pathlib import Path

from gcode_diagnostics import ERRORS, NOTICES
from gcode_language import field_table, functions, limits, named_parameters, operators, settings_table, source_table
from gcode_markdown import code, table
from gcode_variables import described
from gcode_words import LETTERS, PHASES, WORD_PHASES, letter_status

from gcode.cycles import CycleRules
from gcode.cycles.rules import Act, Cycle
from gcode.dialects import DIALECTS, Dialect
from gcode.dialects.codes import CodeRule, Status
from gcode.dialects.sources import NO_SOURCE, SOURCES
from gcode.language.foreign import RULES
from gcode.phases.g10 import _TAKES as DATA_WORDS

PAGE = Path(__file__).parents[1] / "docs/gcode.md"
_PART = re.compile(r"(<!-- generated: ([a-z-]+) -->\n).*?(<!-- end -->)", re.DOTALL)
_NAMES = tuple(DIALECTS)
#: Names of a code's status on the page.
STATUS: Mapping[Status, str] = {
    Status.EXECUTED: "run",
    Status.NEUTRAL: "always",
    Status.NOTICE: "no motion",
    Status.REFUSED: "refused",
}
NOT_THERE = "–"

#: Steps of a cycle.
ACTS: Mapping[Act, str] = {
    Act.FEED_BOTTOM: "feed to Z",
    Act.FEED_R: "feed to R",
    Act.FEED_CLEAR: "feed to the return level",
    Act.FEED_TOP: "feed up to the top of the bore",
    Act.RAPID_R: "rapid to R",
    Act.RAPID_BOTTOM: "rapid to Z",
    Act.RAPID_CLEAR: "rapid to the return level",
    Act.PECK: "pecks to Z, each with a retraction to R",
    Act.CHIP_BREAK: "pecks to Z, each with a short retraction",
    Act.SHIFT: "shift off the axis",
    Act.UNSHIFT: "shift back to the axis",
    Act.DWELL: "dwell",
    Act.STOP: "spindle stop",
    Act.RESTART: "spindle on again",
    Act.ORIENT: "spindle orientation",
    Act.OPERATOR: "stop for the operator",
    Act.TAP_START: "spindle on if tapping is rigid",
    Act.TAP_REVERSE: "spindle reversed",
    Act.TAP_END: "spindle forward again, or stopped if tapping is rigid",
    Act.TAP_BOTTOM: "tap to Z",
    Act.TAP_R: "tap out to R",
    Act.TAP_CLEAR: "tap out to the return level",
}
#: Data that G10 writes.
DATA: Mapping[str, str] = {
    "zero": "work offset P",
    "zero-here": "work offset P, set so that the present tool position gets the given coordinates",
    "additional": "additional work offset P",
    "length": "length geometry of tool offset P",
    "length-wear": "length wear of tool offset P",
    "radius": "radius geometry of tool offset P",
    "radius-wear": "radius wear of tool offset P",
    "ignored": "data entry up to G11, reported by notices and not executed",
    "tool": "tool table entry P",
    "tool-here": "tool table entry P, set so that the present tool position gets the given coordinates",
    "tool-at-fixture": "the same, with coordinates of G59.3 and without G92",
}


def _rank(name: str) -> tuple[str, float, str]:
    return name[0], float(name[1:]), name


def _codes(letter: str) -> str:
    names = {name for dialect in DIALECTS.values() for name in dialect.codes if name[0] == letter}
    rows = (_code_row(name) for name in sorted(names, key=_rank))
    return table(("code", "meaning", *_NAMES, "group", "words"), rows)


def _code_row(name: str) -> tuple[str, ...]:
    rules = {dialect.name: dialect.codes[name] for dialect in DIALECTS.values() if name in dialect.codes}
    status = (STATUS[rules[dialect].status] if dialect in rules else NOT_THERE for dialect in _NAMES)
    words = {dialect: _words(rule) for dialect, rule in rules.items() if rule.status is not Status.REFUSED}
    groups = {dialect: ", ".join(rule.groups) for dialect, rule in rules.items()}
    meanings = {dialect: rule.meaning for dialect, rule in rules.items()}
    return (name, _by_dialect(meanings), *status, _by_dialect(groups), _by_dialect(words))


def _words(rule: CodeRule) -> str:
    return " ".join(rule.letters) if rule.letters != "*" else "arguments"


def _by_dialect(texts: Mapping[str, str]) -> str:
    """One text where all dialects agree, else each with the names of its dialects."""
    different = list(dict.fromkeys(texts.values()))
    if len(different) < 2:
        return "".join(different)
    shown = ((text or "none", ", ".join(name for name in texts if texts[name] == text)) for text in different)
    return "; ".join(f"{text} ({names})" for text, names in shown)


def _letters() -> str:
    rows = ((code(letter), meaning, *map(letter_status(letter), DIALECTS.values())) for letter, meaning in LETTERS)
    return table(("letter", "meaning", *_NAMES), rows)


def _phases() -> str:
    orders = [_order(dialect) for dialect in DIALECTS.values()]
    phases = dict.fromkeys(phase for order in orders for phase in order)
    rows = ((PHASES[phase], *(_position(order, phase) for order in orders)) for phase in phases)
    return table(("step", *_NAMES), rows)


def _order(dialect: Dialect) -> tuple[str, ...]:
    """The steps that a dialect uses."""
    used = {rule.phase for rule in dialect.codes.values()} | WORD_PHASES
    return tuple(phase for phase in dialect.order if phase in used)


def _position(order: tuple[str, ...], phase: str) -> str:
    return str(order.index(phase) + 1) if phase in order else NOT_THERE


def _cycle_rules() -> dict[str, CycleRules]:
    return {dialect.name: dialect.cycles for dialect in DIALECTS.values() if dialect.cycles is not None}


def _cycles() -> str:
    rules = _cycle_rules()
    names = sorted({name for one in rules.values() for name in one.cycles}, key=_rank)
    rows = (row for name in names for row in _cycle_rows(name, rules))
    return table(("code", "dialects", "meaning", "own words", "required", "steps at the hole"), rows)


def _cycle_rows(name: str, rules: Mapping[str, CycleRules]) -> list[tuple[str, ...]]:
    """A row for each variant of a cycle among the dialects."""
    texts = {dialect: _cycle_row(one.cycles[name]) for dialect, one in rules.items() if name in one.cycles}
    return [(name, ", ".join(d for d in texts if texts[d] == text), *text) for text in dict.fromkeys(texts.values())]


def _cycle_row(cycle: Cycle) -> tuple[str, ...]:
    steps = ", ".join(ACTS[act] for act in cycle.acts)
    steps = f"rapid to R, {steps}" if cycle.approach else steps
    return cycle.meaning, " ".join(cycle.takes), " ".join(cycle.needs), steps


def _cycle_fields() -> str:
    return field_table(
        CycleRules, _cycle_rules(), without=("name", "cycles", "peck_tolerance_mm", "above_r_mm", "tap_order")
    )


def _data() -> str:
    kinds = sorted({kind for dialect in DIALECTS.values() for kind in dialect.data_kinds})
    rows = ((f"L{kind}", *(_kind(dialect, kind) for dialect in DIALECTS.values())) for kind in kinds)
    return table(("", *_NAMES), rows)


def _kind(dialect: Dialect, kind: int) -> str:
    name = dialect.data_kinds.get(kind)
    if name is None:
        return NOT_THERE
    shown = DATA["additional" if name == "zero-here" and dialect.additional_by_l20 else name]
    taken = [letter for letter in DATA_WORDS.get(name, "") if letter in dialect.codes["G10"].letters]
    if "R" in taken and name.startswith("zero") and not (dialect.shift_is_rotated and name == "zero"):
        taken.remove("R")
    return f"{shown}: {' '.join(taken)}" if taken else shown


def _variables(name: str) -> Callable[[], str]:
    def section() -> str:
        rows = ((row.text, row.meaning, access.read, access.write) for row, access in described(DIALECTS[name]))
        return table(("variable", "meaning", "read", "set"), rows)

    return section


#: Fields of `Dialect` that other parts of the page show.
ELSEWHERE = ("name", "codes", "order", "macro", "cycles", "data_kinds", "refused_letters", "free_letters")


def _dialect_fields() -> str:
    return field_table(Dialect, DIALECTS, without=ELSEWHERE)


def _rules(name: str) -> Callable[[], str]:
    """Rule, value and source of every field of a dialect."""
    return lambda: source_table(DIALECTS[name], SOURCES[name], NO_SOURCE, without=ELSEWHERE)


def _meanings(meanings: Mapping[str, str]) -> Callable[[], str]:
    return lambda: table(("code", "meaning"), ((code(name), text) for name, text in sorted(meanings.items())))


def _controls() -> str:
    return textwrap.fill(", ".join(dict.fromkeys(rule.control for rule in RULES)) + ".", 130) + "\n"


#: Text of every generated part of the page, by the name in its marker.
SECTIONS: Mapping[str, Callable[[], str]] = {
    "g-codes": lambda: _codes("G"),
    "m-codes": lambda: _codes("M"),
    "letters": _letters,
    "phases": _phases,
    "cycles": _cycles,
    "cycle-rules": _cycle_fields,
    "data": _data,
    "operators": operators,
    "functions": functions,
    "fanuc-variables": _variables("fanuc"),
    "haas-variables": _variables("haas"),
    "linuxcnc-variables": _variables("linuxcnc"),
    "named-parameters": named_parameters,
    "dialects": _dialect_fields,
    **{f"{name}-rules": _rules(name) for name in _NAMES},
    "settings": settings_table,
    "errors": _meanings(ERRORS),
    "notices": _meanings(NOTICES),
    "foreign": _controls,
    "limits": limits,
}


def updated(page: str) -> str:
    """The page with its generated parts up to date.

    Raises:
        ValueError: where the markers are not those of `SECTIONS`, each once.
    """
    found = [match[2] for match in _PART.finditer(page)]
    if sorted(found) != sorted(SECTIONS):
        raise ValueError(f"the page has the generated parts {', '.join(found)}; expected {', '.join(SECTIONS)}")
    return _PART.sub(lambda match: f"{match[1]}{SECTIONS[match[2]]()}{match[3]}", page)


def main(arguments: Iterable[str] | None = None) -> int:
    """Rewrites or checks the page; returns the exit code."""
    parser = argparse.ArgumentParser(description="Rewrites the generated tables of docs/gcode.md.")
    parser.add_argument("--check", action="store_true", help="change nothing; exit with 1 if the page is out of date")
    options = parser.parse_args(None if arguments is None else list(arguments))
    page = PAGE.read_text(encoding="utf-8")
    new = updated(page)
    if options.check and new != page:
        print(f"{PAGE.name} is out of date; python tools/gcode_tables.py rewrites it", file=sys.stderr)
        return 1
    if not options.check:
        PAGE.write_text(new, encoding="utf-8")
    return 0


if __name__ == "__main__":
    sys.exit(main())
