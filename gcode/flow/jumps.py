"""Statements of FANUC's custom macro B: GOTO, IF, WHILE, DO and END."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TypeAlias

from gcode.events import Block, Event, Notice
from gcode.flow.call_stack import Level
from gcode.flow.evaluation import evaluated
from gcode.flow.session import Session
from gcode.language.blocks import End, Goto, IfThen, Output, ParsedBlock, While
from gcode.language.expressions import Expression
from gcode.language.program import Spot

MacroStatement: TypeAlias = Goto | IfThen | While | End | Output

#: Nested loops of FANUC's WHILE: DO1 to DO3.
_LOOP_LABELS = (1, 2, 3)


def execute(session: Session, block: ParsedBlock, statement: MacroStatement) -> Iterator[Event]:
    """Runs a statement of custom macro B."""
    session.start()
    session.level.fresh = False
    yield Block(place=block.place)
    match statement:
        case Goto():
            _goto(session, block, statement)
        case IfThen():
            if _true(session, block, statement.condition):
                _then(session, block, statement)
        case While():
            _while(session, block, statement)
        case End():
            _end(session, block, statement)
        case Output():
            text = f"{statement.keyword} has no effect on the simulated motion"
            yield Notice(place=block.place_at(statement.column), code="no-motion", text=text)


def _then(session: Session, block: ParsedBlock, statement: IfThen) -> None:
    """The statement after THEN: one assignment, and no words."""
    if statement.then.words or len(statement.then.assignments) != 1:
        shown = statement.then.words[0].text if statement.then.words else "nothing"
        raise block.error_at(statement.column, "bad-statement", f"{shown} after THEN", "one assignment, #i = value")
    evaluated(session, statement.then)


def _true(session: Session, block: ParsedBlock, condition: Expression) -> bool:
    return bool(block.value_of(condition, session.variables.scope()))


def _goto(session: Session, block: ParsedBlock, statement: Goto) -> None:
    if statement.condition is not None and not _true(session, block, statement.condition):
        return
    value = block.value_of(statement.target, session.variables.scope())
    jump_to_label(session, block, value, statement.column)


def jump_to_label(session: Session, block: ParsedBlock, value: float | None, column: int) -> None:
    """Continues at the block N`value` of the present program.

    Raises:
        GcodeError: where the number is none, or the program has no such block.
    """
    if value is None or value < 0.0 or value != int(value):
        shown = "vacant" if value is None else f"{value:g}"
        raise block.error_at(column, "bad-label", f"a jump to {shown}", "the number of a block, N")
    level = session.level
    spot = level.program.label(int(value), level.spot.offset - 1)
    if spot is None:
        problem = f"a jump to N{int(value)}, which is not in this program"
        raise block.error_at(column, "unknown-label", problem, "a block that starts with this number")
    if spot.offset < level.spot.offset:
        session.count_jump(block.place)
    level.jump(spot)


def _while(session: Session, block: ParsedBlock, statement: While) -> None:
    level = session.level
    at = session.line_offset
    end = level.program.loops.get(at)
    if statement.label not in _LOOP_LABELS:
        raise block.error_at(statement.column, "bad-loop", f"DO{statement.label}", "DO1, DO2 or DO3")
    if end is None:
        problem = f"DO{statement.label} without END{statement.label}"
        raise block.error_at(statement.column, "bad-loop", problem, f"END{statement.label} in the same program")
    if at not in level.loops:
        _check_nesting(level, block, statement)
    if statement.condition is None or _true(session, block, statement.condition):
        if at not in level.loops:
            level.loops.append(at)
        return
    _, following = level.program.line_at(end.offset)
    level.jump(Spot(following, end.line + 1))
    level.loops = [loop for loop in level.loops if loop != at]


def _check_nesting(level: Level, block: ParsedBlock, statement: While) -> None:
    """Loops inside each other need labels of their own."""
    for loop in level.loops:
        text, _ = level.program.line_at(loop)
        if text.upper().replace(" ", "").endswith(f"DO{statement.label}"):
            problem = f"DO{statement.label} inside a loop DO{statement.label}"
            raise block.error_at(statement.column, "bad-loop", problem, "another of DO1, DO2, DO3")


def _end(session: Session, block: ParsedBlock, statement: End) -> None:
    level = session.level
    ends = level.program.loops
    at = next((loop for loop in reversed(level.loops) if ends[loop].offset == session.line_offset), None)
    if at is None:
        problem = f"END{statement.label} without its DO{statement.label}"
        raise block.error_at(statement.column, "bad-loop", problem, f"DO{statement.label} run before it")
    session.count_jump(block.place)
    level.loops = level.loops[: level.loops.index(at) + 1]
    level.queue.clear()
    level.spot = level.program.spot_of(at)
