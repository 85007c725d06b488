"""Words of a block -> `Command`: codes looked up, modal groups checked, each word assigned to its code."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import lru_cache
from typing import NamedTuple

from gcode.control.state import AXES, State
from gcode.dialects import Dialect
from gcode.dialects.codes import CodeRule, Status
from gcode.errors import Place
from gcode.events import Notice
from gcode.language.blocks import ParsedBlock, Word

#: Phases that a plain word (no G or M) requests.
_PHASE_OF_LETTER: Mapping[str, str] = {"F": "feed", "S": "speed", "T": "tool"}
#: Phases that a word requests only where the dialect allows it in any block.
_PHASE_OF_FREE_LETTER: Mapping[str, str] = {"H": "length", "D": "radius"}
#: Groups whose codes take the axis words of the blocks that follow.
_MOTION_GROUPS = frozenset({"motion", "motion-cancel", "cycle"})
#: Letters that are allowed together with another one: the spindle that an S is for.
_COMPANIONS: Mapping[str, str] = {"S": "$"}
#: Motion codes that hold for their own block only.
_NOT_MODAL = frozenset({"G5", "G5.1"})
#: The rule of the machine builder's codes that the settings declare (`MachineSettings.m_codes`).
_BUILDER = CodeRule(
    code="",
    groups=(),
    status=Status.NOTICE,
    phase="notice",
    letters="EPQ",
    takes_axes=False,
    meaning="the machine builder's, declared in m_codes",
)
#: Codes after whose motions a corner may be cut or rounded.
_CORNERED = frozenset({"G1", "G2", "G3"})

#: Codes that some controls have for those of units (`MachineSettings.g70_units`).
UNIT_CODES: Mapping[str, str] = {"G70": "G20", "G71": "G21"}


class Use(NamedTuple):
    """A code of a block, and the word that wrote it."""

    rule: CodeRule
    word: Word


@dataclass(frozen=True, slots=True)
class Command:
    """One block, ready for execution.

    Attributes:
        block: the block as parsed.
        uses: its codes in their order.
        words: its other words by letter.
        phases: the phases to execute, in the dialect's order.
        notices: what was found that is not executed as written.
    """

    block: ParsedBlock
    uses: tuple[Use, ...]
    words: Mapping[str, Word]
    phases: tuple[str, ...]
    notices: tuple[Notice, ...] = ()

    def of_phase(self, phase: str) -> tuple[Use, ...]:
        """The codes that `phase` executes."""
        return tuple(use for use in self.uses if use.rule.phase == phase)

    def code(self, name: str) -> Use | None:
        """The use of one code, None where the block does not hold it."""
        return next((use for use in self.uses if use.rule.code == name), None)


@lru_cache(maxsize=4096)
def code_name(letter: str, value: float) -> str:
    """Canonical name of a code: ``G1`` for G01, ``G54.1`` for G54.1."""
    return f"{letter}{value + 0.0:.12g}"  # -0 is 0


def resolve(state: State, block: ParsedBlock) -> Command:
    """Looks up and checks the codes and words of a block; nothing is executed.

    Raises:
        GcodeError: for an unknown or refused code or letter, two codes of one modal group where the control refuses
            them, a letter given twice, a word that no code in the block takes, and axis words that two codes take or
            none does.
    """
    dialect = state.control.dialect
    notices: list[Notice] = []
    uses: list[Use] = []
    words: dict[str, Word] = {}
    repeated: tuple[Word, Word] | None = None
    for word in block.words:
        if word.letter in "GM":
            use = Use(_rule(state, block, word), word)
            uses.append(use)
            if use.rule.option:
                notices.append(_option_notice(block, use))
            continue
        if word.letter in words and repeated is None:
            repeated = (words[word.letter], word)
        words[word.letter] = word
    if len(uses) > 1:
        uses = _one_of_each_group(dialect, block, uses, notices)
    if repeated and not any(use.rule.letters == "*" for use in uses):
        first, second = repeated
        problem = f"{second.letter} is given twice: {first.text} and {second.text}"
        raise block.error(second, "repeated-word", problem, f"one {second.letter} per block")
    moves = _claim_words(state, block, uses, words, notices)
    _check_needs(block, uses, words)
    if dialect.senders_text and "O" in words and "O" in dialect.senders_text:
        notices.append(control_text_notice(dialect, block.place_of(words["O"]), words["O"].text))
    return Command(block, tuple(uses), words, _phases(dialect, uses, words, moves), tuple(notices))


def control_text_notice(dialect: Dialect, place: Place, shown: str) -> Notice:
    """The warning about text that the control itself refuses."""
    text = f"{shown} is refused by a {dialect.name} control: the program that sends the lines must take it out"
    return Notice(place=place, code="control-text", text=text)


def _option_notice(block: ParsedBlock, use: Use) -> Notice:
    text = f"{use.word.text} ({use.rule.meaning}) is refused by a control that was built without {use.rule.option}"
    return Notice(place=block.place_of(use.word), code="build-option", text=text)


def _rule(state: State, block: ParsedBlock, word: Word) -> CodeRule:
    """The rule of a code word; refuses what the dialect does not know or does not support."""
    dialect = state.control.dialect
    name = code_name(word.letter, word.value)
    rule = dialect.codes.get(UNIT_CODES.get(name, name) if state.control.settings.g70_units else name)
    if word.letter == "M" and word.value in state.control.settings.m_codes:
        if rule is not None and rule.status in (Status.EXECUTED, Status.NEUTRAL):
            problem = (
                f"{word.text} ({rule.meaning}) is a code of the {dialect.name} dialect, and m_codes has it as well"
            )
            raise block.error(word, "builder-code", problem, "m_codes without it")
        return _BUILDER
    if rule is None:
        problem = f"{word.text} is not a code of the {dialect.name} dialect"
        raise block.error(word, "unknown-code", problem, _declared(word) if word.letter == "M" else "")
    if rule.status is Status.REFUSED:
        problem = f"{word.text} ({rule.meaning}) is not supported"
        raise block.error(word, "unsupported-code", problem, _declared(word) if word.letter == "M" else "")
    return rule


def _declared(word: Word) -> str:
    """How a code of the machine builder's is declared."""
    if word.value < 0.0 or word.value != int(word.value):
        return ""
    number = int(word.value)
    return f'another code, or m_codes = {{ {number} = "none" }} (--m-code {number}) where it moves nothing'


