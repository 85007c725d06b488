"""Calls of subprograms and macros, and the returns from them: M97, M98, M99, G65, G66 and G67."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

from gcode.errors import GcodeError, Place
from gcode.events import Event, Notice, ProgramStop
from gcode.flow.call_stack import Level
from gcode.flow.evaluation import MACRO_CALLS
from gcode.flow.jumps import jump_to_label
from gcode.flow.requests import CallRequest, macro_arguments
from gcode.flow.session import ModalMacro, Session
from gcode.language.blocks import ParsedBlock, Word
from gcode.language.program import Program, Spot
from gcode.phases.cutter_compensation import through
from gcode.phases.modes import whole_number


def macro_call(block: ParsedBlock) -> tuple[ParsedBlock, tuple[Word, tuple[Word, ...]]] | None:
    """A block with G65, G66 or G66.1, split into the words before it and the call with its own."""
    for index, word in enumerate(block.words):
        if word.letter == "G" and word.value in MACRO_CALLS:
            return replace(block, words=block.words[:index]), (word, block.words[index + 1 :])
    return None


def call_macro(session: Session, block: ParsedBlock, macro: tuple[Word, tuple[Word, ...]]) -> None:
    """G65 calls a macro now, G66 and G66.1 after every motion from here on."""
    word, words = macro
    if word.value not in {float(code[1:]) for code in session.dialect.codes if code.startswith("G6")}:
        raise block.error(word, "unknown-code", f"{word.text} is not a code of the {session.dialect.name} dialect")
    number = next((whole_number(block, w) for w in words if w.letter == "P"), None)
    count = next((whole_number(block, w) for w in words if w.letter == "L"), 1)
    if number is None and block.name is None:
        raise block.error(word, "missing-word", f"{word.text} without P", "P and the number of a program")
    session.check_repeats(block, word, count)
    arguments = macro_arguments(block, [w for w in words if w.letter not in "PL"])
    program, spot, name = _find(session, block, word, number)
    modal = ModalMacro(program=program, spot=spot, name=name, arguments=arguments, count=count)
    if word.value == 65.0:
        _enter_macro(session, block, modal, modal_call=False)
        return
    if session.modal_macro is not None:
        raise block.error(word, "nested-modal-call", f"{word.text} while one is active", "G67 before it")
    session.modal_macro = modal


def call_modal(session: Session, block: ParsedBlock) -> None:
    """The call that G66 makes after a motion."""
    if session.modal_macro is not None:
        _enter_macro(session, block, session.modal_macro, modal_call=True)


def _enter_macro(session: Session, block: ParsedBlock, macro: ModalMacro, *, modal_call: bool) -> None:
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
        modal=modal_call or session.level.modal,
    )
    session.enter(block, level)


def call(session: Session, block: ParsedBlock, request: CallRequest) -> Iterator[Event]:
    """M97, M98, M99 and G67."""
    if request.code == "G67":
        session.modal_macro = None
    elif request.code == "M99":
        yield from _return(session, block, request)
    elif request.code == "M97":
        _call_label(session, block, request)
    else:
        _call_program(session, block, request)


def _call_program(session: Session, block: ParsedBlock, request: CallRequest) -> None:
    if request.number is None and block.name is None:
        program, spot, name = session.level.program, session.level.start, "this program"
    else:
        program, spot, name = _find(session, block, request.word, request.number)
    if request.label is not None:
        start = program.label(request.label, spot.offset)
        if start is None:
            problem = f"{name} has no block N{request.label}"
            raise block.error(request.word, "unknown-label", problem, "a block number of the subprogram")
        spot = start
    session.check_repeats(block, request.word, request.count)
    if request.count < 1:
        return
    session.enter(
        block,
        Level(
            program=program,
            spot=spot,
            start=spot,
            name=name,
            repeats=request.count - 1,
            kind="program",
            modal=session.level.modal,
        ),
    )


def _find(session: Session, block: ParsedBlock, word: Word, number: int | None) -> tuple[Program, Spot, str]:
    if number is None:
        raise block.error(word, "unsupported-word", f"a call by name: {block.name}", "P and the number of a program")
    found = session.library.numbered(session.level.program, number)
    if found is None:
        problem = f"program O{number} is not found"
        expected = f"O{number} in this file, or a file O{number:04d} in the same folder or on the search path"
        raise block.error(word, "unknown-program", problem, expected)
    return (*found, f"O{number}")


def _call_label(session: Session, block: ParsedBlock, request: CallRequest) -> None:
    session.check_repeats(block, request.word, request.count)
    level = session.level
    number = request.number or 0
    spot = level.program.label(number, level.spot.offset - 1)
    if spot is None:
        problem = f"a call of N{number}, which is not in this program"
        raise block.error(request.word, "unknown-label", problem, "a block that starts with this number")
    if request.count < 1:
        return
    session.enter(
        block,
        Level(
            program=level.program, spot=spot, start=spot, name=f"N{number}", repeats=request.count - 1, kind="program"
        ),
    )


def _return(session: Session, block: ParsedBlock, request: CallRequest) -> Iterator[Event]:
    """M99: back to the caller, to its block N P where given; in the main program the end of a round."""
    level = session.level
    if level.kind == "routine":
        raise block.error(request.word, "return-place", f"{request.word.text} in a subroutine of O-words", "endsub")
    if level.kind == "main":
        if request.number is not None:
            jump_to_label(session, block, float(request.number), request.word.column)
            return
        text = f"{request.word.text} in the main program restarts it; one pass is run"
        yield Notice(place=block.place_of(request.word), code="round", text=text)
        session.state, events = through(
            session.state, None, (ProgramStop(place=block.place, optional=False, end=True),)
        )
        session.end()
        yield from events
        return
    session.leave(repeat=request.number is None)
    if request.number is not None:
        jump_to_label(session, block, float(request.number), request.word.column)


def end_of_subprogram(session: Session, place: Place) -> None:
    """The text of a subprogram ends without its return.

    Raises:
        GcodeError: in every control but those where a file's end returns.
    """
    level = session.level
    name = level.name
    session.leave(repeat=False)
    if level.kind == "program" and session.dialect.file_end_returns:
        return
    problem = f"{name} ends without its return"
    raise GcodeError(place, "missing-return", problem, "M99, or endsub for O-words")
