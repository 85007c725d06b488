"""One level of the call stack of a running program."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace

from gcode.control.state import Modes, State
from gcode.errors import Call
from gcode.events import MotionState
from gcode.language.blocks import ParsedBlock
from gcode.language.program import BEGINNING, Program, Spot

#: Fields of the modal state that M70 saves.
_SAVED_MODES = ("absolute", "unit_mm", "absolute_centres", "feed", "return_to_r", "diameter", "motion", "base_motion")
_SAVED_MACHINE = ("plane", "feed_mode", "spindle_rpm")


@dataclass(frozen=True, slots=True, kw_only=True)
class SavedModes:
    """Modes and machine state that M70 or M73 saved.

    Attributes:
        modes: modal values.
        machine: the modal values that motions carry.
        until_return: saved by M73, so they are restored when the subroutine returns.
    """

    modes: Modes
    machine: MotionState
    until_return: bool

    def restored_in(self, state: State) -> State:
        """The state with the modes that were saved."""
        modes, machine = self.modes, self.machine
        state = replace(
            state,
            modes=replace(state.modes, **{name: getattr(modes, name) for name in _SAVED_MODES}),
            machine=replace(state.machine, **{name: getattr(machine, name) for name in _SAVED_MACHINE}),
        )
        return state.reframed()


@dataclass(slots=True, kw_only=True)
class Level:
    """A program, subprogram or macro that is being run, and how far it has come. Changes as it runs.

    Attributes:
        program: its text.
        spot: the next line.
        name: its name, e.g. ``O1000``; empty for the main program.
        calls: the calls that led here.
        start: where a repeat begins again.
        repeats: how often it is still to be run after this time.
        owns_variables: it has local variables of its own, which end with it.
        kind: ``main``, ``program`` (M98, M97), ``macro`` (G65) or ``routine`` (the sub of an O-word).
        queue: blocks of the present line that are still to be run.
        loops: offsets of the WHILE or DO lines it is inside of.
        counts: how often O-word repeats are still to be run, by the offset of their line.
        arguments: of a macro, by number, for its repeats.
        modal: it was called by G66, so motions in it call nothing.
        saved: modes that M70 or M73 saved, None for none.
        fresh: nothing of it has been run yet.
        placed: its parsed lines with its calls in their places, by offset; some of them, for lines that are repeated.
    """

    program: Program
    spot: Spot
    name: str = ""
    calls: tuple[Call, ...] = ()
    start: Spot = BEGINNING
    repeats: int = 0
    owns_variables: bool = False
    kind: str = "main"
    queue: list[ParsedBlock] = field(default_factory=list)
    loops: list[int] = field(default_factory=list)
    counts: dict[int, int] = field(default_factory=dict)
    arguments: Mapping[int, float] = field(default_factory=dict)
    modal: bool = False
    saved: SavedModes | None = None
    fresh: bool = True
    placed: dict[int, tuple[ParsedBlock, ...]] = field(default_factory=dict)

    def jump(self, spot: Spot) -> None:
        """Continues at the line at `spot`, out of all loops that do not hold it."""
        self.queue.clear()
        self.spot = spot
        ends = self.program.loops
        self.loops = [at for at in self.loops if at in ends and at <= spot.offset <= ends[at].offset]

    def begin_again(self) -> None:
        """Starts the next of its repeats."""
        self.repeats -= 1
        self.queue.clear()
        self.loops.clear()
        self.counts.clear()
        self.spot = self.start
        self.fresh = True
