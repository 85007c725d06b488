"""The macro languages, settings and limits of the interpreter as tables."""

from __future__ import annotations

import dataclasses
import re
from collections.abc import Iterable, Mapping, Sequence
from typing import Any

from gcode_markdown import code, field_texts, table

from gcode.bulk import plain_runs
from gcode.compensation.fanuc import BLOCKS_READ_OVER
from gcode.control import variables
from gcode.cycles.hole import MOST_STEPS
from gcode.cycles.rules import DwellUnit
from gcode.dialects import ArcTolerance, Dialect, DwellWord
from gcode.dialects.macro_language import FANUC_MACRO, LINUXCNC_MACRO, MacroLanguage
from gcode.flow import owords
from gcode.flow import tape_leader as leader
from gcode.flow.system_variables import _CONSTANTS as CONSTANTS
from gcode.flow.system_variables import _NAMED as NAMED
from gcode.language import block_parser, program
from gcode.language.expressions import MAX_DEPTH, EvaluationError, Source, parse_operand
from gcode.phases import arcs, g10, splines
from gcode.settings import ADDITIONAL_OFFSETS, Limits, MachineSettings, ToolOffset
from gcode.tables.text_file import LARGEST_BYTES

LANGUAGES: Mapping[str, MacroLanguage] = {"fanuc, haas": FANUC_MACRO, "linuxcnc": LINUXCNC_MACRO}

#: Functions and operators, and values of the argument that show what differs.
EXAMPLES: tuple[tuple[str, str, str], ...] = (
    ("SIN", "sine, degrees", "SIN[30]"),
    ("COS", "cosine, degrees", "COS[60]"),
    ("TAN", "tangent, degrees", "TAN[45]"),
    ("ASIN", "arc sine", "ASIN[-0.5]"),
    ("ACOS", "arc cosine", "ACOS[-0.5]"),
    ("ATAN", "arc tangent of a quotient", "ATAN[-1]/[1]"),
    ("ATAN", "arc tangent of one number", "ATAN[1]"),
    ("ATAN", "arc tangent of a quotient, with a comma", "ATAN[-1,1]"),
    ("SQRT", "square root", "SQRT[2]"),
    ("ABS", "absolute value", "ABS[-2]"),
    ("LN", "natural logarithm", "LN[2]"),
    ("EXP", "exponential", "EXP[1]"),
    ("POW", "power", "POW[2,10]"),
    ("**", "power", "[2**10]"),
    ("ROUND", "rounds to the nearest whole number, halves away from 0", "ROUND[-2.5]"),
    ("FIX", "rounds down (FANUC: towards 0)", "FIX[-2.5]"),
    ("FUP", "rounds up (FANUC: away from 0)", "FUP[-2.5]"),
    ("BIN", "from binary-coded decimal", "BIN[16]"),
    ("BCD", "to binary-coded decimal", "BCD[10]"),
    ("EXISTS", "1 if the variable exists, else 0", "EXISTS[#<a>]"),
    ("MOD", "remainder", "[-7 MOD 3]"),
    ("AND", "FANUC: bitwise, LinuxCNC: logical", "[6 AND 3]"),
    ("OR", "the same", "[6 OR 3]"),
    ("XOR", "the same", "[6 XOR 3]"),
    ("EQ", "equal; LinuxCNC within 0.0001", "[1 EQ 1.00001]"),
    ("NE", "not equal", "[1 NE 1.00001]"),
    ("GT", "greater", "[2 GT 1]"),
    ("GE", "greater or equal", "[2 GE 1]"),
    ("LT", "less", "[2 LT 1]"),
    ("LE", "less or equal", "[2 LE 1]"),
    ("ADP", "value read with a decimal point", "ADP[1]"),
    ("PRM", "parameter of the control", "PRM[1]"),
)


class _Nothing:
    """A scope without variables."""

    def number(self, _index: int) -> float | None:
        return None

    def named(self, _name: str) -> float | None:
        return None

    def exists(self, _name: str) -> bool:
        return False

    def has(self, _index: int) -> bool:
        return False

    def steps(self, _letter: str) -> int:
        return 0


