"""Recovery of `check` after a refused block, so that one error is not reported again in every block that follows.

The refused words are omitted, the rest of the block sets its modes, and the tool is assumed to be at the end of the
block. Nothing of this is ever executed: `interpret` ends at the first error.
"""

from __future__ import annotations

from dataclasses import replace

from gcode.control.command import Command, resolve
from gcode.control.state import State
from gcode.errors import GcodeError
from gcode.flow.step import PHASES
from gcode.language.blocks import ParsedBlock
from gcode.phases.end_points import moved_to, programmed_end, settled

#: Feed that is assumed once a missing one has been reported, mm/min.
_ASSUMED_FEED = 1.0
#: Most words that are omitted from a block; one with more errors is skipped.
_MOST_OMITTED = 50


def recovered(state: State, block: ParsedBlock, error: GcodeError) -> State:
    """The state to continue from after `error` refused `block`; `state` is that before the block."""
    if error.code == "runaway":
        return replace(state, ended=True)
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
    """The block's command without its refused words, None where that does not help."""
    words = block.words
    for _ in range(_MOST_OMITTED):
        try:
            return resolve(state, replace(block, words=words))
        except GcodeError as error:
            left = tuple(word for word in words if word.column != error.place.column)
            if len(left) == len(words):
                return None
            words = left
    return None
