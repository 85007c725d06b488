"""Runs a program: which block comes next, through subprograms, macros, jumps and loops.

What a block of words does is `step`, a pure function; what a statement of the macro language does is `flow`. Here the
two are fed with lines, and their refusals handed to whoever runs the program.
"""

from __future__ import annotations

from collections.abc import Callable, Generator, Iterator
from dataclasses import replace
from typing import NoReturn

from gcode.bulk.plain_runs import MAX_LINES, PlainBatch, PlainRun, PlainStart, plain_run
from gcode.control.state import Setup, State, initial_state
from gcode.control.variables import Variables
from gcode.dialects import Dialect
from gcode.errors import GcodeError, Place
from gcode.events import ArcMotion, Event, LinearMotion, Notice
from gcode.flow import jumps
from gcode.flow.call_stack import Level
from gcode.flow.calls import CallRequest, Library, StateRequest
from gcode.flow.leader import leader_end
from gcode.flow.recover import recovered
from gcode.flow.step import step
from gcode.flow.system_variables import SystemVariables
from gcode.language.blocks import ParsedBlock
from gcode.language.parse import parse_blocks
from gcode.language.program import Program, Spot
from gcode.settings import MachineSettings

#: Parsed lines that are kept, for programs that jump and call.
_KEPT_LINES = 50_000


