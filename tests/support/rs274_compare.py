"""Comparing what this interpreter makes of a program with what ``rs274`` makes of it."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import replace
from pathlib import Path

from gcode.dialects import LINUXCNC
from gcode.events import PLANE_AXES, ArcMotion, Dwell, Event, LinearMotion
from gcode.flow.interpreter import interpret, interpret_file
from gcode.settings import MachineSettings
from gcode.tables import read_parameters, read_tool_table
from support.rs274 import ORIGIN, Kind, Move

#: Agreement of points beyond the rounding of the listing, mm, and of feeds and speeds, relative.
POINT_MM, RELATIVE = 0.001, 1e-3
#: Work offsets of LinuxCNC.
SYSTEMS = (*(f"G{n}" for n in range(54, 60)), "G59.1", "G59.2", "G59.3")


def settings_of(
    table: Path | None = None, parameters: Path | None = None, search_path: Path | None = None
) -> MachineSettings:
    """The machine that ``rs274`` is: at zero, tables in inches, millimetres until a program says otherwise."""
    settings = MachineSettings(
        offsets=dict.fromkeys(SYSTEMS, ORIGIN),
        machine_units="inch",
        reference_points_mm={2: ORIGIN},
        tools=read_tool_table(table, units="inch") if table else {},
        search_path=(search_path,) if search_path else (),
    )
    return read_parameters(parameters, units="inch").applied_to(settings) if parameters else settings


def moves_of_events(events: Iterable[Event]) -> list[Move]:
    """The motions and dwells among our events, as a listing of ``rs274`` shows them."""
    moves: list[Move] = []
    end, abc, tapping = ORIGIN, ORIGIN, False
    for event in events:
        if isinstance(event, LinearMotion):
            kind: Kind = "tap" if event.tapping else "rapid" if event.rapid else "feed"
            end, abc = event.end_mm, event.extra[:3]
            if kind == "tap" and tapping:  # the way out, which their one call has within it
                tapping = False
                continue
            tapping = kind == "tap"
            move = Move(kind=kind, end=end, abc=abc, feed=event.feed_mm_min)
        elif isinstance(event, ArcMotion):
            move, tapping = _arc(event), False
            end, abc = move.end, move.abc
        elif isinstance(event, Dwell):
            move = Move(kind="dwell", end=end, abc=abc, seconds=event.seconds)
        else:
            continue
        state = event.state
        moves.append(replace(move, tool=state.tool, rpm=state.spindle_rpm, direction=state.spindle_direction))
    return moves


def _arc(event: ArcMotion) -> Move:
    centre = list(event.centre_mm)
    centre[PLANE_AXES[event.plane][2]] = 0.0
    return Move(
        kind="arc",
        end=event.end_mm,
        abc=event.extra[:3],
        feed=event.feed_mm_min,
        plane=event.plane,
        centre=(centre[0], centre[1], centre[2]),
        turns=event.turns,
    )


def our_moves(program: Path, settings: MachineSettings) -> list[Move]:
    """What this interpreter makes of a program file.

    Raises:
        GcodeError: where it refuses the program.
    """
    return moves_of_events(interpret_file(program, dialect=LINUXCNC, settings=settings))


def our_moves_of_text(text: str, settings: MachineSettings) -> list[Move]:
    """The same of a program given as text."""
    return moves_of_events(interpret(text, dialect=LINUXCNC, settings=settings))


def lasting(moves: Sequence[Move]) -> list[Move]:
    """Without straight motions to where the tool is and dwells of no time."""
    kept: list[Move] = []
    end, abc = ORIGIN, ORIGIN
    for move in moves:
        stays = math.dist(move.end, end) <= POINT_MM + 2 * move.rounding and math.dist(move.abc, abc) < 1e-3
        still = (move.kind in ("rapid", "feed") and stays) or (move.kind == "dwell" and move.seconds == 0.0)
        if not still:
            kept.append(move)
        if move.kind not in ("dwell", "tap", "spline"):
            end, abc = move.end, move.abc
    return kept


def timed(moves: Iterable[Move]) -> list[Move]:
    """Without dwells of no time."""
    return [move for move in moves if move.kind != "dwell" or move.seconds > 0.0]


def first_difference(theirs: Sequence[Move], ours: Sequence[Move]) -> str:
    """Where two lists differ first, and how; empty where they agree."""
    for number, (their, our) in enumerate(zip(theirs, ours, strict=False), start=1):
        names = differing(their, our)
        if names:
            said = "; ".join(f"{n} {_said(getattr(their, n))}, ours {_said(getattr(our, n))}" for n in names)
            return f"move {number} of {len(theirs)} ({their.kind}): {said}"
    if len(theirs) != len(ours):
        longer = theirs if len(theirs) > len(ours) else ours
        extra = longer[min(len(theirs), len(ours))]
        return f"{len(theirs)} moves, ours {len(ours)}; the first more: {extra.kind} to {_said(extra.end)}"
    return ""


def differing(their: Move, our: Move) -> list[str]:
    """Names of the fields in which a move of theirs and one of ours do not agree."""
    allowed = POINT_MM + their.rounding
    names = [n for n in ("kind", "plane", "turns", "tool", "direction") if getattr(their, n) != getattr(our, n)]
    if their.kind != "spline":
        names += ["end"] if math.dist(their.end, our.end) > allowed else []
        names += ["abc"] if math.dist(their.abc, our.abc) > 1e-3 else []
    names += ["centre"] if math.dist(their.centre, our.centre) > allowed else []
    names += ["seconds"] if not _close(their.seconds, our.seconds) else []
    if their.rpm is not None:
        names += ["rpm"] if our.rpm is None or not _close(their.rpm, our.rpm) else []
        feed = their.feed * their.rpm if their.per_revolution else their.feed
        names += ["feed"] if our.kind != "rapid" and not _close(feed, our.feed) else []
    return names


def _close(their: float, our: float) -> bool:
    return math.isclose(their, our, rel_tol=RELATIVE, abs_tol=2e-3)


def _said(value: object) -> str:
    if isinstance(value, tuple):
        return "(" + ", ".join(f"{number:.4f}" for number in value) + ")"
    return f"{value:.4f}" if isinstance(value, float) else str(value)
