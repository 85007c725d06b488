"""Laws that hold for every canned cycle, whatever its words."""

from __future__ import annotations

from collections.abc import Callable

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from gcode.cycles import (
    FANUC_CYCLES,
    HAAS_CYCLES,
    LINUXCNC_CYCLES,
    CycleInput,
    CycleOutput,
    CycleRules,
    Move,
    Step,
    run_cycle,
)

CONTROLS = [FANUC_CYCLES, HAAS_CYCLES, LINUXCNC_CYCLES]
#: Cycles of which every control makes the bottom the deepest level, below R.
DOWNWARD = ["G73", "G74", "G81", "G82", "G83", "G84", "G85", "G86", "G89"]
CASES = [pytest.param(rules, code, id=f"{rules.name}-{code}") for rules in CONTROLS for code in DOWNWARD]


def every_cycle(law: Callable[..., None]) -> Callable[..., None]:
    """A law for each cycle of each control, with some thousand holes in all."""
    return pytest.mark.parametrize(("rules", "code"), CASES)(settings(max_examples=50)(law))


NEAR = 1e-9

#: Lengths of which sums and differences are exact, so that no law depends on rounding.
lengths = st.integers(-40_000, 40_000).map(lambda n: n / 1024.0)
sizes = st.integers(100, 20_000).map(lambda n: n / 1024.0)


@st.composite
def holes(draw: st.DrawFn) -> dict[str, float]:
    """A hole with R above the bottom, and the level where the tool stands."""
    r, depth = draw(lengths), draw(sizes)
    return {
        "X": draw(lengths),
        "Y": draw(lengths),
        "R": r,
        "Z": r - depth,
        "Q": draw(sizes),
        "from": r + draw(st.sampled_from([0.0, 0.5, 30.0])),
    }


def run(rules: CycleRules, code: str, hole: dict[str, float], *, absolute: bool = True, **more: bool) -> CycleOutput:
    cycle = rules.cycles[code]
    start = (1.0, 2.0, hole["from"])
    words = {"X": hole["X"], "Y": hole["Y"], "R": hole["R"], "Z": hole["Z"]}
    if not absolute:
        words = {"X": hole["X"] - 1.0, "Y": hole["Y"] - 2.0, "R": hole["R"] - hole["from"], "Z": hole["Z"] - hole["R"]}
    words |= {"Q": hole["Q"]} if cycle.pecks else {}
    words |= {"P": 1.0} if "P" in cycle.needs else {}
    direction = cycle.forward or 1
    return run_cycle(
        rules,
        CycleInput(
            code=code,
            words=words,
            position=start,
            initial_level=start[2],
            spindle_direction=direction,
            absolute=absolute,
            **more,
        ),
    )


def moves(steps: tuple[Step, ...]) -> list[Move]:
    return [step for step in steps if isinstance(step, Move)]


@every_cycle
@given(hole=holes(), return_to_r=st.booleans())
def test_laws_of_a_hole(rules: CycleRules, code: str, hole: dict[str, float], return_to_r: bool) -> None:
    done = run(rules, code, hole, return_to_r=return_to_r)
    ends_over_the_hole_at_r_or_the_initial_level(done, hole, return_to_r)
    no_rapid_motion_goes_where_nothing_was_drilled(done, hole)
    in_the_plane_it_moves_only_at_rapid_and_above_r(done, hole)
    one_hole_is_the_same_with_g90_and_g91(done, run(rules, code, hole, return_to_r=return_to_r, absolute=False))
    if rules.cycles[code].repeats:
        a_repeat_is_the_same_as_two_blocks(rules, code, hole)


def ends_over_the_hole_at_r_or_the_initial_level(done: CycleOutput, hole: dict[str, float], return_to_r: bool) -> None:
    level = hole["R"] if return_to_r else hole["from"]
    assert moves(done.steps)[-1].end == done.position == (hole["X"], hole["Y"], level)


def no_rapid_motion_goes_where_nothing_was_drilled(done: CycleOutput, hole: dict[str, float]) -> None:
    drilled = hole["R"]
    for move in moves(done.steps):
        if move.rapid:
            assert move.normal >= drilled - NEAR
        else:
            drilled = min(drilled, move.normal)
    assert drilled == hole["Z"]


def in_the_plane_it_moves_only_at_rapid_and_above_r(done: CycleOutput, hole: dict[str, float]) -> None:
    at = (1.0, 2.0, hole["from"])
    for move in moves(done.steps):
        if move.end[:2] != at[:2]:
            assert move.rapid
            assert min(at[2], move.normal) >= hole["R"]
        at = move.end


def one_hole_is_the_same_with_g90_and_g91(absolute: CycleOutput, incremental: CycleOutput) -> None:
    assert absolute.steps == incremental.steps
    assert absolute.position == incremental.position


def a_repeat_is_the_same_as_two_blocks(rules: CycleRules, code: str, hole: dict[str, float]) -> None:
    """With G91 a block with a repeat of 2 does what two blocks do."""
    start, cycle = (1.0, 2.0, hole["from"]), rules.cycles[code]
    words = {"X": 3.0, "R": hole["R"] - hole["from"], "Z": hole["Z"] - hole["R"]}
    words |= {"Q": hole["Q"]} if cycle.pecks else {}
    words |= {"P": 1.0} if "P" in cycle.needs else {}
    fields = {"absolute": False, "initial_level": start[2], "spindle_direction": cycle.forward or 1}
    both = run_cycle(rules, CycleInput(code=code, words={**words, "L": 2.0}, position=start, **fields))
    one = run_cycle(rules, CycleInput(code=code, words=words, position=start, **fields))
    again = CycleInput(
        code=code, words={"X": 3.0}, position=one.position, sticky=one.sticky, first_of_mode=False, **fields
    )
    two = run_cycle(rules, again)
    assert both.steps == one.steps + two.steps
    assert both.position == two.position
