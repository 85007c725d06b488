"""Steps that each act of a cycle makes with the tool over one hole."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from types import MappingProxyType

from gcode.cycles.hole import Hole
from gcode.cycles.rules import Act, Cycle, CycleRules
from gcode.cycles.steps import Move, OperatorStop, Orient, Pause, Position, Spindle, Step


class Tool:
    """A tool at work on a block's holes, and the steps it has made.

    Args:
        rules: the control.
        cycle: the cycle.
        hole: the levels, the same for all holes of a block.
        axes: letters of the plane's axes and of its normal.
        at: its position in coordinates of the plane.
        spindle: direction in which the spindle turned before the cycle.
        rigid: the cycle starts and stops the spindle itself.
    """

    def __init__(
        self,
        rules: CycleRules,
        cycle: Cycle,
        hole: Hole,
        *,
        axes: tuple[str, str, str],
        at: Position,
        spindle: int,
        rigid: bool,
    ) -> None:
        self.rules = rules
        self.cycle = cycle
        self.hole = hole
        self.axes = axes
        self.at = at
        self.spindle = spindle
        self.rigid = rigid
        self.centre = at[:2]
        self.steps: list[Step] = []

    def go(self, to: Position, *, rapid: bool, tapping: bool = False) -> None:
        """Moves to a point; where the tool is there already, only if the control commands such motions."""
        if self.rules.empty_moves or to != self.at:
            self.steps.append(Move(*to, rapid=rapid, tapping=tapping))
        self.at = to

    def along(self, level: float, *, rapid: bool) -> None:
        """Moves along the normal."""
        self.go((self.at[0], self.at[1], level), rapid=rapid)

    def tap(self, level: float) -> None:
        """A stroke of a tap over the hole's axis."""
        to = (*self.centre, level)
        order = self.rules.tap_order.get(self.axes[2], (0, 1, 2))
        self.go((to[order[0]], to[order[1]], to[order[2]]), rapid=False, tapping=True)

    def back_from(self, depth: float, distance: float) -> float:
        """Level that far back from a depth, not beyond R where the control keeps to that."""
        r = self.hole.r
        if self.rules.reentry_within_r and distance > abs(r - depth):
            return r
        return depth + distance if r >= depth else depth - distance

    @property
    def cleared(self) -> float:
        """Level to which a peck is retracted out of the hole."""
        up = 1.0 if self.hole.r >= self.hole.bottom else -1.0
        return self.hole.r + up * self.rules.above_r_mm

    def work(self) -> None:
        """Carries out the acts of the cycle at the present position."""
        for act in self.cycle.acts:
            _DOES[act](self)


def _peck(tool: Tool) -> None:
    for depth in tool.hole.depths:
        tool.along(depth, rapid=False)
        tool.along(tool.cleared, rapid=True)
        tool.along(tool.back_from(depth, tool.rules.reentry_mm), rapid=True)
    tool.along(tool.hole.bottom, rapid=False)


def _chip_break(tool: Tool) -> None:
    every, cleared_at = tool.hole.cleared_every, tool.hole.r
    for depth in tool.hole.depths:
        tool.along(depth, rapid=False)
        if every is not None and abs(cleared_at - depth) >= every - tool.rules.peck_tolerance_mm:
            tool.along(tool.cleared, rapid=True)
            cleared_at = depth
        tool.along(tool.back_from(depth, tool.rules.retract_mm), rapid=True)
    tool.along(tool.hole.bottom, rapid=False)


def _shift(tool: Tool) -> None:
    (first, second), (by_first, by_second) = tool.centre, tool.hole.shift
    tool.go((first + by_first, second + by_second, tool.at[2]), rapid=True)


def _unshift(tool: Tool) -> None:
    tool.go((*tool.centre, tool.at[2]), rapid=True)


def _dwell(tool: Tool) -> None:
    if tool.hole.dwell_s > 0.0:
        tool.steps.append(Pause(tool.hole.dwell_s))


def _restart(tool: Tool) -> None:
    direction = tool.spindle if tool.rules.restart is None else tool.rules.restart
    tool.steps.append(Spindle(direction))


def _tap_start(tool: Tool) -> None:
    if tool.rigid:
        tool.steps.append(Spindle(tool.cycle.forward))


def _tap_end(tool: Tool) -> None:
    tool.steps.append(Spindle(0 if tool.rigid else tool.cycle.forward))


_DOES: Mapping[Act, Callable[[Tool], None]] = MappingProxyType(
    {
        Act.FEED_BOTTOM: lambda tool: tool.along(tool.hole.bottom, rapid=False),
        Act.FEED_R: lambda tool: tool.along(tool.hole.r, rapid=False),
        Act.FEED_CLEAR: lambda tool: tool.along(tool.hole.clear, rapid=False),
        Act.FEED_TOP: lambda tool: tool.along(tool.hole.top, rapid=False),
        Act.RAPID_R: lambda tool: tool.along(tool.hole.r, rapid=True),
        Act.RAPID_BOTTOM: lambda tool: tool.along(tool.hole.bottom, rapid=True),
        Act.RAPID_CLEAR: lambda tool: tool.along(tool.hole.clear, rapid=True),
        Act.PECK: _peck,
        Act.CHIP_BREAK: _chip_break,
        Act.SHIFT: _shift,
        Act.UNSHIFT: _unshift,
        Act.DWELL: _dwell,
        Act.STOP: lambda tool: tool.steps.append(Spindle(0)),
        Act.RESTART: _restart,
        Act.ORIENT: lambda tool: tool.steps.append(Orient()),
        Act.OPERATOR: lambda tool: tool.steps.append(OperatorStop()),
        Act.TAP_START: _tap_start,
        Act.TAP_REVERSE: lambda tool: tool.steps.append(Spindle(-tool.cycle.forward)),
        Act.TAP_END: _tap_end,
        Act.TAP_BOTTOM: lambda tool: tool.tap(tool.hole.bottom),
        Act.TAP_R: lambda tool: tool.tap(tool.hole.r),
        Act.TAP_CLEAR: lambda tool: tool.tap(tool.hole.clear),
    }
)
