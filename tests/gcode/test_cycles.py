"""FANUC's canned cycles, each against its figure in the operator's manual ("Canned cycle for drilling").

Steps are written short: ``F`` feed, ``R`` rapid, ``T`` stroke of a tap, each with first, second and normal coordinate.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import pytest

from gcode.cycles import (
    FANUC_CYCLES,
    LINUXCNC_CYCLES,
    CycleError,
    CycleInput,
    CycleOutput,
    CycleRules,
    Move,
    OperatorStop,
    Orient,
    Pause,
    Spindle,
    Step,
    run_cycle,
)

CW, CCW, STOP = Spindle(1), Spindle(-1), Spindle(0)


def R(*to: float) -> Move:
    return Move(*to, rapid=True)


def F(*to: float) -> Move:  # noqa: N802
    return Move(*to, rapid=False)


def T(*to: float) -> Move:  # noqa: N802
    return Move(*to, rapid=False, tapping=True)


def block(code: str, rules: CycleRules = FANUC_CYCLES, **call: Any) -> CycleOutput:
    """A block from (0, 0, 10) with the spindle on; words are capital letters, everything else a field."""
    words = {key: float(value) for key, value in call.items() if len(key) == 1}
    fields = {key: value for key, value in call.items() if len(key) > 1}
    defaults = {"position": (0.0, 0.0, 10.0), "initial_level": 10.0, "spindle_direction": 1, **fields}
    return run_cycle(rules, CycleInput(code=code, words=words, **defaults))


def after(done: CycleOutput, code: str, rules: CycleRules = FANUC_CYCLES, **call: Any) -> CycleOutput:
    """The next block of the same cycle mode."""
    return block(code, rules, position=done.position, sticky=done.sticky, first_of_mode=False, **call)


HOLE = {"X": 5, "Y": 6, "Z": -3, "R": 2}
OVER, AT_R = R(5, 6, 10), R(5, 6, 2)

#: Figures with G98: positioned in the plane at the initial level, rapid to R, the cycle's own, back to the initial
#: level.
FIGURES: list[tuple[str, dict[str, Any], list[Step]]] = [
    ("G81", {}, [F(5, 6, -3), R(5, 6, 10)]),
    ("G82", {"P": 500}, [F(5, 6, -3), Pause(0.5), R(5, 6, 10)]),
    ("G73", {"Q": 2}, [F(5, 6, 0), R(5, 6, 1), F(5, 6, -2), R(5, 6, -1), F(5, 6, -3), R(5, 6, 10)]),
    ("G83", {"Q": 2}, [F(5, 6, 0), R(5, 6, 2), R(5, 6, 1), F(5, 6, -2), R(5, 6, 2), R(5, 6, -1), F(5, 6, -3), OVER]),
    ("G84", {"P": 300}, [T(5, 6, -3), Pause(0.3), CCW, T(5, 6, 2), Pause(0.3), CW, OVER]),
    ("G74", {"P": 300}, [T(5, 6, -3), Pause(0.3), CW, T(5, 6, 2), Pause(0.3), CCW, OVER]),
    (
        "G76",
        {"Q": 0.5, "P": 100},
        [F(5, 6, -3), Pause(0.1), Orient(), R(5.5, 6, -3), R(5.5, 6, 10), R(5, 6, 10), CW],
    ),
    ("G85", {}, [F(5, 6, -3), F(5, 6, 2), OVER]),
    ("G86", {}, [F(5, 6, -3), STOP, OVER, CW]),
    ("G88", {"P": 200}, [F(5, 6, -3), Pause(0.2), STOP, OperatorStop(), R(5, 6, 2), CW, OVER]),
    ("G89", {"P": 200}, [F(5, 6, -3), Pause(0.2), F(5, 6, 2), OVER]),
]


@pytest.mark.parametrize(("code", "words", "steps"), FIGURES, ids=[figure[0] for figure in FIGURES])
def test_figure_with_return_to_the_initial_level(code: str, words: dict[str, Any], steps: list[Step]) -> None:
    done = block(code, **HOLE, **words)
    assert list(done.steps) == [OVER, AT_R, *steps]
    assert done.position == (5, 6, 10)


@pytest.mark.parametrize(("code", "words", "steps"), FIGURES, ids=[figure[0] for figure in FIGURES])
def test_with_g99_the_tool_stays_at_r(code: str, words: dict[str, Any], steps: list[Step]) -> None:
    done = block(code, **HOLE, **words, return_to_r=True)
    assert done.position == (5, 6, 2)
    levels = [step.normal for step in done.steps if isinstance(step, Move)][1:]
    assert max(levels) == 2


def test_g76_with_g99_shifts_back_at_r() -> None:
    steps = block("G76", **HOLE, Q=0.5, return_to_r=True).steps
    assert list(steps) == [OVER, AT_R, F(5, 6, -3), Orient(), R(5.5, 6, -3), R(5.5, 6, 2), R(5, 6, 2), CW]


@pytest.mark.parametrize("return_to_r", [False, True])
def test_figure_of_g87_goes_in_and_out_beside_the_axis(return_to_r: bool) -> None:
    """Its figure with G99 reads "not used", so it returns to the initial level whatever holds; R is the lower end."""
    done = block("G87", X=5, Y=6, R=-20, Z=-12, Q=3, P=400, return_to_r=return_to_r)
    assert list(done.steps) == [
        *(OVER, Orient(), R(8, 6, 10), R(8, 6, -20), R(5, 6, -20), CW),
        *(F(5, 6, -12), Pause(0.4), Orient(), R(8, 6, -12), R(8, 6, 10), R(5, 6, 10), CW),
    ]


def test_the_shift_goes_in_the_direction_of_the_parameter() -> None:
    rules = replace(FANUC_CYCLES, shift_direction=(0.0, -1.0))
    assert R(5, 5.5, -3) in block("G76", rules, **HOLE, Q=0.5).steps


def test_g83_comes_back_to_the_clearance_of_the_parameter_and_never_above_r() -> None:
    near = replace(FANUC_CYCLES, reentry_mm=0.25)
    assert R(5, 6, 0.25) in block("G83", near, **HOLE, Q=2).steps
    far = replace(FANUC_CYCLES, reentry_mm=50.0, retract_mm=50.0)
    for code in ("G73", "G83"):
        assert max(step.normal for step in block(code, far, **HOLE, Q=2).steps[1:-1]) == 2


@pytest.mark.parametrize("code", ["G73", "G83"])
def test_the_sign_of_q_is_ignored(code: str) -> None:
    assert block(code, **HOLE, Q=-2).steps == block(code, **HOLE, Q=2).steps


def test_the_last_peck_takes_what_is_left() -> None:
    feeds = [step.normal for step in block("G83", Z=-3, R=2, Q=2.5).steps if not step.rapid]
    assert feeds == [-0.5, -3]


def test_rigid_tapping_starts_and_stops_the_spindle() -> None:
    steps = block("G84", **HOLE, rigid=True, spindle_direction=0).steps
    assert list(steps) == [OVER, AT_R, CW, T(5, 6, -3), CCW, T(5, 6, 2), STOP, OVER]


def test_a_tap_whose_spindle_stands_still_can_only_be_rigid() -> None:
    assert block("G74", **HOLE, spindle_direction=0).steps == block("G74", **HOLE, rigid=True).steps


@pytest.mark.parametrize("letter", ["K", "L"])
def test_repeats_with_g91_make_a_row(letter: str) -> None:
    """R is counted from the initial level, Z from R."""
    done = block("G81", X=4, R=-8, Z=-5, absolute=False, return_to_r=True, **{letter: 3})
    expected: list[Step] = [R(4, 0, 10), R(4, 0, 2), F(4, 0, -3), R(4, 0, 2)]
    for x in (8, 12):
        expected += [R(x, 0, 2), F(x, 0, -3), R(x, 0, 2)]
    assert list(done.steps) == expected
    assert done.position == (12, 0, 2)


def test_repeats_with_g90_drill_the_same_hole() -> None:
    steps = block("G81", **HOLE, K=2).steps
    assert list(steps) == [OVER, AT_R, F(5, 6, -3), OVER, AT_R, F(5, 6, -3), OVER]


def test_k0_stores_the_words_and_drills_nothing() -> None:
    stored = block("G82", Z=-3, R=2, P=250, K=0)
    assert (stored.steps, stored.position) == ((), (0, 0, 10))
    assert after(stored, "G82", X=5, Y=6).steps == block("G82", **HOLE, P=250).steps


@pytest.mark.parametrize("words", [{}, {"P": 500}, {"Q": 1, "P": 100}, {"K": 4}])
def test_a_block_without_axis_or_r_drills_and_stores_nothing(words: dict[str, Any]) -> None:
    first = block("G82", **HOLE)
    nothing = after(first, "G82", **words)
    assert (nothing.steps, nothing.sticky, nothing.position) == ((), first.sticky, first.position)


def test_r_alone_drills() -> None:
    first = block("G81", **HOLE)
    assert list(after(first, "G81", R=1).steps) == [R(5, 6, 1), F(5, 6, -3), R(5, 6, 10)]


def test_words_hold_for_the_next_cycle_until_the_mode_is_left() -> None:
    first = block("G82", **HOLE, P=500, Q=2)
    pecks = after(first, "G83", X=5)
    assert pecks.steps == block("G83", position=(5, 6, 10), Z=-3, R=2, Q=2).steps
    with pytest.raises(CycleError) as error:
        block("G83", sticky=pecks.sticky, X=5)
    assert (error.value.code, error.value.letter) == ("cycle-missing-word", "Z")


def test_levels_given_with_g90_stay_where_they_are_under_g91() -> None:
    """The usual row of holes: R and Z with G90 at the first, then G91 and K for the rest."""
    first = block("G81", **HOLE, return_to_r=True)
    row = after(first, "G81", X=4, K=2, absolute=False, return_to_r=True)
    assert list(row.steps) == [R(9, 6, 2), F(9, 6, -3), R(9, 6, 2), R(13, 6, 2), F(13, 6, -3), R(13, 6, 2)]


def test_levels_given_with_g91_stay_where_they_are_under_g90() -> None:
    first = block("G81", X=5, Y=6, R=-8, Z=-5, absolute=False)
    assert list(after(first, "G81", X=9).steps) == [R(9, 6, 10), R(9, 6, 2), F(9, 6, -3), R(9, 6, 10)]


def test_with_g98_each_hole_returns_to_the_level_before_the_mode() -> None:
    first = block("G81", **HOLE, return_to_r=True)
    assert after(first, "G81", X=9).position == (9, 6, 10)


def test_a_tool_below_r_is_positioned_where_it_is_and_then_goes_up() -> None:
    """Operation 1 positions in the plane, operation 2 goes to R, whether that is below the tool or above."""
    steps = block("G81", X=5, Y=6, R=12, Z=-3).steps
    assert list(steps) == [OVER, R(5, 6, 12), F(5, 6, -3), R(5, 6, 10)]


def test_without_r_the_hole_begins_at_the_initial_level() -> None:
    """After G80 point R is 0 as an incremental command, which is the initial level."""
    assert list(block("G81", X=5, Y=6, Z=-3).steps) == [OVER, F(5, 6, -3), OVER]


@pytest.mark.parametrize(("axes", "words"), [("ZXY", {"Z": 5, "X": 6, "Y": -3}), ("YZX", {"Y": 5, "Z": 6, "X": -3})])
def test_the_drilling_axis_is_the_normal_of_the_plane(axes: str, words: dict[str, Any]) -> None:
    for code, more in (("G83", {"Q": 2}), ("G84", {}), ("G76", {"Q": 1})):
        turned = block(code, axes=tuple(axes), R=2, **words, **more)
        assert turned.steps == block(code, **HOLE, **more).steps


def test_a_hole_is_drilled_upwards_where_r_lies_below() -> None:
    steps = block("G83", X=5, Y=6, R=12, Z=17, Q=2, return_to_r=True).steps
    assert list(steps) == [
        *(OVER, R(5, 6, 12), F(5, 6, 14), R(5, 6, 12), R(5, 6, 13)),
        *(F(5, 6, 16), R(5, 6, 12), R(5, 6, 15), F(5, 6, 17), R(5, 6, 12)),
    ]


REFUSALS: list[tuple[str, dict[str, Any], str, str | None]] = [
    ("G81", {"X": 1, "R": 2}, "cycle-missing-word", "Z"),
    ("G73", {"X": 1, "Z": -3, "R": 2}, "cycle-missing-word", "Q"),
    ("G83", {"X": 1, "Z": -3, "R": 2}, "cycle-missing-word", "Q"),
    ("G83", {"X": 1, "Z": -3, "R": 2, "Q": 0}, "cycle-peck", "Q"),
    ("G83", {"X": 1, "Z": -3, "R": 2, "Q": 1e-6}, "cycle-peck", "Q"),
    ("G76", {"X": 1, "Z": -3, "R": 2}, "cycle-missing-word", "Q"),
    ("G87", {"X": 1, "Z": -3, "R": -9}, "cycle-missing-word", "Q"),
    ("G82", {"X": 1, "Z": -3, "R": 2, "P": 0.5}, "cycle-dwell", "P"),
    ("G82", {"X": 1, "Z": -3, "R": 2, "P": -5}, "cycle-dwell", "P"),
    ("G81", {"X": 1, "Z": -3, "R": 2, "K": 1.5}, "cycle-repeat", "K"),
    ("G81", {"X": 1, "Z": -3, "R": 2, "K": -1}, "cycle-repeat", "K"),
    ("G81", {"X": 1, "Z": -3, "R": 2, "K": 2, "L": 2}, "cycle-repeat", "L"),
    ("G81", {"X": 1, "Z": -3, "R": 2, "K": 9999999}, "cycle-repeat", "K"),
    ("G81", {"X": 1, "Z": -3, "R": 2, "I": 1}, "cycle-word", "I"),
    ("G76", {"X": 1, "Z": -3, "R": 2, "Q": 1, "J": 1}, "cycle-word", "J"),
    ("G84", {"X": 1, "Z": -3, "R": 2, "Q": 1}, "cycle-unsupported", "Q"),
    ("G81", {"X": 1, "Z": -3, "R": 2, "feed_known": False}, "missing-feed", "F"),
    ("G88.1", {"X": 1}, "cycle-unsupported", None),
]


@pytest.mark.parametrize(("code", "call", "refusal", "letter"), REFUSALS)
def test_refused(code: str, call: dict[str, Any], refusal: str, letter: str | None) -> None:
    with pytest.raises(CycleError) as error:
        block(code, **call)
    assert (error.value.code, error.value.letter) == (refusal, letter)
    assert error.value.expected
    assert str(error.value) == f"{error.value.problem}; expected {error.value.expected} [{refusal}]"


def test_a_stored_repeat_of_zero_asks_for_nothing_yet() -> None:
    assert block("G83", R=2, K=0, feed_known=False).steps == ()


def test_linuxcnc_goes_up_to_r_before_it_moves_in_the_plane() -> None:
    done = block("G81", LINUXCNC_CYCLES, X=5, Y=6, R=12, Z=-3)
    assert list(done.steps) == [R(0, 0, 12), R(5, 6, 12), F(5, 6, -3), R(5, 6, 12)]


def test_linuxcnc_takes_the_dwell_of_a_tap_from_any_cycle_before() -> None:
    first = block("G82", LINUXCNC_CYCLES, **HOLE, P=1.5)
    tap = block("G84", LINUXCNC_CYCLES, sticky=first.sticky, **HOLE)
    assert Pause(1.5) in tap.steps


def test_linuxcnc_leaves_the_retraction_of_g88_to_the_operator() -> None:
    done = block("G88", LINUXCNC_CYCLES, **HOLE, P=1)
    assert list(done.steps)[2:] == [F(5, 6, -3), Pause(1), STOP, OperatorStop(), CW]
    assert done.position == (5, 6, 10)


def test_linuxcnc_taps_along_the_wrong_axes_in_g19() -> None:
    """Y is fed to the bottom, Z to the hole's Y and X to the hole's Z; the control goes on as if it had not."""
    done = block("G84", LINUXCNC_CYCLES, axes=("Y", "Z", "X"), Y=5, Z=6, X=-3, R=2)
    assert [step for step in done.steps if isinstance(step, Move)][2:] == [T(-3, 5, 6), T(10, 5, 6)]
    assert done.position == (5, 6, 10)
