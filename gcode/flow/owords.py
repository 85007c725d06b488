"""LinuxCNC's O-words: sub, call, return, if, while, do, repeat, break and continue; and M70 to M73."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping

from gcode.errors import GcodeError
from gcode.events import Block, Event
from gcode.flow.call_stack import Level, SavedModes
from gcode.flow.requests import StateRequest
from gcode.flow.session import Session
from gcode.language.blocks import OKeyword, OWord, ParsedBlock
from gcode.language.expressions import Expression
from gcode.language.program import OLine, Spot, canonical_label

_LOOP_ENDS = ("endwhile", "while")
#: Variables #1 to #30 are a subroutine's own.
_ARGUMENTS = 30


def execute(session: Session, block: ParsedBlock, word: OWord) -> Iterator[Event]:
    """Runs one line with an O-word."""
    session.start()
    session.level.fresh = False
    yield Block(place=block.place)
    _HANDLERS[word.keyword](session, block, word)


def _label(session: Session, block: ParsedBlock, word: OWord) -> str:
    if word.label is not None:
        return canonical_label(word.label)
    if word.label_value is None:
        raise block.error_at(word.column, "o-word", "an O-word without a label", "O and a number or <name>")
    value = block.value_of(word.label_value, session.variables.scope())
    if value is None or value != int(value) or value < 0:
        raise block.error_at(word.column, "o-word", f"O{value} is not a label", "a whole number of 0 or more")
    return str(int(value))


def _value(session: Session, block: ParsedBlock, expression: Expression) -> float:
    return block.value_of(expression, session.variables.scope()) or 0.0


def _condition(session: Session, block: ParsedBlock, word: OWord) -> float:
    if len(word.arguments) != 1:
        problem = f"{word.keyword.value} with {len(word.arguments)} conditions"
        raise block.error_at(word.column, "o-word", problem, "one, in brackets")
    return _value(session, block, word.arguments[0])


def _error(block: ParsedBlock, word: OWord, label: str, expected: str) -> GcodeError:
    problem = f"o<{label}> {word.keyword.value} without {expected}"
    return block.error_at(word.column, "o-word", problem, f"{expected} of the same label in the same program")


def _next(session: Session, block: ParsedBlock, word: OWord, label: str, keywords: tuple[str, ...]) -> OLine:
    """The next line of the same label with one of these keywords."""
    for line in session.level.program.o_lines_after(session.line_offset):
        if line.label == label and line.keyword in keywords:
            return line
        if line.keyword in ("sub", "endsub"):
            break
    raise _error(block, word, label, " or ".join(keywords))


def _sub(session: Session, block: ParsedBlock, word: OWord) -> None:
    """A definition in the course of a program is skipped; a call begins at this line too."""
    label = _label(session, block, word)
    level = session.level
    if level.kind == "routine" and level.start.offset == session.line_offset:
        return
    if level.program.subroutines.get(label, session.spot).offset != session.line_offset:
        raise block.error_at(word.column, "o-word", f"o<{label}> sub is defined twice", "one definition of a label")
    level.jump(session.spot_after(_next(session, block, word, label, ("endsub",)).spot))


def _end_sub(session: Session, block: ParsedBlock, word: OWord) -> None:
    level = session.level
    if level.kind != "routine":
        raise _error(block, word, _label(session, block, word), "a call")
    value = _value(session, block, word.arguments[0]) if word.arguments else None
    session.variables.set_named("_value", value or 0.0)
    session.variables.set_named("_value_returned", 0.0 if value is None else 1.0)
    session.leave()


def _call(session: Session, block: ParsedBlock, word: OWord) -> None:
    label = _label(session, block, word)
    arguments = {
        number: _value(session, block, expression) for number, expression in enumerate(word.arguments, start=1)
    }
    if len(arguments) > _ARGUMENTS:
        raise block.error_at(word.column, "o-word", f"a call with {len(arguments)} arguments", f"{_ARGUMENTS} at most")
    found = session.library.routine(session.level.program, label)
    if found is None:
        expected = f"o<{label}> sub in this file, or a file {label}.ngc in the same folder or on the search path"
        raise block.error_at(word.column, "unknown-program", f"subroutine o<{label}> is not found", expected)
    program, spot = found
    level = Level(
        program=program,
        spot=spot,
        start=spot,
        name=f"o<{label}>",
        owns_variables=True,
        kind="routine",
        arguments=arguments,
    )
    session.enter(block, level)


def _if(session: Session, block: ParsedBlock, word: OWord) -> None:
    if _condition(session, block, word):
        return
    _to_branch(session, block, word, _label(session, block, word), session.line_offset)


def _to_branch(session: Session, block: ParsedBlock, word: OWord, label: str, offset: int) -> None:
    """Continues at the first branch after `offset` whose condition holds."""
    for line in session.level.program.o_lines_after(offset):
        if line.label != label or line.keyword not in ("elseif", "else", "endif"):
            continue
        if line.keyword == "elseif":
            branch = session.block_at(line.spot)
            statement = branch.statement
            if isinstance(statement, OWord) and not _condition(session, branch, statement):
                continue
        session.level.jump(session.spot_after(line.spot))
        return
    raise _error(block, word, label, "endif")


def _past_if(session: Session, block: ParsedBlock, word: OWord) -> None:
    """An else or elseif that is reached ends the branch before it."""
    label = _label(session, block, word)
    session.level.jump(session.spot_after(_next(session, block, word, label, ("endif",)).spot))


def _end_if(session: Session, block: ParsedBlock, word: OWord) -> None:
    _opener(session, block, word, _label(session, block, word), ("if",))


def _opener(session: Session, block: ParsedBlock, word: OWord, label: str, keywords: tuple[str, ...]) -> OLine:
    for line in session.level.program.o_lines_before(session.line_offset):
        if line.label == label and line.keyword in keywords:
            return line
    raise _error(block, word, label, " or ".join(keywords))


def _while(session: Session, block: ParsedBlock, word: OWord) -> None:
    """The head of a while loop, or the end of a do loop of the same label."""
    label = _label(session, block, word)
    head = _do_of(session, label)
    holds = bool(_condition(session, block, word))
    if head is not None:
        if holds:
            session.count_jump(block.place)
            session.level.jump(session.spot_after(head))
        return
    if not holds:
        session.level.jump(session.spot_after(_next(session, block, word, label, ("endwhile",)).spot))


def _do_of(session: Session, label: str) -> Spot | None:
    """The do that a while at this line ends, None where it is the head of a loop of its own."""
    for line in session.level.program.o_lines_before(session.line_offset):
        if line.label != label:
            continue
        if line.keyword == "do":
            return line.spot
        if line.keyword in ("while", "endwhile", "sub"):
            return None
    return None


def _end_while(session: Session, block: ParsedBlock, word: OWord) -> None:
    label = _label(session, block, word)
    head = _opener(session, block, word, label, ("while",))
    session.count_jump(block.place)
    session.level.jump(head.spot)


def _do(_session: Session, _block: ParsedBlock, _word: OWord) -> None:
    """The head of a do loop: its end, a while, does everything."""


def _repeat(session: Session, block: ParsedBlock, word: OWord) -> None:
    label = _label(session, block, word)
    count = round(_condition(session, block, word))
    if count < 1:
        session.level.jump(session.spot_after(_next(session, block, word, label, ("endrepeat",)).spot))
        return
    session.level.counts[session.line_offset] = count - 1


def _end_repeat(session: Session, block: ParsedBlock, word: OWord) -> None:
    label = _label(session, block, word)
    head = _opener(session, block, word, label, ("repeat",))
    level = session.level
    left = level.counts.get(head.spot.offset, 0)
    if left > 0:
        level.counts[head.spot.offset] = left - 1
        session.count_jump(block.place)
        level.jump(session.spot_after(head.spot))


def _break(session: Session, block: ParsedBlock, word: OWord) -> None:
    end = _next(session, block, word, _label(session, block, word), _LOOP_ENDS)
    session.level.jump(session.spot_after(end.spot))


def _continue(session: Session, block: ParsedBlock, word: OWord) -> None:
    session.level.jump(_next(session, block, word, _label(session, block, word), _LOOP_ENDS).spot)


_HANDLERS: Mapping[OKeyword, Callable[[Session, ParsedBlock, OWord], None]] = {
    OKeyword.SUB: _sub,
    OKeyword.ENDSUB: _end_sub,
    OKeyword.RETURN: _end_sub,
    OKeyword.CALL: _call,
    OKeyword.IF: _if,
    OKeyword.ELSEIF: _past_if,
    OKeyword.ELSE: _past_if,
    OKeyword.ENDIF: _end_if,
    OKeyword.WHILE: _while,
    OKeyword.ENDWHILE: _end_while,
    OKeyword.DO: _do,
    OKeyword.BREAK: _break,
    OKeyword.CONTINUE: _continue,
    OKeyword.REPEAT: _repeat,
    OKeyword.ENDREPEAT: _end_repeat,
}


def keep_state(session: Session, block: ParsedBlock, request: StateRequest) -> None:
    """M70 saves the modes, M71 forgets them, M72 restores them, M73 saves them until the subroutine returns."""
    level = session.level
    if request.code == "M71":
        level.saved = None
    elif request.code == "M72":
        if level.saved is None:
            raise block.error(request.word, "no-saved-state", "M72 without a saved state", "M70 or M73 before it")
        session.state = level.saved.restored_in(session.state)
    else:
        state = session.state
        level.saved = SavedModes(modes=state.modes, machine=state.machine, until_return=request.code == "M73")
