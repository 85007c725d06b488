"""Runs a program: reads line after line, and has each block executed.

Blocks of words are executed by `step`, a pure function; statements of the macro languages by `jumps` and `owords`,
calls by `subprograms`. All of them share a `Session`. Refusals are handed to the caller.
"""

from __future__ import annotations

from collections.abc import Callable, Generator, Iterator
from dataclasses import replace

from gcode.bulk.plain_batch import PlainBatch
from gcode.bulk.plain_rules import PlainStart, plain_rules
from gcode.bulk.plain_runs import MAX_LINES, PlainRun, plain_run
from gcode.control.state import State, same_position
from gcode.dialects import Dialect
from gcode.errors import GcodeError, Place
from gcode.events import ArcMotion, Event, LinearMotion, Notice
from gcode.flow import jumps, owords, subprograms
from gcode.flow.call_stack import Level
from gcode.flow.evaluation import evaluated
from gcode.flow.recovery import recovered
from gcode.flow.requests import CallRequest, StateRequest
from gcode.flow.session import Session
from gcode.flow.step import step
from gcode.flow.system_variables import SystemVariables
from gcode.flow.tape_leader import leader_end
from gcode.language.block_parser import parse_blocks
from gcode.language.blocks import OWord, ParsedBlock
from gcode.language.program import Program, Spot
from gcode.phases.arcs import arc_tolerance
from gcode.phases.cutter_compensation import flushed
from gcode.phases.g10 import skipped_data
from gcode.settings import MachineSettings

#: Lines of a called program that are kept with their places.
_PLACED_LINES = 1000
#: Events that count as those of one block; canned cycles with many holes make more.
_EVENTS_OF_A_BLOCK = 4
#: Motion codes of plain lines, by their number.
_PLAIN_MOTIONS = ("G0", "G1", "G2", "G3")
#: Fewest lines that are read at once: fewer are after lines that were read in vain, then more again.
_FEWEST_LINES = 64
#: Parsed lines that are kept, for programs that jump and call.
_KEPT_LINES = 50_000