def _one_of_each_group(dialect: Dialect, block: ParsedBlock, uses: list[Use], notices: list[Notice]) -> list[Use]:
    """The codes that count: no two of one modal group."""
    latest: dict[str, Use] = {}
    several: dict[str, Use] = {}
    for use in uses:
        for group in use.rule.groups:
            first = latest.get(group)
            if first is not None:
                several.setdefault(group, first)
                if dialect.same_group == "refused" or (first.word.letter, use.word.letter) != ("G", "G"):
                    problem = _both_in(group, first, use)
                    raise block.error(use.word, "group-conflict", problem, "one code of a group per block")
            latest[group] = use
    for group, first in several.items():
        last = latest[group]
        text = f"{_both_in(group, first, last)}: the last one, {last.word.text}, counts"
        notices.append(Notice(place=block.place_of(last.word), code="last-of-group", text=text))
    return [use for use in uses if all(latest[group] is use for group in use.rule.groups)] if several else uses


def _both_in(group: str, first: Use, second: Use) -> str:
    return f"{first.word.text} and {second.word.text} are both in the modal group {group}"


def _claim_words(
    state: State, block: ParsedBlock, uses: list[Use], words: Mapping[str, Word], notices: list[Notice]
) -> bool:
    """Finds the code that takes each word.

    Returns:
        True where the words left to the active motion code make a motion.
    """
    dialect = state.control.dialect
    claimed = dialect.free_letters + "".join(_COMPANIONS.get(letter, "") for letter in words)
    motion = dialect.codes["G80" if state.modes.motion in _NOT_MODAL else state.modes.motion]
    owner: Use | None = None
    explicit: Use | None = None
    for use in uses:
        if not _MOTION_GROUPS.isdisjoint(use.rule.groups):
            if explicit is None or use.rule.code != "G80":
                motion, explicit = use.rule, use
            continue
        if use.rule.letters == "*":
            return False
        claimed += use.rule.letters
        owner = use if use.rule.takes_axes else owner
    if explicit and explicit.rule.code == "G80" and "cycle" in explicit.rule.groups:
        motion = dialect.codes[state.modes.base_motion]
    if owner and len(uses) > 1 and not dialect.one_shot_with_motion:
        _check_axis_conflict(block, uses)
    rest = [word for letter, word in words.items() if letter not in claimed]
    moves = False
    if owner is None and motion.letters:
        corners = dialect.corner_letters if motion.code in _CORNERED else ()
        left, rest = rest, [w for w in rest if w.letter not in motion.letters and w.letter not in corners]
        moves = len(left) > len(rest) or (explicit is not None and dialect.explicit_code_moves)
    if rest:
        _check_rest(state, block, uses, _without_still_axes(dialect, block, rest, notices))
    return moves


