"""One level of the call stack of a running program."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

from gcode.control.state import Modes
from gcode.errors import Call
from gcode.language.blocks import ParsedBlock
from gcode.language.program import BEGINNING, Program, Spot


@dataclass(slots=True, kw_only=True)
class Level:
    """Where a program, subprogram or macro stands. Changes as it runs.

    Attributes:
        program: its text.
        spot: the next line.
        name: what it is, e.g. ``O1000``; empty for the main program.
        calls: the calls that led here.
        start: where a repeat begins again.
        repeats: how often it is still to be run after this time.
        owns_variables: it has local variables of its own, which end with it.
        kind: ``main``, ``program`` (M98, M97), ``macro`` (G65) or ``routine`` (an O-word's sub).
        queue: blocks of the present line that are still to be run.
        loops: offsets of the WHILE or DO lines it is inside of.
        counts: how often O-word repeats are still to be run, by the offset of their line.
        arguments: of a macro, by number, for its repeats.
        modal: it was called by G66, so motions in it call nothing.
        saved: modes and machine state that M70 or M73 saved; with M73 they are restored on return.
        fresh: nothing of it has been run yet.
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
    saved: tuple[Modes, object, bool] | None = None
    fresh: bool = True

    def jump(self, spot: Spot) -> None:
        """Goes on at the line at `spot`, out of all loops that do not hold it."""
        self.queue.clear()
        self.spot = spot
        ends = self.program.loops
        self.loops = [at for at in self.loops if at in ends and at <= spot.offset <= ends[at].offset]
