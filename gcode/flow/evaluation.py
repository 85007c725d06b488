"""Computed numbers of a block: its words evaluated, its assignments made."""

from __future__ import annotations

from gcode.flow.session import Session
from gcode.language.blocks import Assignment, ParsedBlock
from gcode.phases.decimal_point import in_increments

#: Macro calls, whose arguments are not rounded.
MACRO_CALLS = frozenset({65.0, 66.0, 66.1})


def evaluated(session: Session, block: ParsedBlock) -> ParsedBlock:
    """The block with plain numbers for words; its assignments are made."""
    words = block
    if not block.plain and block.words:
        call = any(word.letter == "G" and word.value in MACRO_CALLS for word in block.words)
        words = block.evaluated(session.variables.scope(), exact=call)
    if block.assignments:
        assign(session, block, block.assignments)
    return in_increments(session.state, words)


def assign(session: Session, block: ParsedBlock, assignments: tuple[Assignment, ...]) -> None:
    """Makes assignments: all values are computed before the first is stored."""
    scope = session.variables.scope()
    values = [block.value_of(assignment.value, scope) for assignment in assignments]
    for assignment, value in zip(assignments, values, strict=True):
        block.guarded(session.variables.assign, assignment.target, value, scope)