def functions() -> str:
    """The functions and word operators, each with its value in each language."""
    rows = (
        (code(name), meaning, code(example), *(_value(example, name, language) for language in LANGUAGES.values()))
        for name, meaning, example in EXAMPLES
    )
    return table(("name", "meaning", "example", *LANGUAGES), rows)


def _value(example: str, name: str, language: MacroLanguage) -> str:
    if name in language.refused:
        return "refused"
    text = example.replace(" ", "").upper()
    try:
        expression, end = parse_operand(Source(text, tuple(range(1, len(text) + 1)), language), 0)
        value = expression.evaluate(_Nothing())
    except EvaluationError:
        return "–"
    return "–" if end < len(text) or value is None else f"{value:.6g}"


def operators() -> str:
    """Operators by priority."""
    rows = []
    for name, language in LANGUAGES.items():
        ranks = sorted({rank for rank, _ in language.operators.values()}, reverse=True)
        tiers = (" ".join(o for o in language.operators if language.operators[o][0] == rank) for rank in ranks)
        rows.append((name, ", then ".join(code(tier) for tier in tiers)))
    return table(("dialect", "highest priority first"), rows)


def named_parameters() -> str:
    """LinuxCNC's named parameters."""
    axes = "xyzabcuvw"
    rows = (
        ("current position, program coordinates", _names(f"_{axis}" for axis in axes)),
        ("gauge point, machine coordinates", _names(f"_abs_{axis}" for axis in axes)),
        ("state of the control", _names(sorted([*NAMED, "_call_level", "_line"]))),
        ("constant", ", ".join(f"{code(f'#<{name}>')} {CONSTANTS[name]:g}" for name in sorted(CONSTANTS))),
    )
    return table(("parameters", "names"), rows)


def _names(names: Iterable[str]) -> str:
    return ", ".join(code(f"#<{name}>") for name in names)


def field_table(kind: type, values: Mapping[str, Any], *, without: Sequence[str] = ()) -> str:
    """The fields of a dataclass with their docstrings, and the value in each of several of its objects.

    Args:
        kind: the dataclass.
        values: objects of it by name.
        without: fields that are shown elsewhere.
    """
    texts = field_texts(kind)
    names = [field.name for field in dataclasses.fields(kind) if field.name not in without]
    rows = (
        (code(name), texts[name], *(_shown_field(name, getattr(one, name)) for one in values.values()))
        for name in names
    )
    return table(("field", "meaning", *values), rows)


def source_table(dialect: Dialect, sources: Mapping[str, str], unknown: str, *, without: Sequence[str]) -> str:
    """Each rule of a dialect with its value and its source.

    Args:
        dialect: the dialect.
        sources: of its fields, by name.
        unknown: the text for a field without one.
        without: fields that are shown elsewhere.
    """
    texts = field_texts(Dialect)
    names = [field.name for field in dataclasses.fields(Dialect) if field.name not in without]
    rows = ((texts[name], _shown_field(name, getattr(dialect, name)), sources.get(name, unknown)) for name in names)
    return table(("rule", "value", "source"), rows)


def _shown_field(name: str, value: Any) -> str:
    if name == "second_variable_names":
        texts = (f"#{first}–#{first + count - 1}: #{same}–#{same + count - 1}" for first, count, same in value)
        return ", ".join(texts) or "none"
    if name == "further_variables":
        return ", ".join(f"#{numbers[0]}–#{numbers[-1]}" for numbers in value) or "none"
    return _ranges(value) if name in ("tool_variables", "counters") else shown(value)


def settings_table() -> str:
    """Fields of `MachineSettings`, `Limits` and `ToolOffset` with their defaults."""
    rows = []
    for kind, prefix in ((MachineSettings, ""), (ToolOffset, "tools.N."), (Limits, "limits.")):
        texts, default = field_texts(kind), kind()
        for field in dataclasses.fields(kind):
            if field.name not in ("tools", "limits"):
                value = getattr(default, field.name)
                rows.append((code(prefix + field.name), texts[field.name], _default(field.name, value)))
    return table(("key", "meaning", "default"), rows)


def _default(name: str, value: Any) -> str:
    return "all 0" if name == "offsets" else shown(value)