class Runner:
    """Runs one program: reads its lines and hands each block to what executes it.

    Args:
        program: the main program.
        dialect: the control whose language it is in.
        settings: the machine at the program's start.
        refuse: takes each refusal; if it returns, the program continues.
        bulk: take runs of plain lines at once, for speed.

    Attributes:
        session: the memory of this run.
    """

    def __init__(
        self,
        program: Program,
        dialect: Dialect,
        settings: MachineSettings,
        refuse: Callable[[GcodeError], None],
        *,
        bulk: bool = True,
    ) -> None:
        self.session = Session(program, dialect, settings, SystemVariables)
        self._refuse = refuse
        self._bulk = bulk
        self._rules = plain_rules(dialect, settings)
        self._most_lines = MAX_LINES
        self._single: set[tuple[int, int]] = set()  # lines after which too few plain ones follow
        self._parsed: dict[tuple[int, int], tuple[tuple[ParsedBlock, ...], int]] = {}

    def run(self) -> Iterator[Event | PlainBatch]:
        """The events of the program; refused blocks go to `refuse`, and if that returns, the program continues."""
        session = self.session
        yield from self._skip_leader()
        while not session.state.ended:
            batch = self._plain() if self._bulk else None
            if batch is not None:
                yield batch
                continue
            block: ParsedBlock | None = None
            before = session.state
            try:
                block = self._next_block()
                if block is None:
                    yield from self._end_of_text()
                    continue
                yield from self._execute(block)
            except GcodeError as error:
                self._refuse(error)
                if block is not None:
                    session.state = recovered(before, block, error)

    def _skip_leader(self) -> Iterator[Event]:
        level = self.session.level
        leader = leader_end(level.program, self.session.dialect)
        if leader is not None:
            level.spot = leader
            place = Place(file=level.program.file, line=max(leader.line - 1, 1))
            text = f"lines 1 to {place.line}, before the first %, are not executed"
            yield Notice(place=place, code="leader", text=text)

    def _next_block(self) -> ParsedBlock | None:
        """The next block of the innermost level, None at the end of its text."""
        session, level = self.session, self.session.level
        if level.queue:
            return level.queue.pop(0)
        offset = level.spot.offset
        if offset >= level.program.size:
            return None
        session.line_offset = offset
        key = (id(level.program), offset)
        known = self._parsed.get(key)
        if known is None:
            known = self._parse_line(level, offset, key)
        blocks, level_next = known
        line = level.spot.line
        session.count_block(line)
        level.spot = Spot(level_next, line + 1)
        if not blocks:
            return ParsedBlock(place=Place(file=level.program.file, line=line, calls=level.calls))
        if level.calls:
            blocks = _placed(level, offset, blocks)
        level.queue.extend(blocks[1:])
        session.place = blocks[0].place
        return blocks[0]

    @property
    def _repeats(self) -> bool:
        """True where lines may be met more than once: in a call, and after a jump back."""
        return len(self.session.levels) > 1 or self.session.jumps > 0

    def _parse_line(self, level: Level, offset: int, key: tuple[int, int]) -> tuple[tuple[ParsedBlock, ...], int]:
        session = self.session
        text, following = level.program.line_at(offset)
        place = Place(file=level.program.file, line=level.spot.line, text=text, calls=level.calls)
        try:
            blocks = parse_blocks(place, session.dialect, block_delete=session.settings.block_delete)
        except GcodeError:
            level.spot = Spot(following, level.spot.line + 1)
            raise
        if len(self._parsed) < _KEPT_LINES and (self._repeats or not block_is_plain(blocks)):
            self._parsed[key] = (blocks, following)
        return blocks, following

    def _end_of_text(self) -> Iterator[Event]:
        """The text is over: the end of a main program, or a subprogram without its return."""
        session = self.session
        if session.level.kind != "main":
            subprograms.end_of_subprogram(session, session.place)
            return
        yield Notice(place=session.place, code="no-program-end", text="the program ends without M2, M30 or %")
        session.state, events = flushed(session.state)
        yield from events
        session.end()

    def _execute(self, block: ParsedBlock) -> Iterator[Event]:
        """Runs one block."""
        session, level = self.session, self.session.level
        if isinstance(block.statement, OWord):
            yield from owords.execute(session, block, block.statement)
            return
        if block.statement is not None:
            yield from jumps.execute(session, block, block.statement)
            return
        if block.percent and level.kind != "main":
            subprograms.end_of_subprogram(session, block.place)
            return
        first, level.fresh = level.fresh, False
        words = evaluated(session, block)
        if session.pending:
            yield from session.pending
            session.pending.clear()
        self._note(words)
        call = subprograms.macro_call(words)
        if call is not None:
            words, macro = call
        session.state, notice = skipped_data(session.state, words)
        if notice is not None:
            yield notice
            return
        moved = yield from self._step(words, first_of_program=first)
        if call is not None:
            subprograms.call_macro(session, block, macro)
        elif moved and session.modal_macro is not None and not level.modal and level is session.level:
            subprograms.call_modal(session, block)

    def _note(self, block: ParsedBlock) -> None:
        """Keeps the number of the block, and obeys a comment that ends the program."""
        session = self.session
        if block.words and block.words[0].letter == "N":
            session.last_label = int(block.words[0].value)
        for comment in block.comments:
            if session.dialect.macro.named and comment.strip().lower().startswith("abort,"):
                session.end()
                raise block.error(None, "abort", f"the program aborts: {comment.strip()[6:]}")

    def _step(self, block: ParsedBlock, *, first_of_program: bool) -> Generator[Event, None, bool]:
        """Runs a block of words; True where it moved, also where the motion waits for the next one."""
        session = self.session
        before, moved = session.state, False
        session.state, events = step(session.state, block, first_of_program=first_of_program)
        if len(events) > _EVENTS_OF_A_BLOCK:
            session.count_singly(block.place.line, len(events) // _EVENTS_OF_A_BLOCK)
        for event in events:
            if isinstance(event, CallRequest):
                yield from subprograms.call(session, block, event)
            elif isinstance(event, StateRequest):
                owords.keep_state(session, block, event)
            else:
                moved = moved or isinstance(event, LinearMotion | ArcMotion)
                yield event
        if before.waiting is not None or session.state.waiting is not None:  # others' motions were among the events
            moved = not same_position(before.position_mm, session.state.position_mm)
        if moved:
            session.jumps_at_motion = session.jumps
        return moved

    def _plain(self) -> PlainBatch | None:
        """A run of plain blocks from here on, taken at once; None where there is none."""
        session, level, state = self.session, self.session.level, self.session.state
        key = (id(level.program), level.spot.offset)
        if key in self._single or level.queue or session.modal_macro is not None or not is_plain(state):
            return None
        start = _plain_start(state, level.spot.line)
        most = min(self._most_lines, session.settings.limits.blocks - session.blocks)
        run, vain = plain_run(level.program.text, level.spot.offset, start, self._rules, max_lines=most)
        if vain:
            self._most_lines = max(_FEWEST_LINES, min(self._most_lines, 4 * run.lines if run else 0))
        elif run is not None:
            self._most_lines = min(MAX_LINES, 2 * self._most_lines)
        if run is None:
            if self._repeats and not vain and len(self._single) < _KEPT_LINES and most >= _FEWEST_LINES:
                self._single.add(key)
            return None
        session.count_blocks(start.line, run.lines)
        level.spot = Spot(run.offset, run.after.line)
        level.fresh = False
        if run.line.size:
            session.jumps_at_motion = session.jumps
        session.place = _last_place(level, run)
        session.state = _state_after(state, start, run)
        if run.label_after is not None:
            session.last_label = run.label_after
        return PlainBatch(
            start=start,
            run=run,
            state=state.machine,
            file=level.program.file,
            program=level.program,
            calls=level.calls,
            extra=state.extra,
        )


def _plain_start(state: State, line: int) -> PlainStart:
    modes, machine = state.modes, state.machine
    return PlainStart(
        position_mm=state.position_mm,
        zero_mm=state.frame.zero_mm,
        unit_mm=modes.unit_mm,
        absolute=modes.absolute,
        code=_PLAIN_MOTIONS.index(modes.motion),
        feed_mm_min=modes.feed,
        line=line,
        plane=machine.plane,
        absolute_centres=modes.absolute_centres,
        arc_tolerance=arc_tolerance(state),
        spindle_rpm=machine.spindle_rpm,
        spindle_direction=machine.spindle_direction,
        mist=modes.mist,
        flood=modes.flood,
    )


def _state_after(state: State, start: PlainStart, run: PlainRun) -> State:
    """The control after a run, of which only what has changed is made anew."""
    after = run.after
    if (after.spindle_rpm, after.spindle_direction) != (start.spindle_rpm, start.spindle_direction):
        state = state.with_machine(spindle_rpm=after.spindle_rpm, spindle_direction=after.spindle_direction)
    modes = (after.code, after.feed_mm_min, after.mist, after.flood)
    if modes != (start.code, start.feed_mm_min, start.mist, start.flood):
        motion = _PLAIN_MOTIONS[after.code]
        state = state.with_modes(
            motion=motion, base_motion=motion, feed=after.feed_mm_min, mist=after.mist, flood=after.flood
        )
    return replace(state, position_mm=after.position_mm, started=state.started or run.block.size > 0)


def _placed(level: Level, offset: int, blocks: tuple[ParsedBlock, ...]) -> tuple[ParsedBlock, ...]:
    """The blocks of a line with the calls that led to it in their places."""
    found = level.placed.get(offset)
    if found is None:
        found = tuple(replace(block, place=replace(block.place, calls=level.calls)) for block in blocks)
        if len(level.placed) < _PLACED_LINES:
            level.placed[offset] = found
    return found


def _last_place(level: Level, run: PlainRun) -> Place:
    """Location of the last line of a run that ends at the level's next line."""
    begin = max(level.program.text.rfind(b"\n", 0, run.offset - 1) + 1, run.begin)
    text, _ = level.program.line_at(begin)
    return Place(file=level.program.file, line=level.spot.line - 1, text=text, calls=level.calls)


def block_is_plain(blocks: tuple[ParsedBlock, ...]) -> bool:
    """True for a line of words that a program without jumps meets but once."""
    return all(block.statement is None for block in blocks)


def is_plain(state: State) -> bool:
    """True where a motion's end is the program zero and the words, and its feed is F."""
    modes = state.modes
    return (
        modes.motion in _PLAIN_MOTIONS
        and state.waiting is None
        and state.frame.matrix is None
        and not modes.polar
        and not modes.diameter
        and not modes.entering_data
        and not modes.in_cycle
        and not modes.rigid_tapping
        and modes.spline_lead_mm is None
        and modes.unmoved_length_mm == 0.0
        and modes.surface_speed is None
        and state.machine.feed_mode == "per-minute"
        and state.machine.wcs in state.setup.offsets
    )