class Runner:
    """One run of one program.

    Attributes:
        state: the control as it stands.
        levels: the call stack, the main program first.
        variables: of the macro language.
        spare: parameters of LinuxCNC that have no meaning here, by number.
        pending: events that an assignment made.
        last_label: number of the last N word.
        place: of the present line.
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
        self.state: State = initial_state(dialect, settings)
        self.settings = settings
        self.dialect = dialect
        self.library = Library(settings.search_path)
        self.levels = [Level(program=program, spot=Spot(0, 1))]
        self.system = SystemVariables(self)
        self.variables = Variables(
            dialect.macro,
            system=self.system.read,
            set_system=self.system.write,
            system_name=self.system.named,
            initial=settings.variables,
            steps=self.steps_of,
        )
        self.spare: dict[int, tuple[float, Setup]] = {}
        self.pending: list[Event] = []
        self.last_label = 0
        self.modal_macro: jumps.ModalMacro | None = None
        self._refuse = refuse
        self._bulk = bulk
        self._blocks = 0
        self._jumps = 0
        self._line_offset = 0
        self._parsed: dict[tuple[int, int], tuple[tuple[ParsedBlock, ...], int]] = {}
        self.place = Place(file=program.file, line=1)

    @property
    def level(self) -> Level:
        """The innermost level."""
        return self.levels[-1]

    @property
    def least_increments(self) -> int:
        """Least input increments of a length that make one unit: 0.001 mm, or 0.0001 inch."""
        return 1000 if self.state.modes.unit_mm == 1.0 else 10_000

    def steps_of(self, letter: str) -> int:
        """Parts of a unit to which a worked out number of an address is rounded, 0 for no rounding."""
        if letter in self.dialect.increment_letters:
            return self.least_increments
        return int(letter in self.dialect.whole_letters)

    def run(self) -> Iterator[Event | PlainBatch]:
        """The events of the program; refused blocks go to `refuse`, and if that returns, the program goes on."""
        yield from self._begin()
        while not self.state.ended:
            batch = self._plain() if self._bulk else None
            if batch is not None:
                yield batch
                continue
            block: ParsedBlock | None = None
            before = self.state
            try:
                block = self._next_block()
                if block is None:
                    yield from self._end_of_text()
                    continue
                yield from self._execute(block)
            except GcodeError as error:
                self._refuse(error)
                self.state = recovered(before, block, error) if block is not None else self.state

    def _begin(self) -> Iterator[Event]:
        level = self.level
        leader = leader_end(level.program, self.dialect)
        if leader is not None:
            level.spot = leader
            place = Place(file=level.program.file, line=max(leader.line - 1, 1))
            text = f"lines 1 to {place.line}, before the first %, are not executed"
            yield Notice(place=place, code="leader", text=text)

    def _next_block(self) -> ParsedBlock | None:
        """The next block of the innermost level, None at the end of its text."""
        level = self.level
        if level.queue:
            return level.queue.pop(0)
        offset = level.spot.offset
        if offset >= level.program.size:
            return None
        self._line_offset = offset
        key = (id(level.program), offset)
        known = self._parsed.get(key)
        if known is None:
            known = self._parse_line(level, offset, key)
        blocks, level_next = known
        line = level.spot.line
        self._count_block(line)
        level.spot = Spot(level_next, line + 1)
        if not blocks:
            return ParsedBlock(place=Place(file=level.program.file, line=line, calls=level.calls))
        if level.calls:
            blocks = tuple(replace(block, place=replace(block.place, calls=level.calls)) for block in blocks)
        level.queue.extend(blocks[1:])
        self.place = blocks[0].place
        return blocks[0]

    def _parse_line(self, level: Level, offset: int, key: tuple[int, int]) -> tuple[tuple[ParsedBlock, ...], int]:
        text, following = level.program.line_at(offset)
        place = Place(file=level.program.file, line=level.spot.line, text=text, calls=level.calls)
        try:
            blocks = parse_blocks(place, self.dialect, block_delete=self.settings.block_delete)
        except GcodeError:
            level.spot = Spot(following, level.spot.line + 1)
            raise
        if len(self._parsed) < _KEPT_LINES and (len(self.levels) > 1 or not block_is_plain(blocks)):
            self._parsed[key] = (blocks, following)
        return blocks, following

    @property
    def line_offset(self) -> int:
        """Offset of the line that is being run."""
        return self._line_offset

    def block_at(self, spot: Spot) -> ParsedBlock:
        """The first block of the line at `spot`, parsed."""
        text, _ = self.level.program.line_at(spot.offset)
        place = Place(file=self.level.program.file, line=spot.line, text=text, calls=self.level.calls)
        return parse_blocks(place, self.dialect)[0]

    def count_jump(self, place: Place) -> None:
        """Counts a jump back, so that a loop without an end is found before it has run for long.

        Raises:
            GcodeError: beyond `Limits.jumps`.
        """
        self._jumps += 1
        if self._jumps > self.settings.limits.jumps:
            self._run_away(place.line, f"more than {self.settings.limits.jumps} jumps back were made")

    def _count_block(self, line: int, blocks: int = 1) -> None:
        self._blocks += blocks
        limit = self.settings.limits.blocks
        if self._blocks > limit:
            self._run_away(line, f"more than {limit} blocks were executed")

    def _run_away(self, line: int, problem: str) -> NoReturn:
        self.state = replace(self.state, ended=True)
        place = Place(file=self.level.program.file, line=line, calls=self.level.calls)
        raise GcodeError(place, "runaway", problem, "a program that ends, or a higher limit")

    def _end_of_text(self) -> Iterator[Event]:
        """The text is over: the end of a main program, or a subprogram without its return."""
        level = self.level
        if level.kind != "main":
            jumps.end_of_subprogram(self, self.place)
            return
        yield Notice(place=self.place, code="no-program-end", text="the program ends without M2, M30 or %")
        self.state, events = jumps.flushed(self.state)
        yield from events
        self.state = replace(self.state, ended=True)

    def _execute(self, block: ParsedBlock) -> Iterator[Event]:
        """Runs one block."""
        level = self.level
        if block.statement is not None:
            yield from jumps.execute(self, block, block.statement)
            return
        if block.percent and level.kind != "main":
            jumps.end_of_subprogram(self, block.place)
            return
        first, level.fresh = level.fresh, False
        words = jumps.evaluated(self, block)
        if self.pending:
            yield from self.pending
            self.pending.clear()
        self._note(words)
        call = jumps.macro_call(words)
        if call is not None:
            words, macro = call
        notice = jumps.skipped_data(self, words)
        if notice is not None:
            yield notice
            return
        moved = yield from self._step(words, first_of_program=first)
        if call is not None:
            jumps.call_macro(self, block, macro)
        elif moved and self.modal_macro is not None and not level.modal and level is self.level:
            jumps.call_modal(self, block)

    def _note(self, block: ParsedBlock) -> None:
        """Keeps the number of the block, and obeys a comment that ends the program."""
        if block.words and block.words[0].letter == "N":
            self.last_label = int(block.words[0].value)
        for comment in block.comments:
            if self.dialect.macro.named and comment.strip().lower().startswith("abort,"):
                self.state = replace(self.state, ended=True)
                raise block.error(None, "abort", f"the program aborts: {comment.strip()[6:]}")

    def _step(self, block: ParsedBlock, *, first_of_program: bool) -> Generator[Event, None, bool]:
        """Runs a block of words; True where it moved."""
        moved = False
        self.state, events = step(self.state, block, first_of_program=first_of_program)
        for event in events:
            if isinstance(event, CallRequest):
                yield from jumps.call(self, block, event)
            elif isinstance(event, StateRequest):
                jumps.keep_state(self, block, event)
            else:
                moved = moved or isinstance(event, LinearMotion | ArcMotion)
                yield event
        return moved

    def _plain(self) -> PlainBatch | None:
        """A run of plain motion blocks from here on, taken at once; None where there is none."""
        level, state = self.level, self.state
        if level.queue or self.modal_macro is not None or not is_plain(state):
            return None
        feed = state.modes.feed
        start = PlainStart(
            position_mm=state.position_mm,
            zero_mm=state.frame.zero_mm,
            unit_mm=state.modes.unit_mm,
            absolute=state.modes.absolute,
            rapid=state.modes.motion == "G0",
            feed_mm_min=feed,
            line=level.spot.line,
        )
        most = min(MAX_LINES, self.settings.limits.blocks - self._blocks)
        run = plain_run(level.program.text, level.spot.offset, start, max_lines=most)
        if run is None:
            return None
        line = level.spot.line
        self._count_block(line, run.lines)
        level.spot = Spot(run.offset, line + run.lines)
        level.fresh = False
        self.place = self._last_place(run)
        motion = "G0" if run.rapid_after else "G1"
        self.state = replace(state, position_mm=run.position_mm, started=True)
        if motion != state.modes.motion or run.feed_after != feed:
            self.state = self.state.with_modes(motion=motion, base_motion=motion, feed=run.feed_after)
        self.last_label = self.last_label if run.label_after is None else run.label_after
        return PlainBatch(
            start=start,
            run=run,
            state=state.machine,
            file=level.program.file,
            program=level.program,
            calls=level.calls,
            extra=state.extra,
        )

    def _last_place(self, run: PlainRun) -> Place:
        """Place of the last line of a run that ends where the level stands."""
        level = self.level
        begin = max(level.program.text.rfind(b"\n", 0, run.offset - 1) + 1, run.begin)
        text, _ = level.program.line_at(begin)
        return Place(file=level.program.file, line=level.spot.line - 1, text=text, calls=level.calls)


def block_is_plain(blocks: tuple[ParsedBlock, ...]) -> bool:
    """True for a line of words that a program without jumps meets but once."""
    return all(block.statement is None for block in blocks)


def is_plain(state: State) -> bool:
    """True where a straight motion's end is the program zero and the words, and its feed is F."""
    modes = state.modes
    return (
        modes.motion in ("G0", "G1")
        and state.path is None
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
        and state.control.settings.decimal_point == "calculator"
    )