def _check_axis_conflict(block: ParsedBlock, uses: list[Use]) -> None:
    """Refuses two codes that both take the axis words; G80 takes none."""
    takers = [
        use
        for use in uses
        if use.rule.takes_axes or (use.rule.code != "G80" and not _MOTION_GROUPS.isdisjoint(use.rule.groups))
    ]
    if len(takers) > 1:
        problem = f"{takers[0].word.text} and {takers[1].word.text} both take the axis words"
        raise block.error(takers[1].word, "axis-conflict", problem, "one of them in a block")


def _without_still_axes(dialect: Dialect, block: ParsedBlock, rest: list[Word], notices: list[Notice]) -> list[Word]:
    """The words that are left without those of unsupported axes that stay at 0."""
    moving = []
    for word in rest:
        if word.value == 0.0 and word.letter in dialect.still_axes:
            text = f"{word.text}: {dialect.refused_letters[word.letter]}, which stays at 0"
            notices.append(Notice(place=block.place_of(word), code="still-axis", text=text))
        else:
            moving.append(word)
    return moving


def _check_needs(block: ParsedBlock, uses: list[Use], words: Mapping[str, Word]) -> None:
    for rule, word in uses:
        for letter in rule.needs:
            if letter not in words:
                problem = f"{word.text} without {letter}"
                raise block.error(word, "missing-word", problem, f"{' and '.join(rule.needs)} in the same block")


def _check_rest(state: State, block: ParsedBlock, uses: list[Use], rest: list[Word]) -> None:
    """Refuses the first word that no code takes."""
    if not rest:
        return
    word, dialect = rest[0], state.control.dialect
    if word.letter in dialect.refused_letters:
        problem = f"{word.text}: {dialect.refused_letters[word.letter]}, which is not supported"
        expected = f"{word.letter}0, where the axis stays at 0" if word.letter in dialect.still_axes else ""
        raise block.error(word, "unsupported-word", problem, expected)
    if word.letter in AXES + dialect.extra_axes and not any(use.rule.takes_axes for use in uses):
        problem = f"{word.text} without a motion code that takes it"
        raise block.error(word, "axis-without-motion", problem, "G0, G1, G2 or G3")
    raise block.error(
        word, "unused-word", f"{word.text} is not used by any code in this block or by the active motion code"
    )


def _phases(dialect: Dialect, uses: list[Use], words: Mapping[str, Word], moves: bool) -> tuple[str, ...]:
    """The phases of the block, in the dialect's order."""
    asked = {_PHASE_OF_LETTER[letter] for letter in words if letter in _PHASE_OF_LETTER}
    asked.update(use.rule.phase for use in uses)
    for letter, phase in _PHASE_OF_FREE_LETTER.items():
        if letter in words and (letter in dialect.free_letters or phase in asked):
            asked.add(phase)
    if moves:
        asked.add("motion")
    if len(asked) == 1:
        return tuple(asked - {""})
    return tuple(phase for phase in dialect.order if phase in asked)
