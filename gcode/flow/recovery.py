"""How `check` goes on after a refused block, so that one mistake is not told again in every block that follows.

The refused words are left out, what remains of the block sets its modes, and the tool is taken to stand where the
block would have led it. Nothing of this is ever executed: `interpret` ends at the first refusal.
"""

from __future__ import annotations

from dataclasses import replace

from gcode.control.command import Command, resolve
from gcode.control.state import State
from gcode.errors import GcodeError
from gcode.flow.step import PHASES
from gcode.language.blocks import ParsedBlock
from gcode.phases.end_points import moved_to, programmed_end, settled

#: Feed that is taken to hold once a missing one has been reported, mm/min.
_ASSUMED_FEED = 1.0
#: Words that are left out of a block; one with more mistakes tells nothing.
_MOST_LEFT_OUT = 50


def recovered(state: State, block: ParsedBlock, error: GcodeError) -> State:
    """The state to go on from after `error` refused `block`; `state` is that before the block."""
    if error.code == "missing-feed":
        state = state.with_modes(feed=_ASSUMED_FEED)
    command = _without_refused_words(state, block)
    if command is None:
        return state
    for phase in command.phases:
        try:
            if phase == "motion":
                state = moved_to(settled(state, command), programmed_end(state, command))
            else:
                state, _ = PHASES[phase](state, command)
        except GcodeError:
            continue
    return state


def _without_refused_words(state: State, block: ParsedBlock) -> Command | None:
    """The block's command once the words that stand in its way are left out, None where that does not help."""
    words = block.words
    for _ in range(_MOST_LEFT_OUT):
        try:
            return resolve(state, replace(block, words=words))
        except GcodeError as error:
            left = tuple(word for word in words if word.column != error.place.column)
            if len(left) == len(words):
                return None
            words = left
    return None
