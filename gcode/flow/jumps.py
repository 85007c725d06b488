"""What a block does to the course of a program: assignments, jumps, loops, calls and returns."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

from gcode.control.state import State
from gcode.errors import Call, GcodeError, Place
from gcode.events import Block, Event, Notice, ProgramStop
from gcode.flow import owords
from gcode.flow.call_stack import Level
from gcode.flow.calls import CallRequest, StateRequest, macro_arguments
from gcode.language.blocks import ParsedBlock, Word
from gcode.language.expressions import Expression
from gcode.language.program import Program, Spot
from gcode.language.statements import Assignment, End, Goto, IfThen, Output, OWord, Statement, While
from gcode.phases.increments import in_increments
from gcode.phases.modes import whole_number
from gcode.phases.tool_path import through

if TYPE_CHECKING:
    from gcode.flow.runner import Runner

_MACRO_CALLS = frozenset({65.0, 66.0, 66.1})
#: Nested loops of FANUC's WHILE: DO1 to DO3.
_LOOP_LABELS = (1, 2, 3)
#: Kinds of data after G10 L that last until G11, block after block.
_DATA_UNTIL_G11 = "ignored"


@dataclass(frozen=True, slots=True, kw_only=True)
class ModalMacro:
    """What G66 calls after every motion."""

    program: Program
    spot: Spot
    name: str
    arguments: Mapping[int, float]
    count: int


def evaluated(runner: Runner, block: ParsedBlock) -> ParsedBlock:
    """The block with plain numbers for words; its assignments are made."""
    call = any(word.letter == "G" and word.value in _MACRO_CALLS for word in block.words)
    words = block if block.plain else block.evaluated(runner.variables.scope(), exact=call)
    assign(runner, block, block.assignments)
    return in_increments(runner.state, words)


def assign(runner: Runner, block: ParsedBlock, assignments: tuple[Assignment, ...]) -> None:
    """Makes assignments: all values are worked out before the first is stored."""
    scope = runner.variables.scope()
    values = [block.value_of(assignment.value, scope) for assignment in assignments]
    for assignment, value in zip(assignments, values, strict=True):
        block.guarded(runner.variables.assign, assignment.target, value, scope)


def skipped_data(runner: Runner, block: ParsedBlock) -> Notice | None:
    """A notice for a block of data entry (tool life, parameters) between G10 L and G11, which is not executed."""
    state, dialect = runner.state, runner.dialect
    codes = {word.value for word in block.words if word.letter == "G"}
    kind = next((word for word in block.words if word.letter == "L"), None)
    if not state.modes.entering_data:
        if kind is None or 10.0 not in codes or dialect.data_kinds.get(int(kind.value)) != _DATA_UNTIL_G11:
            return None
        runner.state = state.with_modes(entering_data=True)
    elif 11.0 in codes or block.percent:
        runner.state = state.with_modes(entering_data=False)
        return None
    if not block.words:
        return None
    return Notice(place=block.place, code="data-entry", text=f"data entry is not executed: {block.place.text.strip()}")


def flushed(state: State) -> tuple[State, tuple[Event, ...]]:
    """What waits for the next motion, at the end of a program that names none."""
    if state.path is None:
        return state, ()
    place = Place(file="", line=1)
    state, events = through(state, None, (ProgramStop(place=place, optional=False, end=True),))
    return state, events[:-1]


def execute(runner: Runner, block: ParsedBlock, statement: Statement) -> Iterator[Event]:
    """Runs a statement of the macro language."""
    if not runner.state.started:
        runner.state = replace(runner.state, started=True)
    runner.level.fresh = False
    yield Block(place=block.place)
    match statement:
        case Goto():
            _goto(runner, block, statement)
        case IfThen():
            if _true(runner, block, statement.condition):
                _then(runner, block, statement)
        case While():
            _while(runner, block, statement)
        case End():
            _end(runner, block, statement)
        case Output():
            text = f"{statement.keyword} has no effect on the simulated motion"
            yield Notice(place=block.place_at(statement.column), code="no-motion", text=text)
        case OWord():
            owords.execute(runner, block, statement)


def _then(runner: Runner, block: ParsedBlock, statement: IfThen) -> None:
    """What stands behind THEN: one assignment, and no words."""
    if statement.then.words or len(statement.then.assignments) != 1:
        shown = statement.then.words[0].text if statement.then.words else "nothing"
        raise block.error_at(statement.column, "bad-statement", f"{shown} behind THEN", "one assignment, #i = value")
    evaluated(runner, statement.then)


def _true(runner: Runner, block: ParsedBlock, condition: Expression) -> bool:
    return bool(block.value_of(condition, runner.variables.scope()))


def _goto(runner: Runner, block: ParsedBlock, statement: Goto) -> None:
    if statement.condition is not None and not _true(runner, block, statement.condition):
        return
    value = block.value_of(statement.target, runner.variables.scope())
    jump_to_label(runner, block, value, statement.column)


def jump_to_label(runner: Runner, block: ParsedBlock, value: float | None, column: int) -> None:
    """Goes on at the block N`value` of the present program.

    Raises:
        GcodeError: where the number is none, or the program has no such block.
    """
    if value is None or value < 0.0 or value != int(value):
        shown = "vacant" if value is None else f"{value:g}"
        raise block.error_at(column, "bad-label", f"a jump to {shown}", "the number of a block, N")
    level = runner.level
    spot = level.program.label(int(value), level.spot.offset - 1)
    if spot is None:
        problem = f"a jump to N{int(value)}, which this program does not have"
        raise block.error_at(column, "unknown-label", problem, "N and that number at the start of a line")
    if spot.offset < level.spot.offset:
        runner.count_jump(block.place)
    level.jump(spot)


def _while(runner: Runner, block: ParsedBlock, statement: While) -> None:
    level = runner.level
    at = runner.line_offset
    end = level.program.loops.get(at)
    if statement.label not in _LOOP_LABELS:
        raise block.error_at(statement.column, "bad-loop", f"DO{statement.label}", "DO1, DO2 or DO3")
    if end is None:
        problem = f"DO{statement.label} without END{statement.label}"
        raise block.error_at(statement.column, "bad-loop", problem, f"END{statement.label} in the same program")
    if at not in level.loops:
        _check_nesting(level, block, statement)
    if statement.condition is None or _true(runner, block, statement.condition):
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


def _end(runner: Runner, block: ParsedBlock, statement: End) -> None:
    level = runner.level
    ends = level.program.loops
    at = next((loop for loop in reversed(level.loops) if ends[loop].offset == runner.line_offset), None)
    if at is None:
        problem = f"END{statement.label} without its DO{statement.label}"
        raise block.error_at(statement.column, "bad-loop", problem, f"DO{statement.label} run before it")
    runner.count_jump(block.place)
    level.loops = level.loops[: level.loops.index(at) + 1]
    level.queue.clear()
    level.spot = level.program.spot_of(at)


def macro_call(block: ParsedBlock) -> tuple[ParsedBlock, tuple[Word, tuple[Word, ...]]] | None:
    """A block with G65, G66 or G66.1, split into the words before it and the call with its own."""
    for index, word in enumerate(block.words):
        if word.letter == "G" and word.value in _MACRO_CALLS:
            return replace(block, words=block.words[:index]), (word, block.words[index + 1 :])
    return None


def call_macro(runner: Runner, block: ParsedBlock, macro: tuple[Word, tuple[Word, ...]]) -> None:
    """G65 calls a macro now, G66 and G66.1 after every motion from here on."""
    word, words = macro
    if word.value not in {float(code[1:]) for code in runner.dialect.codes if code.startswith("G6")}:
        raise block.error(word, "unknown-code", f"{word.text} is no code of the {runner.dialect.name} dialect")
    number = next((whole_number(block, w) for w in words if w.letter == "P"), None)
    count = next((whole_number(block, w) for w in words if w.letter == "L"), 1)
    if number is None and block.name is None:
        raise block.error(word, "missing-word", f"{word.text} without P", "P and the number of a program")
    arguments = macro_arguments(block, [w for w in words if w.letter not in "PL"])
    program, spot, name = _find(runner, block, word, number)
    modal = ModalMacro(program=program, spot=spot, name=name, arguments=arguments, count=count)
    if word.value == 65.0:
        _enter_macro(runner, block, modal, modal_call=False)
        return
    if runner.modal_macro is not None:
        raise block.error(word, "nested-modal-call", f"{word.text} while one is active", "G67 before it")
    runner.modal_macro = modal


def call_modal(runner: Runner, block: ParsedBlock) -> None:
    """The call that G66 makes after a motion."""
    if runner.modal_macro is not None:
        _enter_macro(runner, block, runner.modal_macro, modal_call=True)


def _enter_macro(runner: Runner, block: ParsedBlock, macro: ModalMacro, *, modal_call: bool) -> None:
    if macro.count < 1:
        return
    level = Level(
        program=macro.program,
        spot=macro.spot,
        start=macro.spot,
        name=macro.name,
        repeats=macro.count - 1,
        owns_variables=True,
        kind="macro",
        arguments=macro.arguments,
        modal=modal_call or runner.level.modal,
    )
    enter(runner, block, level)


def enter(runner: Runner, block: ParsedBlock, level: Level) -> None:
    """Puts a level on the call stack.

    Raises:
        GcodeError: where calls are nested too deep.
    """
    limit = runner.settings.limits.nesting
    if len(runner.levels) > limit:
        runner.state = replace(runner.state, ended=True)
        raise block.error(None, "nesting", f"calls nested more than {limit} deep", "fewer levels")
    here = block.place
    level.calls = (*here.calls, Call(program=level.name, file=here.file, line=here.line))
    if level.owns_variables:
        runner.variables.push(level.arguments)
    runner.levels.append(level)
    if not runner.state.started:
        runner.state = replace(runner.state, started=True)


def call(runner: Runner, block: ParsedBlock, request: CallRequest) -> Iterator[Event]:
    """M97, M98, M99 and G67."""
    if request.code == "G67":
        runner.modal_macro = None
    elif request.code == "M99":
        yield from _return(runner, block, request)
    elif request.code == "M97":
        _call_label(runner, block, request)
    else:
        _call_program(runner, block, request)


def _call_program(runner: Runner, block: ParsedBlock, request: CallRequest) -> None:
    if request.number is None and block.name is None:
        program, spot, name = runner.level.program, runner.level.start, "this program"
    else:
        program, spot, name = _find(runner, block, request.word, request.number)
    if request.label is not None:
        start = program.label(request.label, spot.offset)
        if start is None:
            problem = f"{name} has no block N{request.label}"
            raise block.error(request.word, "unknown-label", problem, "a block number of the subprogram")
        spot = start
    if request.count < 1:
        return
    enter(
        runner,
        block,
        Level(
            program=program,
            spot=spot,
            start=spot,
            name=name,
            repeats=request.count - 1,
            kind="program",
            modal=runner.level.modal,
        ),
    )


def _find(runner: Runner, block: ParsedBlock, word: Word, number: int | None) -> tuple[Program, Spot, str]:
    if number is None:
        raise block.error(word, "unsupported-word", f"a call by name: {block.name}", "P and the number of a program")
    found = runner.library.numbered(runner.level.program, number)
    if found is None:
        problem = f"program O{number} is not found"
        expected = f"O{number} in this file, or a file O{number:04d} beside it or on the search path"
        raise block.error(word, "unknown-program", problem, expected)
    return (*found, f"O{number}")


def _call_label(runner: Runner, block: ParsedBlock, request: CallRequest) -> None:
    level = runner.level
    number = request.number or 0
    spot = level.program.label(number, level.spot.offset - 1)
    if spot is None:
        problem = f"a call of N{number}, which this program does not have"
        raise block.error(request.word, "unknown-label", problem, "N and that number at the start of a line")
    if request.count < 1:
        return
    enter(
        runner,
        block,
        Level(
            program=level.program, spot=spot, start=spot, name=f"N{number}", repeats=request.count - 1, kind="program"
        ),
    )


def _return(runner: Runner, block: ParsedBlock, request: CallRequest) -> Iterator[Event]:
    """M99: back to the caller, to its block N P where given; in the main program the end of a round."""
    level = runner.level
    if level.kind == "routine":
        raise block.error(request.word, "return-place", f"{request.word.text} in a subroutine of O-words", "endsub")
    if level.kind == "main":
        if request.number is not None:
            jump_to_label(runner, block, float(request.number), request.word.column)
            return
        text = f"{request.word.text} in the main program starts it again; one round is run"
        yield Notice(place=block.place_of(request.word), code="round", text=text)
        runner.state, events = through(runner.state, None, (ProgramStop(place=block.place, optional=False, end=True),))
        runner.state = replace(runner.state, ended=True)
        yield from events
        return
    leave(runner, repeat=request.number is None)
    if request.number is not None:
        jump_to_label(runner, block, float(request.number), request.word.column)


def leave(runner: Runner, *, repeat: bool = True) -> None:
    """Ends the innermost level, or starts it again where it is to be repeated."""
    level = runner.level
    restored = level.saved
    if repeat and level.repeats > 0:
        level.repeats -= 1
        level.queue.clear()
        level.loops.clear()
        level.counts.clear()
        level.spot = level.start
        level.fresh = True
        if level.owns_variables:
            runner.variables.pop()
            runner.variables.push(level.arguments)
        return
    runner.levels.pop()
    if level.owns_variables:
        runner.variables.pop()
    if restored is not None and restored[2]:
        runner.state = owords.restored_state(runner.state, restored)


def end_of_subprogram(runner: Runner, place: Place) -> None:
    """The text of a subprogram ends without its return.

    Raises:
        GcodeError: in every control but those where a file's end returns.
    """
    level = runner.level
    name = level.name
    leave(runner, repeat=False)
    if level.kind == "program" and runner.dialect.file_end_returns:
        return
    problem = f"{name} ends without its return"
    raise GcodeError(place, "missing-return", problem, "M99, or endsub for O-words")


def keep_state(runner: Runner, block: ParsedBlock, request: StateRequest) -> None:
    """M70 to M73."""
    owords.keep_state(runner, block, request)
