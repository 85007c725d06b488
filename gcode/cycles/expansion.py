"""One block in a cycle mode: from its words to the steps of all its holes."""

from __future__ import annotations

from gcode.cycles.errors import CycleError
from gcode.cycles.hole import MOST_STEPS, Hole, hole_of
from gcode.cycles.interface import CycleInput, CycleOutput
from gcode.cycles.rules import Act, Cycle, CycleRules
from gcode.cycles.steps import Position
from gcode.cycles.strokes import Tool
from gcode.cycles.words import check_needed, has_axis, read_words

_SPINDLE = {-1: "counter-clockwise (M4)", 0: "not at all (M5)", 1: "clockwise (M3)"}
#: Levels closer than this, in the program's unit, are one level: rounding errors cause no motion.
SAME_LEVEL = 1e-9
_FEEDS = frozenset({Act.FEED_BOTTOM, Act.PECK, Act.CHIP_BREAK, Act.TAP_BOTTOM})


def run_cycle(rules: CycleRules, call: CycleInput) -> CycleOutput:
    """Runs one block in a cycle mode. A pure function.

    Args:
        rules: the control.
        call: the block and what it is run on.

    Returns:
        The steps of all holes, what to keep for the next block, and where the control then believes the tool to be.

    Raises:
        CycleError: for a cycle that the control has not, words that are wrong or missing, levels and pecks that
            make no hole, a tap or a boring bar whose spindle does not turn as it must, or a missing feed.
    """
    cycle = _cycle(rules, call.code)
    if rules.needs_axis and not has_axis(call):
        problem = f"{cycle.code} ({cycle.meaning}) is in a block without an axis word"
        raise CycleError("cycle-missing-word", problem, " or ".join(call.axes))
    words = read_words(rules, cycle, call)
    if not has_axis(call) and "R" not in call.words:
        kept = {} if call.first_of_mode else call.sticky
        return CycleOutput(sticky=kept, steps=(), position=call.position)
    if words.repeats == 0:
        return CycleOutput(sticky=words.sticky, steps=(), position=call.position)
    check_needed(rules, cycle, call, words.data)
    _check_machine(rules, cycle, call)
    hole = hole_of(rules, cycle, call, words.data)
    _check_length(rules, call, hole, words.repeats)
    tool = _tool(rules, cycle, call, hole)
    end = (_lifting if rules.lift_first else _direct)(tool, call, words.repeats)
    return CycleOutput(sticky=words.sticky, steps=tuple(tool.steps), position=end)


def _cycle(rules: CycleRules, code: str) -> Cycle:
    if code in rules.cycles:
        return rules.cycles[code]
    if code in rules.absent:
        problem = f"{code} is {rules.absent[code]} on {rules.name}, not a hole-making cycle"
        raise CycleError("cycle-unsupported", problem, f"one of {', '.join(rules.cycles)}")
    raise CycleError("cycle-unsupported", f"{rules.name} has no cycle {code}", f"one of {', '.join(rules.cycles)}")


def _check_machine(rules: CycleRules, cycle: Cycle, call: CycleInput) -> None:
    if not call.feed_known and not _FEEDS.isdisjoint(cycle.acts):
        raise CycleError("missing-feed", f"{cycle.code} before any feed", "F", "F")
    if call.spindle_direction not in cycle.spindle:
        turns = _SPINDLE[call.spindle_direction]
        wanted = " or ".join(_SPINDLE[direction] for direction in reversed(cycle.spindle))
        problem = f"the spindle turns {turns} at {cycle.code} ({cycle.meaning}), which {rules.name} refuses"
        raise CycleError("cycle-spindle", problem, f"it to turn {wanted}")


def _check_length(rules: CycleRules, call: CycleInput, hole: Hole, repeats: int) -> None:
    if repeats * (3 * len(hole.depths) + 16) > MOST_STEPS:
        letter = next((letter for letter in rules.repeat_letters if letter in call.words), "Q")
        problem = f"{repeats} holes of {len(hole.depths) + 1} pecks each are more than one block may make"
        raise CycleError("cycle-repeat", problem, f"no more than {MOST_STEPS} steps", letter)


def _tool(rules: CycleRules, cycle: Cycle, call: CycleInput, hole: Hole) -> Tool:
    """The tool before the first hole. A tap that begins with the spindle stopped can only be rigid."""
    rigid = cycle.forward != 0 and (call.rigid or rules.always_rigid or call.spindle_direction == 0)
    return Tool(rules, cycle, hole, axes=call.axes, at=call.position, spindle=call.spindle_direction, rigid=rigid)


def _centre(call: CycleInput, number: int) -> tuple[float, float]:
    """Where the hole of that number, counted from 1, is: with G91 each is one increment further."""
    first, second = call.axes[:2]
    if call.absolute:
        return (call.words.get(first, call.position[0]), call.words.get(second, call.position[1]))
    return (
        call.position[0] + number * call.words.get(first, 0.0),
        call.position[1] + number * call.words.get(second, 0.0),
    )


def _direct(tool: Tool, call: CycleInput, repeats: int) -> Position:
    """In the plane at the level where the tool is, along the normal to R, down the hole and back."""
    for number in range(1, repeats + 1):
        tool.centre = _centre(call, number)
        tool.go((*tool.centre, tool.at[2]), rapid=True)
        if tool.cycle.approach:
            tool.along(tool.hole.r, rapid=True)
        tool.work()
    return tool.at


def _lifting(tool: Tool, call: CycleInput, repeats: int) -> Position:
    """Retracts to R first where the initial level is below it; the control then continues from its own position."""
    r, clear = tool.hole.r, tool.hole.clear
    level = call.position[2]
    if call.initial_level < r - SAME_LEVEL:
        level = r
        tool.go((call.position[0], call.position[1], r), rapid=True)
    for number in range(1, repeats + 1):
        tool.centre = _centre(call, number)
        above = level if number == 1 and level > r + SAME_LEVEL else clear
        tool.go((*tool.centre, above), rapid=True)
        if above > r + SAME_LEVEL:
            tool.along(r, rapid=True)
        tool.work()
    return (*tool.centre, clear)
