from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest

from twin.cam.passes.scan import Rows, ScanOptions, row_positions, scan_passes
from twin.cam.slices.stretches import below

LINE = np.array([(0.0, 0.0), (4.0, 0.0), (5.0, 2.0), (6.0, 0.0), (10.0, 0.0)])


def rows(direction: str) -> Rows:
    at = np.array([0.0, 1.0, 2.0])
    return Rows(direction=direction, at_mm=at, lines_mm=[LINE] * 3)  # type: ignore[arg-type]


def test_rows_are_evenly_spread_and_reach_both_ends() -> None:
    assert row_positions(-1.0, 1.0, 0.7) == pytest.approx([-1.0, -1.0 / 3.0, 1.0 / 3.0, 1.0])
    assert row_positions(0.0, 1.0, 0.25) == pytest.approx([0.0, 0.25, 0.5, 0.75, 1.0])
    assert row_positions(0.0, 1.0, 5.0) == pytest.approx([0.0, 1.0])


@pytest.mark.parametrize("direction", ["x", "y"])
@pytest.mark.parametrize("climb", [True, False])
def test_climb_has_the_uncut_material_on_its_right(direction: str, climb: bool) -> None:
    passes = scan_passes(rows(direction), ScanOptions(climb=climb))
    for one, after in pairwise(passes):
        feed = one.points_mm[-1] - one.points_mm[0]
        to_next = after.points_mm.mean(axis=0) - one.points_mm.mean(axis=0)
        left = feed[0] * to_next[1] - feed[1] * to_next[0]
        assert (left < 0.0) == climb


def test_zigzag_turns_every_second_row() -> None:
    passes = scan_passes(rows("x"), ScanOptions(zigzag=True, climb=False))
    assert [p.points_mm[0, 0] for p in passes] == [0.0, 10.0, 0.0]


def test_what_lies_above_the_material_is_left_out() -> None:
    passes = scan_passes(rows("x"), ScanOptions(top_mm=1.0, climb=False))
    assert len(passes) == 6
    assert passes[0].points_mm[-1].tolist() == [4.5, 0.0, 1.0] and passes[1].points_mm[0].tolist() == [5.5, 0.0, 1.0]
    assert scan_passes(rows("x"), ScanOptions(top_mm=0.0)) == ()


def test_rows_are_approached_from_outside_where_there_is_room() -> None:
    passes = scan_passes(rows("x"), ScanOptions(top_mm=1.0, climb=False, approach_mm=(-6.0, None)))
    assert passes[0].approach_mm is not None and passes[0].approach_mm.tolist() == [-6.0, 0.0, 0.0]
    assert passes[1].approach_mm is None


def test_runs_of_a_line_that_begins_above() -> None:
    line = np.array([(0.0, 5.0), (1.0, 3.0), (2.0, 3.0), (3.0, 5.0)])
    (run,) = below(line, 4.0)
    assert run.tolist() == [[0.5, 4.0], [1.0, 3.0], [2.0, 3.0], [2.5, 4.0]]