def shown(value: Any) -> str:
    """A value as text."""
    if isinstance(value, bool):
        return "yes" if value else "no"
    if value is None or value in ("", ()) or (isinstance(value, Mapping | frozenset) and not value):
        return "none"
    if isinstance(value, ArcTolerance):
        return _tolerance(value)
    if isinstance(value, DwellUnit):
        return _dwell_unit(value)
    if dataclasses.is_dataclass(value):
        return _fields(value)
    if isinstance(value, Mapping):
        return ", ".join(f"{key}: {shown(value[key])}" for key in value)
    if isinstance(value, frozenset):
        return ", ".join(sorted(map(shown, value)))
    if isinstance(value, tuple):
        return ", ".join(map(shown, value))
    return f"{value:.6g}" if isinstance(value, float) else f"{value:,}" if isinstance(value, int) else str(value)


def _tolerance(value: ArcTolerance) -> str:
    text = str(value)
    if value.absolute_inch_mm is not None:
        inch = value.absolute_inch_mm / 25.4
        text += f"; G20: {inch:.6g} inch, or the same share up to {value.most * inch:.6g} inch"
    return text


def _dwell_unit(value: DwellUnit) -> str:
    text = f"{value.seconds:g} s" + (", whole numbers only" if value.whole else "")
    return text if value.pointed_seconds is None else f"{text}, with a decimal point {value.pointed_seconds:g} s"


def _ranges(value: tuple[tuple[int, int, str], ...]) -> str:
    """System variables of the columns of the tool offset table."""
    texts = (f"#{first}–#{first + count - 1}: {code(column)}" for first, count, column in value)
    return ", ".join(texts) or "none"


def _fields(value: Any) -> str:
    if isinstance(value, DwellWord):
        pointed = "refused" if value.pointed is None else f"{value.pointed:g} s"
        plain = f"{value.seconds:g} s"
        return plain if value.pointed == value.seconds else f"{plain}, with a decimal point {pointed}"
    given = ((field.name, getattr(value, field.name)) for field in dataclasses.fields(value))
    return ", ".join(f"{re.sub('_', ' ', name)} {shown(one)}" for name, one in given if one is not None)


def limits() -> str:
    """Largest sizes and depths."""
    given = Limits()
    rows = (
        ("blocks executed", f"{given.blocks:,}", "setting `limits.blocks`"),
        ("blocks executed again and again", f"{given.repeated:,}", "setting `limits.repeated`"),
        ("jumps back (loops)", f"{given.jumps:,}", "setting `limits.jumps`"),
        ("jumps back without a motion between them", f"{given.idle_jumps:,}", "setting `limits.idle_jumps`"),
        ("turns of one arc", f"{arcs.MOST_TURNS:,}", "LinuxCNC"),
        ("call depth", str(given.nesting), "setting `limits.nesting`"),
        ("errors that `check` collects", str(given.errors), "setting `limits.errors`"),
        ("size of a program file", f"{program.MAX_BYTES // 2**20:,} MiB", ""),
        ("size of a table or settings file", f"{LARGEST_BYTES // 2**20} MiB", ""),
        ("length of a line", f"{block_parser.MAX_LINE:,} characters", ""),
        ("magnitude of a number", f"{block_parser.MAX_VALUE:,.0f}", ""),
        ("nested brackets", str(MAX_DEPTH), ""),
        ("steps of one canned cycle block", f"{MOST_STEPS:,}", ""),
        ("additional work offsets", str(ADDITIONAL_OFFSETS), "G54.1 P"),
        ("tool offsets that G10 makes", f"{g10.MOST_TOOL_OFFSETS:,}", ""),
        ("named parameters of one call level", f"{variables._MOST_NAMES:,}", "LinuxCNC"),
        ("arguments of a subroutine", str(owords._ARGUMENTS), "LinuxCNC"),
        ("lines of a leader before the %", str(leader.LEADER_LINES), "FANUC, Haas"),
        ("blocks without motion that cutter compensation reads past", str(BLOCKS_READ_OVER), "FANUC, Haas"),
        ("straight motions per spline", str(splines.CURVE_PIECES), "LinuxCNC"),
        (
            "lines read in one batch",
            f"{plain_runs.MAX_LINES:,}",
            "lines of motions without effect on flow or modes; no visible effect",
        ),
    )
    return table(("quantity", "at most", ""), rows)
