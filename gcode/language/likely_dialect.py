"""The dialect that a program is most likely written in: the one whose language its lines fit best.

Each line is read in each dialect, without being executed: text that the dialect's parser refuses, and codes and letters
that it does not have, speak against it. Each is counted once, so that a long program proves no more than a short one.
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from functools import lru_cache
from pathlib import PurePath
from typing import NamedTuple

from gcode.dialects import DIALECTS, Dialect
from gcode.errors import GcodeError, Place
from gcode.language.block_parser import parse_blocks
from gcode.language.blocks import OWord, ParsedBlock
from gcode.language.program import Program

#: Lines that are read.
MOST_LINES = 400
#: Weight of text, G codes and letters that a dialect does not have; of M codes, which may be the machine builder's.
_FOREIGN, _BUILDER = 2, 1
#: Weight by which one dialect must fit better than another one to be preferred.
PROOF = 2
#: Dialects that files of a suffix are written in.
_SUFFIXES: Mapping[str, tuple[str, ...]] = {".ngc": ("linuxcnc", "grbl"), ".nc": (), ".gc": ("grbl",)}
#: Names of a control in comments: its own, and those of controls that were made from it.
_NAMES: Mapping[str, str] = {name: name for name in DIALECTS} | {"linuxcnc": "linuxcnc|emc2|pathpilot|mach[234]"}
#: M codes that call subprograms, which no machine builder takes for anything else.
_CALLS = frozenset(
    float(rule.code[1:])
    for dialect in DIALECTS.values()
    for rule in dialect.codes.values()
    if rule.phase == "call" and rule.code[0] == "M"
)
#: Letters that some block of a dialect may have, also those of axes that only some machines have.
_LETTERS: Mapping[str, frozenset[str]] = {
    name: frozenset(letter for rule in dialect.codes.values() for letter in rule.letters)
    | {*dialect.free_letters, *dialect.corner_letters, *dialect.extra_axes, *dialect.still_axes}
    for name, dialect in DIALECTS.items()
}


class Fault(NamedTuple):
    """Text that a dialect does not have.

    Attributes:
        line: its line, counted from 1.
        text: the text.
        weight: how much it proves.
    """

    line: int
    text: str
    weight: int


class Likely(NamedTuple):
    """A dialect that a program fits.

    Attributes:
        dialect: the dialect.
        reason: why, in words.
    """

    dialect: Dialect
    reason: str


def likeliest(program: Program) -> Likely:
    """The dialect that a program fits best; of several, the one that its name or its comments speak for."""
    faults = _faults(program)
    best = _best(faults)
    name, why = _usual(program, best)
    others = [one for one in faults if one not in best]
    if others:
        nearest = min(others, key=lambda one: _weight(faults[one]))
        fault = faults[nearest][0]
        why = f"{nearest} does not have {fault.text!r} in line {fault.line}" + (f", and {why}" if len(best) > 1 else "")
    return Likely(DIALECTS[name], why)


def better(program: Program, dialect: Dialect) -> Likely | None:
    """The dialect that a program fits much better than the given one, None for none."""
    faults = _faults(program)
    if dialect.name not in faults:
        return None
    own = faults[dialect.name]
    if dialect.name in _best(faults):
        return None
    name, _ = _usual(program, _best(faults))
    rest = _weight(faults[name])
    if 2 * rest > _weight(own):
        return None
    fault = max(own, key=lambda one: one.weight)
    return Likely(DIALECTS[name], f"{dialect.name} does not have {fault.text!r} in line {fault.line}")


def by_suffix(program: Program, dialect: Dialect) -> Likely | None:
    """The dialect that files of the program's suffix are written in, None where it is the given one or is not known."""
    suffix = PurePath(program.file).suffix.lower()
    usual = _SUFFIXES.get(suffix, ())
    if suffix != ".ngc" or dialect.name in usual or dialect.name not in DIALECTS:
        return None
    return Likely(DIALECTS[usual[0]], f"its name ends in {suffix}")


def _best(faults: Mapping[str, tuple[Fault, ...]]) -> list[str]:
    least = min(_weight(found) for found in faults.values())
    return [name for name, found in faults.items() if _weight(found) < least + PROOF]


def _usual(program: Program, names: list[str]) -> tuple[str, str]:
    """One of several dialects that a program fits, and why that one."""
    suffix = PurePath(program.file).suffix.lower()
    for name in _SUFFIXES.get(suffix, ()):
        if name in names:
            return name, f"its name ends in {suffix}"
    for name in names:
        named = re.search(rf"[(;][^\n]*(?<![^\W_])({_NAMES[name]})(?![^\W_])", program.head, re.IGNORECASE)
        if named is not None:
            return name, f"a comment names {named[1]}"
    return names[0], f"nothing in it contradicts {names[0]}"


def _weight(found: tuple[Fault, ...]) -> int:
    return sum(fault.weight for fault in found)


def _faults(program: Program) -> dict[str, tuple[Fault, ...]]:
    lines: dict[str, int] = {}
    offset = 0
    for number in range(1, MOST_LINES + 1):
        if offset >= program.size:
            break
        text, offset = program.line_at(offset)
        lines.setdefault(text, number)
    return {name: tuple(_faults_in(lines, name)) for name in DIALECTS}


def _faults_in(lines: Mapping[str, int], dialect: str) -> list[Fault]:
    """Faults of lines, each given with its number where it stands first."""
    found: dict[str, Fault] = {}
    for line, number in lines.items():
        for text, weight in _faults_of(line, dialect):
            found.setdefault(text, Fault(number, text, weight))
    return list(found.values())


@lru_cache(maxsize=2048)
def _faults_of(line: str, name: str) -> tuple[tuple[str, int], ...]:
    """Text of a line that a dialect does not have, and its weight; kept, for programs repeat their lines."""
    dialect = DIALECTS[name]
    if line.lstrip().startswith("$") and dialect.dollar_commands:
        return ()
    try:
        blocks = parse_blocks(Place(file="", line=1, text=line), dialect)
    except GcodeError as error:
        start = max(error.place.column - 1, 0)
        return ((line[start:].strip()[:24] or line.strip()[:24], _FOREIGN),)
    return tuple(found for block in blocks for found in _foreign_words(block, dialect))


def _foreign_words(block: ParsedBlock, dialect: Dialect) -> list[tuple[str, int]]:
    if isinstance(block.statement, OWord):
        return []
    found = []
    macro_call = any(word.letter == "G" and word.value in (65.0, 66.0, 66.1) for word in block.words)
    for word in block.words:
        if word.expression is not None:
            continue
        if word.letter in "GM":
            if f"{word.letter}{word.value + 0.0:.12g}" not in dialect.codes:
                builders = word.letter == "M" and word.value not in _CALLS
                found.append((word.text, _BUILDER if builders else _FOREIGN))
        elif word.letter in dialect.senders_text:
            found.append((word.text, _BUILDER))
        elif not macro_call and word.letter not in _LETTERS[dialect.name]:
            found.append((word.text, _FOREIGN))
    return found
