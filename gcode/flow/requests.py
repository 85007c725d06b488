"""Requests of a block to the course of the program (M97 to M99, G67, M70 to M73), and arguments of macro calls."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass

from gcode.control.command import Command
from gcode.control.state import State
from gcode.language.blocks import ParsedBlock, Word
from gcode.phases.modes import Action, Result, whole_number

#: Variable of each argument word, list I of the manual (G65).
_ARGUMENTS: Mapping[str, int] = {
    "A": 1,
    "B": 2,
    "C": 3,
    "D": 7,
    "E": 8,
    "F": 9,
    "H": 11,
    "I": 4,
    "J": 5,
    "K": 6,
    "M": 13,
    "Q": 17,
    "R": 18,
    "S": 19,
    "T": 20,
    "U": 21,
    "V": 22,
    "W": 23,
    "X": 24,
    "Y": 25,
    "Z": 26,
}
#: Groups of I, J, K in list II.
_MOST_GROUPS = 10
#: Packed calls have up to four digits of the program and up to four of the count.
_PACK = 10_000


@dataclass(frozen=True, slots=True, kw_only=True)
class CallRequest:
    """M97, M98, M99 or G67 of a block, to be carried out after the block's motion.

    Attributes:
        code: the code.
        word: the word of the code.
        number: program (M98), label (M97) or return label (M99); None without one.
        count: how often.
        label: label at which the program starts (M98 Q), None for its beginning.
    """

    code: str
    word: Word
    number: int | None = None
    count: int = 1
    label: int | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class StateRequest:
    """M70 to M73: save or restore modes."""

    code: str
    word: Word


def request_call(state: State, command: Command) -> Result:
    """M97, M98, M99, M198, G67: makes the request."""
    use = command.of_phase("call")[0]
    block, words = command.block, command.words
    number = whole_number(block, words["P"]) if "P" in words else None
    count = (
        whole_number(block, words["L"]) if "L" in words else whole_number(block, words["K"]) if "K" in words else None
    )
    code = "M98" if use.rule.code == "M198" else use.rule.code
    if code in ("M97", "M98") and number is None and "Q" not in words and block.name is None:
        raise block.error(use.word, "missing-word", f"{use.word.text} without P", "P and the number of a program")
    if (
        code == "M98"
        and number is not None
        and number >= _PACK
        and state.control.dialect.packed_calls
        and count is None
    ):
        count, number = divmod(number, _PACK)
    label = whole_number(block, words["Q"]) if "Q" in words else None
    count = 1 if count is None else count
    return state, (CallRequest(code=code, word=use.word, number=number, count=count, label=label),)  # type: ignore[return-value]


def request_state(state: State, command: Command) -> Result:
    """M70 to M73: makes the request."""
    use = command.of_phase("state")[0]
    return state, (StateRequest(code=use.rule.code, word=use.word),)  # type: ignore[return-value]


CALL_ACTIONS: Mapping[str, Action] = {"call": request_call, "state": request_state}


def macro_arguments(block: ParsedBlock, words: Iterable[Word]) -> dict[int, float]:
    """Local variables that the words of a macro call set, by lists I and II; the later of two words wins.

    Raises:
        GcodeError: for a word that cannot be an argument.
    """
    arguments: dict[int, float] = {}
    group, last = 0, ""
    for word in words:
        number = _ARGUMENTS.get(word.letter)
        if number is None:
            problem = f"{word.text} is not an argument of a macro call"
            raise block.error(word, "bad-argument", problem, "A to F, H to K, M, Q to Z")
        if word.letter in "IJK":
            group += 1 if last and word.letter <= last else 0
            last = word.letter
            number += 3 * group
            if group >= _MOST_GROUPS:
                raise block.error(word, "bad-argument", f"{word.text} is too many", f"{_MOST_GROUPS} sets of I, J, K")
        arguments[number] = word.value
    return arguments
