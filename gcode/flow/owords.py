"""LinuxCNC's O-words: sub, call, return, if, while, do, repeat, break and continue; and M70 to M73."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace
from typing import TYPE_CHECKING

from gcode.control.state import State
from gcode.errors import GcodeError
from gcode.flow import jumps
from gcode.flow.call_stack import Level
from gcode.flow.calls import StateRequest
from gcode.language.blocks import ParsedBlock
from gcode.language.expressions import Expression
from gcode.language.program import OLine, Spot, canonical_label
from gcode.language.statements import OKeyword, OWord

if TYPE_CHECKING:
    from gcode.flow.runner import Runner

_LOOP_ENDS = ("endwhile", "while")
#: Fields of the modal state that M70 saves.
_SAVED_MODES = ("absolute", "unit_mm", "absolute_centres", "feed", "return_to_r", "diameter", "motion", "base_motion")
_SAVED_MACHINE = ("plane", "feed_mode", "spindle_rpm")
#: Variables #1 to #30 are a subroutine's own.
_ARGUMENTS = 30


def execute(runner: Runner, block: ParsedBlock, word: OWord) -> None:
    """Runs one line with an O-word."""
    _HANDLERS[word.keyword](runner, block, word)


def _label(runner: Runner, block: ParsedBlock, word: OWord) -> str:
    if word.label is not None:
        return canonical_label(word.label)
    if word.label_value is None:
        raise block.error_at(word.column, "o-word", "an O-word without a label", "O and a number or <name>")
    value = block.value_of(word.label_value, runner.variables.scope())
    if value is None or value != int(value) or value < 0:
        raise block.error_at(word.column, "o-word", f"O{value} is no label", "a whole number of 0 or more")
    return str(int(value))


def _value(runner: Runner, block: ParsedBlock, expression: Expression) -> float:
    return block.value_of(expression, runner.variables.scope()) or 0.0


def _condition(runner: Runner, block: ParsedBlock, word: OWord) -> float:
    if len(word.arguments) != 1:
        problem = f"{word.keyword.value} with {len(word.arguments)} conditions"
        raise block.error_at(word.column, "o-word", problem, "one, in brackets")
    return _value(runner, block, word.arguments[0])


def _error(block: ParsedBlock, word: OWord, label: str, expected: str) -> GcodeError:
    problem = f"o<{label}> {word.keyword.value} without {expected}"
    return block.error_at(word.column, "o-word", problem, f"{expected} of the same label in the same program")


def _next(runner: Runner, block: ParsedBlock, word: OWord, label: str, keywords: tuple[str, ...]) -> OLine:
    """The next line of the same label that says one of these."""
    for line in runner.level.program.o_lines_after(runner.line_offset):
        if line.label == label and line.keyword in keywords:
            return line
        if line.keyword in ("sub", "endsub"):
            break
    raise _error(block, word, label, " or ".join(keywords))


def _behind(runner: Runner, spot: Spot) -> Spot:
    """The line after the one at `spot`."""
    _, following = runner.level.program.line_at(spot.offset)
    return Spot(following, spot.line + 1)


def _sub(runner: Runner, block: ParsedBlock, word: OWord) -> None:
    """A definition met on the way is passed over; the first line of a call is this line too."""
    label = _label(runner, block, word)
    level = runner.level
    if level.kind == "routine" and level.start.offset == runner.line_offset:
        return
    if level.program.subroutines.get(label, runner_spot(runner)).offset != runner.line_offset:
        raise block.error_at(word.column, "o-word", f"o<{label}> sub is defined twice", "one definition of a label")
    level.jump(_behind(runner, _next(runner, block, word, label, ("endsub",)).spot))


def runner_spot(runner: Runner) -> Spot:
    """The line that is being run."""
    return Spot(runner.line_offset, runner.level.spot.line - 1)


def _end_sub(runner: Runner, block: ParsedBlock, word: OWord) -> None:
    level = runner.level
    if level.kind != "routine":
        raise _error(block, word, _label(runner, block, word), "a call")
    value = _value(runner, block, word.arguments[0]) if word.arguments else None
    runner.variables.set_named("_value", value or 0.0)
    runner.variables.set_named("_value_returned", 0.0 if value is None else 1.0)
    jumps.leave(runner)


def _call(runner: Runner, block: ParsedBlock, word: OWord) -> None:
    label = _label(runner, block, word)
    arguments = {number: _value(runner, block, expression) for number, expression in enumerate(word.arguments, start=1)}
    if len(arguments) > _ARGUMENTS:
        raise block.error_at(word.column, "o-word", f"a call with {len(arguments)} arguments", f"{_ARGUMENTS} at most")
    found = runner.library.routine(runner.level.program, label)
    if found is None:
        expected = f"o<{label}> sub in this file, or a file {label}.ngc beside it or on the search path"
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
    jumps.enter(runner, block, level)


def _if(runner: Runner, block: ParsedBlock, word: OWord) -> None:
    if _condition(runner, block, word):
        return
    _to_branch(runner, block, word, _label(runner, block, word), runner.line_offset)


def _to_branch(runner: Runner, block: ParsedBlock, word: OWord, label: str, offset: int) -> None:
    """Goes on at the first branch behind `offset` whose condition holds."""
    for line in runner.level.program.o_lines_after(offset):
        if line.label != label or line.keyword not in ("elseif", "else", "endif"):
            continue
        if line.keyword == "elseif":
            branch = runner.block_at(line.spot)
            statement = branch.statement
            if isinstance(statement, OWord) and not _condition(runner, branch, statement):
                continue
        runner.level.jump(_behind(runner, line.spot))
        return
    raise _error(block, word, label, "endif")


def _past_if(runner: Runner, block: ParsedBlock, word: OWord) -> None:
    """An else or elseif met on the way ends the branch before it."""
    label = _label(runner, block, word)
    runner.level.jump(_behind(runner, _next(runner, block, word, label, ("endif",)).spot))


def _end_if(runner: Runner, block: ParsedBlock, word: OWord) -> None:
    _opener(runner, block, word, _label(runner, block, word), ("if",))


def _opener(runner: Runner, block: ParsedBlock, word: OWord, label: str, keywords: tuple[str, ...]) -> OLine:
    for line in runner.level.program.o_lines_before(runner.line_offset):
        if line.label == label and line.keyword in keywords:
            return line
    raise _error(block, word, label, " or ".join(keywords))


def _while(runner: Runner, block: ParsedBlock, word: OWord) -> None:
    """The head of a while loop, or the end of a do loop of the same label."""
    label = _label(runner, block, word)
    head = _do_of(runner, label)
    holds = bool(_condition(runner, block, word))
    if head is not None:
        if holds:
            runner.count_jump(block.place)
            runner.level.jump(_behind(runner, head))
        return
    if not holds:
        runner.level.jump(_behind(runner, _next(runner, block, word, label, ("endwhile",)).spot))


def _do_of(runner: Runner, label: str) -> Spot | None:
    """The do that a while at this line ends, None where it is the head of a loop of its own."""
    for line in runner.level.program.o_lines_before(runner.line_offset):
        if line.label != label:
            continue
        if line.keyword == "do":
            return line.spot
        if line.keyword in ("while", "endwhile", "sub"):
            return None
    return None


def _end_while(runner: Runner, block: ParsedBlock, word: OWord) -> None:
    label = _label(runner, block, word)
    head = _opener(runner, block, word, label, ("while",))
    runner.count_jump(block.place)
    runner.level.jump(head.spot)


def _do(_runner: Runner, _block: ParsedBlock, _word: OWord) -> None:
    """The head of a do loop: its end, a while, does all."""


def _repeat(runner: Runner, block: ParsedBlock, word: OWord) -> None:
    label = _label(runner, block, word)
    count = round(_condition(runner, block, word))
    if count < 1:
        runner.level.jump(_behind(runner, _next(runner, block, word, label, ("endrepeat",)).spot))
        return
    runner.level.counts[runner.line_offset] = count - 1


def _end_repeat(runner: Runner, block: ParsedBlock, word: OWord) -> None:
    label = _label(runner, block, word)
    head = _opener(runner, block, word, label, ("repeat",))
    level = runner.level
    left = level.counts.get(head.spot.offset, 0)
    if left > 0:
        level.counts[head.spot.offset] = left - 1
        runner.count_jump(block.place)
        level.jump(_behind(runner, head.spot))


def _break(runner: Runner, block: ParsedBlock, word: OWord) -> None:
    end = _next(runner, block, word, _label(runner, block, word), _LOOP_ENDS)
    runner.level.jump(_behind(runner, end.spot))


def _continue(runner: Runner, block: ParsedBlock, word: OWord) -> None:
    runner.level.jump(_next(runner, block, word, _label(runner, block, word), _LOOP_ENDS).spot)


_HANDLERS: Mapping[OKeyword, Callable[[Runner, ParsedBlock, OWord], None]] = {
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


def keep_state(runner: Runner, block: ParsedBlock, request: StateRequest) -> None:
    """M70 saves the modes, M71 forgets them, M72 restores them, M73 saves them until the subroutine returns."""
    level = runner.level
    if request.code == "M71":
        level.saved = None
    elif request.code == "M72":
        if level.saved is None:
            raise block.error(request.word, "no-saved-state", "M72 without a saved state", "M70 or M73 before it")
        runner.state = restored_state(runner.state, level.saved)
    else:
        level.saved = (runner.state.modes, runner.state.machine, request.code == "M73")


def restored_state(state: State, saved: tuple[object, object, bool]) -> State:
    """The state with the modes that were saved."""
    modes, machine, _ = saved
    state = replace(
        state,
        modes=replace(state.modes, **{name: getattr(modes, name) for name in _SAVED_MODES}),
        machine=replace(state.machine, **{name: getattr(machine, name) for name in _SAVED_MACHINE}),
    )
    return state.reframed()
