"""The words of a cycle: allowed words, required words, and those kept from earlier blocks."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType

from gcode.cycles.errors import CycleError
from gcode.cycles.interface import CycleInput
from gcode.cycles.rules import Cycle, CycleRules

#: Key of the bottom's coordinate, which is a Z, Y or X word by the plane.
BOTTOM = "bottom"
#: Suffix of the key of a level: 1 where it was given with G91.
INCREMENTAL = ".incremental"
_CODE = "code"
_LENGTHS = frozenset({"R", BOTTOM, "Q", "I", "J", "K"})
_OWN = "IJKLPQ"


@dataclass(frozen=True, slots=True, kw_only=True)
class CycleWords:
    """The words that hold for a block: its own and those given before.

    Attributes:
        data: numbers by key; lengths in mm.
        sticky: what to keep for the next block.
        repeats: how often the cycle is run.
    """

    data: Mapping[str, float]
    sticky: Mapping[str, float]
    repeats: int


def has_axis(call: CycleInput) -> bool:
    """True where the block has a word of one of the plane's axes."""
    return any(axis in call.words for axis in call.axes)


def read_words(rules: CycleRules, cycle: Cycle, call: CycleInput) -> CycleWords:
    """Checks the block's words and adds those that earlier blocks gave.

    Raises:
        CycleError: for a word that the cycle does not take, or a repeat that is none.
    """
    repeats = _repeats(rules, cycle, call)
    _check_letters(rules, cycle, call)
    given = _given(rules, call)
    kept = _kept(rules, call)
    usable = kept if _remembers(rules, call) else {key: kept[key] for key in cycle.inherits if key in kept}
    dropped = "IJK" if "Q" in given and "I" not in given else "Q" if "I" in given and "Q" not in given else ""
    unit = call.unit_mm if rules.sticky_in_program_unit else 1.0
    stored = {key: value / unit if key in _LENGTHS else value for key, value in given.items()}
    before = {} if rules.memory == "mode" and call.first_of_mode else call.sticky
    return CycleWords(
        data=_over(usable, dropped, given),
        sticky=_over(before, dropped, {**stored, _CODE: float(call.code[1:])}),
        repeats=repeats,
    )


def _over(before: Mapping[str, float], dropped: str, new: Mapping[str, float]) -> Mapping[str, float]:
    """New numbers over those from before; a peck or shift by Q replaces one by I, J, K, and vice versa."""
    return MappingProxyType({**{key: value for key, value in before.items() if key not in tuple(dropped)}, **new})


def check_needed(rules: CycleRules, cycle: Cycle, call: CycleInput, data: Mapping[str, float]) -> None:
    """Refuses a hole for which a word is missing.

    Raises:
        CycleError: ``cycle-missing-word``.
    """
    needed = [(BOTTOM, call.axes[2]), *([("R", "R")] if rules.needs_r else []), *((key, key) for key in cycle.needs)]
    for key, letter in needed:
        if key not in data:
            raise _missing(rules, cycle, letter, letter)
    for wanted, letters in ((cycle.pecks, "QI"), (cycle.shift, "QIJK")):
        if wanted and not any(letter in data for letter in letters):
            raise _missing(rules, cycle, "Q", " or ".join(letter for letter in letters if letter in cycle.takes))


def _missing(rules: CycleRules, cycle: Cycle, letter: str, wanted: str) -> CycleError:
    where = "in this block" if rules.memory == "code" else "in this block or an earlier one since the last G80"
    return CycleError(
        "cycle-missing-word",
        f"{cycle.code} ({cycle.meaning}) has no {letter}",
        f"{wanted} {where}",
        letter,
    )


def _given(rules: CycleRules, call: CycleInput) -> dict[str, float]:
    """This block's words by key. A repeat count is not included: it holds for its block alone."""
    given = {letter: call.words[letter] for letter in _OWN if letter in call.words}
    for letter in rules.repeat_letters:
        given.pop(letter, None)
    for key, letter in ((BOTTOM, call.axes[2]), ("R", "R")):
        if letter in call.words:
            given[key] = call.words[letter]
            given[key + INCREMENTAL] = 0.0 if call.absolute else 1.0
    if "P" in given:
        given["P"] = _seconds(rules, call)
    return given


def _kept(rules: CycleRules, call: CycleInput) -> dict[str, float]:
    unit = call.unit_mm if rules.sticky_in_program_unit else 1.0
    return {key: value * unit if key in _LENGTHS else value for key, value in call.sticky.items()}


def _remembers(rules: CycleRules, call: CycleInput) -> bool:
    """True where the words of earlier blocks hold for this one."""
    if call.first_of_mode:
        return False
    return rules.memory == "mode" or call.sticky.get(_CODE) == float(call.code[1:])


def _seconds(rules: CycleRules, call: CycleInput) -> float:
    """The dwell time of P."""
    number, unit = call.words["P"], rules.dwell
    if number < 0.0 or not math.isfinite(number) or (unit.whole and number != int(number)):
        wanted = "a whole number of milliseconds" if unit.whole else "a time of 0 or more"
        raise CycleError("cycle-dwell", f"P{number:g} is not a dwell time", wanted, "P")
    pointed = unit.pointed_seconds is not None and "P" in call.pointed
    return number * (unit.pointed_seconds if pointed and unit.pointed_seconds is not None else unit.seconds)


def _repeats(rules: CycleRules, cycle: Cycle, call: CycleInput) -> int:
    letters = [letter for letter in rules.repeat_letters if letter in call.words]
    if not letters:
        return 1
    letter, number = letters[0], call.words[letters[0]]
    if not cycle.repeats:
        raise CycleError("cycle-word", f"{cycle.code} takes no {letter}", f"no {letter}", letter)
    if len(letters) > 1:
        raise CycleError("cycle-repeat", "K and L are both in the block", "one of them", letters[1])
    least = 0 if rules.stores_zero_repeats else 1
    if not math.isfinite(number) or number != int(number) or number < least:
        raise CycleError(
            "cycle-repeat", f"{letter}{number:g} is not a repeat count", f"a whole number of {least} or more", letter
        )
    return int(number)


def _check_letters(rules: CycleRules, cycle: Cycle, call: CycleInput) -> None:
    for letter in _OWN:
        if letter not in call.words or letter in rules.repeat_letters:
            continue
        if letter in cycle.unsupported:
            problem = f"{letter} in {cycle.code} is {cycle.unsupported[letter]}, which is not supported"
            raise CycleError("cycle-unsupported", problem, f"{cycle.code} without {letter}", letter)
        if letter not in cycle.takes and letter not in rules.stored:
            problem = f"{cycle.code} ({cycle.meaning}) takes no {letter}"
            raise CycleError("cycle-word", problem, f"no {letter} in a block of {cycle.code}", letter)
