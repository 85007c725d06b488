"""Canned cycles of Haas mills where they differ from FANUC's, each after the mill operator's manual."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import pytest

from gcode.cycles import FANUC_CYCLES, HAAS_CYCLES, CycleError, CycleInput, CycleOutput, CycleRules, Move, run_cycle
from gcode.cycles.steps import OperatorStop, Pause, Spindle, Step

RULES = replace(HAAS_CYCLES, retract_mm=1.0, reentry_mm=1.0)


def block(code: str, rules: CycleRules = RULES, **call: Any) -> CycleOutput:
    words = {"X": 5.0, **{key: float(value) for key, value in call.items() if len(key) == 1}}
    fields = {key: value for key, value in call.items() if len(key) > 1}
    defaults = {"position": (0.0, 0.0, 10.0), "initial_level": 10.0, "spindle_direction": 1, **fields}
    return run_cycle(rules, CycleInput(code=code, words=words, **defaults))


def levels(steps: tuple[Step, ...], *, rapid: bool) -> list[float]:
    return [step.normal for step in steps if isinstance(step, Move) and step.rapid is rapid]


def test_pecks_by_i_j_k_shrink_down_to_the_smallest() -> None:
    """I is the first, each is less by J, none is less than K."""
    for code in ("G73", "G83"):
        feeds = levels(block(code, R=0, Z=-20, I=6, J=2, K=3).steps, rapid=False)
        assert feeds == [-6, -10, -13, -16, -19, -20]


def test_g73_with_k_and_q_clears_the_hole_after_every_k() -> None:
    """Back by setting 22 after every Q, out to R when the pecks add up to K."""
    rapids = levels(block("G73", R=0, Z=-9, Q=2, K=4).steps, rapid=True)
    assert rapids == [10, 0, -1, 0, -3, -5, 0, -7, 10]


def test_g83_clears_above_r_by_setting_52() -> None:
    rules = replace(RULES, above_r_mm=1.5)
    assert levels(block("G83", rules, R=0, Z=-4, Q=2).steps, rapid=True) == [10, 0, 1.5, -1, 10]


def test_p_is_milliseconds_without_a_point_and_seconds_with_one() -> None:
    assert Pause(0.5) in block("G82", R=0, Z=-4, P=500).steps
    assert Pause(0.5) in block("G82", R=0, Z=-4, P=0.5, pointed=frozenset("P")).steps


@pytest.mark.parametrize("code", ["G73", "G83"])
def test_pecks_end_with_the_dwell(code: str) -> None:
    steps = block(code, R=0, Z=-4, Q=2, P=500).steps
    assert steps[-2:] == (Pause(0.5), Move(5, 0, 10, rapid=True))
    assert sum(isinstance(step, Pause) for step in steps) == 1


def test_tapping_starts_and_stops_the_spindle_itself() -> None:
    turns = [step for step in block("G74", R=0, Z=-4).steps if isinstance(step, Spindle)]
    assert turns == [Spindle(-1), Spindle(1), Spindle(0)]


def test_g76_shifts_by_i_and_j_where_no_q_is_given() -> None:
    steps = block("G76", R=0, Z=-4, I=0.3, J=-0.4).steps
    assert Move(5.3, -0.4, -4, rapid=True) in steps
    assert Move(5.2, 0, -4, rapid=True) in block("G76", R=0, Z=-4, Q=0.2).steps


def test_g87_stops_at_the_bottom_for_the_operator() -> None:
    assert block("G87", R=0, Z=-4, return_to_r=True).steps[2:] == (
        *(Move(5, 0, -4, rapid=False), Spindle(0), OperatorStop()),
        *(Move(5, 0, 0, rapid=True), Spindle(1)),
    )


def test_a_peck_by_q_replaces_one_by_i_j_k() -> None:
    first = block("G83", R=0, Z=-9, I=6, J=2, K=3)
    second = block("G83", Q=4, sticky=first.sticky, position=first.position, first_of_mode=False)
    assert levels(second.steps, rapid=False) == [-4, -8, -9]


def test_l_repeats_and_k_is_a_peck() -> None:
    assert len(levels(block("G81", R=0, Z=-4, L=3).steps, rapid=False)) == 3
    assert block("G81", R=0, Z=-4, L=0).steps == ()


@pytest.mark.parametrize("code", ["G81", "G82", "G85", "G86", "G89"])
def test_the_other_cycles_are_fanucs(code: str) -> None:
    assert block(code, R=0, Z=-4).steps == block(code, FANUC_CYCLES, R=0, Z=-4).steps


@pytest.mark.parametrize(
    ("code", "words", "refusal", "letter"),
    [
        ("G81", {"K": 2}, "cycle-word", "K"),
        ("G84", {"J": 2}, "cycle-unsupported", "J"),
        ("G83", {}, "cycle-missing-word", "Q"),
        ("G76", {}, "cycle-missing-word", "Q"),
        ("G83", {"I": 6, "J": 2}, "cycle-peck", "I"),
        ("G83", {"I": -6}, "cycle-peck", "I"),
        ("G83", {"I": 6, "J": -1, "K": 1}, "cycle-peck", "I"),
    ],
)
def test_refused(code: str, words: dict[str, float], refusal: str, letter: str) -> None:
    with pytest.raises(CycleError) as error:
        block(code, R=0, Z=-4, **words)
    assert (error.value.code, error.value.letter) == (refusal, letter)
