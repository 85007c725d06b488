"""The memory of a running program: the state that the functions of this folder read and change."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from typing import NoReturn

from gcode.control.state import Setup, State, initial_state
from gcode.control.variables import ControlVariables, Variables
from gcode.dialects import Dialect
from gcode.errors import Call, GcodeError, Place
from gcode.events import Event
from gcode.flow.call_stack import Level
from gcode.flow.library import Library
from gcode.language.block_parser import parse_blocks
from gcode.language.blocks import ParsedBlock, Word
from gcode.language.program import Program, Spot
from gcode.settings import MachineSettings


@dataclass(frozen=True, slots=True, kw_only=True)
class ModalMacro:
    """The macro that G66 calls after every motion."""

    program: Program
    spot: Spot
    name: str
    arguments: Mapping[int, float]
    count: int


class Session:
    """One run of one program: the control, the call stack, the variables, and the counts that end a runaway program.

    Args:
        program: the main program.
        dialect: the control whose language it is in.
        settings: the machine at the program's start.
        control_variables: makes the access to the control's own variables, which read and change this session.

    Attributes:
        state: modes, offsets and position of the control.
        levels: the call stack, the main program first.
        variables: of the macro language.
        stored: values of LinuxCNC's parameters that have no effect here, each with the offsets when it was written.
        library: where subprograms are found.
        pending: events of an assignment that are still to be given out.
        modal_macro: the macro of G66 that is active, None for none.
        last_label: number of the last N word.
        place: of the line that is being run.
        line_offset: byte offset of that line.
        blocks: blocks executed so far.
        jumps: jumps back made so far.
        singly: those of them that were executed one by one, and holes of canned cycles.
        jumps_at_motion: the jumps when the program last moved.
        assumed: control variables whose value was assumed to be 0, each reported once.
    """

    def __init__(
        self,
        program: Program,
        dialect: Dialect,
        settings: MachineSettings,
        control_variables: Callable[[Session], ControlVariables],
    ) -> None:
        self.dialect = dialect
        self.settings = settings
        self.state: State = initial_state(dialect, settings)
        self.levels = [Level(program=program, spot=Spot(0, 1))]
        self.variables = Variables(
            dialect, control=control_variables(self), initial=settings.variables, steps=self.steps_of
        )
        self.stored: dict[int, tuple[float, Setup]] = {}
        self.library = Library(settings.search_path)
        self.pending: list[Event] = []
        self.modal_macro: ModalMacro | None = None
        self.last_label = 0
        self.place = Place(file=program.file, line=1)
        self.line_offset = 0
        self.blocks = 0
        self.jumps = 0
        self.jumps_at_motion = 0
        self.singly = 0
        self._singly_allowed = settings.limits.repeated
        self.assumed: set[int] = set()

    @property
    def level(self) -> Level:
        """The innermost level."""
        return self.levels[-1]

    @property
    def spot(self) -> Spot:
        """The line that is being run."""
        return Spot(self.line_offset, self.level.spot.line - 1)

    def spot_after(self, spot: Spot) -> Spot:
        """The line after the one at `spot`."""
        _, following = self.level.program.line_at(spot.offset)
        return Spot(following, spot.line + 1)

    def block_at(self, spot: Spot) -> ParsedBlock:
        """The first block of the line at `spot`, parsed."""
        text, _ = self.level.program.line_at(spot.offset)
        place = Place(file=self.level.program.file, line=spot.line, text=text, calls=self.level.calls)
        return parse_blocks(place, self.dialect)[0]

    def steps_of(self, letter: str) -> int:
        """Steps per unit to which a computed number of an address is rounded, 0 for no rounding.

        Lengths have 1000 least input increments in a millimetre and 10,000 in an inch.
        """
        if letter in self.dialect.increment_letters:
            return 1000 if self.state.modes.unit_mm == 1.0 else 10_000
        return int(letter in self.dialect.whole_letters)

    def start(self) -> None:
        """Marks the program as begun, so that a percent sign from here on ends it."""
        if not self.state.started:
            self.state = replace(self.state, started=True)

    def end(self) -> None:
        """Ends the program."""
        self.state = replace(self.state, ended=True)

    def enter(self, block: ParsedBlock, level: Level) -> None:
        """Puts a level on the call stack.

        Raises:
            GcodeError: where calls are nested too deep.
        """
        limit = self.settings.limits.nesting
        if len(self.levels) > limit:
            self.end()
            raise block.error(None, "nesting", f"calls nested more than {limit} deep", "fewer levels")
        here = block.place
        level.calls = (*here.calls, Call(program=level.name, file=here.file, line=here.line))
        if level.owns_variables:
            self.variables.push(level.arguments)
        self.levels.append(level)
        self.start()

    def leave(self, *, repeat: bool = True) -> None:
        """Ends the innermost level, or starts it again where it is to be repeated."""
        level = self.level
        if repeat and level.repeats > 0:
            self.count_jump(self.place)
            level.begin_again()
            if level.owns_variables:
                self.variables.pop()
                self.variables.push(level.arguments)
            return
        self.levels.pop()
        if level.owns_variables:
            self.variables.pop()
        if level.saved is not None and level.saved.until_return:
            self.state = level.saved.restored_in(self.state)

    def count_block(self, line: int) -> None:
        """Counts a block that is about to be executed by itself, as `count_blocks` and `count_singly` do."""
        self.blocks += 1
        self.singly += 1
        if self.blocks > self.settings.limits.blocks or self.singly > self._singly_allowed:
            self.count_blocks(line, 0)
            self.count_singly(line, 0)

    def count_blocks(self, line: int, blocks: int) -> None:
        """Counts blocks that are about to be executed.

        Raises:
            GcodeError: beyond `Limits.blocks`.
        """
        self.blocks += blocks
        if self.blocks > self.settings.limits.blocks:
            self._run_away(line, f"more than {self.settings.limits.blocks} blocks were executed", "blocks")

    def count_singly(self, line: int, blocks: int) -> None:
        """Counts blocks that are about to be executed one by one.

        Raises:
            GcodeError: beyond `Limits.repeated` and the number of lines there are.
        """
        self.singly += blocks
        if self.singly <= self._singly_allowed:
            return
        programs = {id(level.program): level.program for level in self.levels}
        most = self.settings.limits.repeated
        self._singly_allowed = most + sum(program.text.count(b"\n") + 1 for program in programs.values())
        if self.singly > self._singly_allowed:
            self._run_away(line, f"more than {most} blocks were executed again and again", "repeated")

    def count_jump(self, place: Place) -> None:
        """Counts a jump back, so that an endless loop is found before it has run for long.

        Raises:
            GcodeError: beyond `Limits.jumps`, or `Limits.idle_jumps` while nothing moves.
        """
        self.jumps += 1
        limits = self.settings.limits
        if self.jumps > limits.jumps:
            self._run_away(place.line, f"more than {limits.jumps} jumps back were made", "jumps")
        if self.jumps - self.jumps_at_motion > limits.idle_jumps:
            problem = f"more than {limits.idle_jumps} jumps back were made without a motion"
            self._run_away(place.line, problem, "idle_jumps")

    def check_repeats(self, block: ParsedBlock, word: Word, count: int) -> None:
        """Refuses a repeat count that `Limits.jumps` does not allow, before anything is repeated.

        Raises:
            GcodeError: where the count exceeds the limit.
        """
        most = self.settings.limits.jumps
        if count > most:
            self.end()
            raise block.error(
                word, "runaway", f"{word.text} with {count} repeats", f"at most {most}, or a higher limits.jumps"
            )

    def _run_away(self, line: int, problem: str, limit: str) -> NoReturn:
        self.end()
        place = Place(file=self.level.program.file, line=line, calls=self.level.calls)
        raise GcodeError(place, "runaway", problem, f"a program that ends, or a higher limits.{limit}")
