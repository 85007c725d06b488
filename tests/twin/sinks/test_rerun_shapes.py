"""Tool meshes, colours and path rows by their laws."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from tests.support.slot_run import SlotRun
from twin.sinks.rerun import layout
from twin.sinks.rerun.batches import BATCH_STEPS, PathBatch, RevolutionPeak, StepBatch
from twin.sinks.rerun.shapes import (
    CLASSES,
    SIDES,
    box_edges,
    class_colors,
    class_force_n,
    force_class,
    label_step_n,
    scale_end_n,
    tool_mesh,
)
from twin.sinks.rerun.summary import summary_text

RUN = SlotRun(step_mm=1.0, per_turn=36)


def volume(vertices: np.ndarray, triangles: np.ndarray) -> float:
    a, b, c = (vertices[triangles[:, k]].astype(np.float64) for k in range(3))
    return float(np.sum(a * np.cross(b, c)) / 6.0)


def test_a_cylinder_is_closed_and_faces_outwards() -> None:
    mesh = tool_mesh(np.array([(0.0, 0.0), (3.0, 0.0), (3.0, 10.0)]))
    prism = 0.5 * SIDES * 3.0**2 * math.sin(2.0 * math.pi / SIDES) * 10.0
    assert volume(mesh.vertices, mesh.triangles) == pytest.approx(prism, rel=1e-5)
    np.testing.assert_allclose(np.linalg.norm(mesh.normals, axis=1), 1.0, atol=1e-6)


def test_a_ball_is_shaded_smoothly_and_a_step_sharply() -> None:
    (tool,) = RUN.header().tools
    mesh = tool_mesh(tool.profile_mm)
    tip = mesh.vertices[:, 2] < 3.9
    outward = (mesh.vertices - (0.0, 0.0, 4.0)) / 4.0
    np.testing.assert_allclose(mesh.normals[tip], outward[tip], atol=0.07)
    shoulder = (mesh.vertices[:, 2] == 30.0) & (np.abs(mesh.normals[:, 2]) > 0.5)
    np.testing.assert_allclose(np.abs(mesh.normals[shoulder, 2]), 1.0)


def test_a_repeated_profile_point_makes_no_face() -> None:
    once = np.array([(0.0, 0.0), (3.0, 0.0), (3.0, 10.0)])
    np.testing.assert_array_equal(tool_mesh(np.repeat(once, 2, axis=0)).triangles, tool_mesh(once).triangles)


def test_the_box_has_twelve_edges() -> None:
    strips = box_edges(np.array([(0.0, 0.0, 0.0), (1.0, 2.0, 3.0)]))
    assert sum(float(np.linalg.norm(np.diff(s, axis=0), axis=1).sum()) for s in strips) == pytest.approx(24.0)


@given(st.floats(0.1, 9e4))
def test_a_class_is_within_three_percent_of_its_force(force_n: float) -> None:
    assert class_force_n(force_class(force_n)) == pytest.approx(force_n, rel=0.03)


@given(st.floats(1e-3, 1e6))
def test_a_scale_ends_at_a_round_number_above_the_force(force_n: float) -> None:
    end = scale_end_n(force_n)
    assert force_n <= end <= 1.4 * force_n
    assert float(f"{end:.1e}") == pytest.approx(end)


@pytest.mark.parametrize(
    ("end_n", "step_n"), [(10.0, 2.0), (120.0, 20.0), (150.0, 50.0), (250.0, 50.0), (6.0, 2.0), (8e3, 2e3)]
)
def test_numbers_on_the_scale_are_round(end_n: float, step_n: float) -> None:
    assert label_step_n(end_n) == pytest.approx(step_n)


def test_no_force_has_the_colour_of_air_and_the_end_of_the_scale_its_last() -> None:
    colors = class_colors(100.0)
    assert len(colors) == CLASSES + 1
    assert colors[0] == layout.AIR_COLOR
    assert colors[force_class(150.0)] == colors[-1] == (222, 40, 30)
    assert force_class(0.0) == 0
    assert force_class(1e9) == CLASSES
    assert scale_end_n(0.0) == 1.0


def test_the_colour_of_a_short_step_is_the_peak_of_its_revolution() -> None:
    run = SlotRun(step_mm=0.02, per_turn=360)
    peak = RevolutionPeak()
    found = [peak.of(run.cut(i, i * 0.002, 10.0)) for i in range(30)]
    highest = max(float(np.linalg.norm(run.cut(i, i * 0.002, 10.0).samples.force_n, axis=1).max()) for i in range(30))
    np.testing.assert_allclose(found[5:], highest, rtol=1e-9)
    assert peak.of(run.cut(31, 1.0, -5.0)) == 0.0


def test_neighbours_of_one_colour_are_one_strip() -> None:
    path = PathBatch(planned_time_s=1e6)
    for i in range(5):
        path.add(RUN.cut(i, 0.1 * i, -9.0 + i))
    ((entity, (row,)),) = path.take()
    assert entity == layout.CUT_PATH
    assert row.strips == [[(-9.0, 15.0, -2.0), (-4.0, 15.0, -2.0)]]  # on one line
    assert row.moment == (pytest.approx(0.5), 5, 4)
    assert list(path.take()) == []


def test_a_step_that_stands_still_is_no_path() -> None:
    path = PathBatch(planned_time_s=1.0)
    path.add(replace(RUN.cut(0, 0.0, -9.0), end_mm=(-9.0, 15.0, -2.0)))
    assert list(path.take()) == []


def test_a_batch_is_full_at_its_number_of_steps() -> None:
    batch = StepBatch()
    full = [batch.add(RUN.rapid(i, 0.0, (0.0, 0.0, 0.0), (1.0, 0.0, 0.0), 1)) for i in range(BATCH_STEPS)]
    assert full == [False] * (BATCH_STEPS - 1) + [True]
    assert len(batch.take()) == BATCH_STEPS
    assert batch.take() == []


def test_the_summary_says_what_was_cut_and_whether_it_came_to_its_end() -> None:
    summary = RUN.summary(7.6, 100)
    text = summary_text(summary)
    assert "| removed volume | 590 mm³ |" in text
    assert "| peak | 40.0 | 100.0 | 25.0 | 110.5 |" in text
    assert "| 4 | `N40 G1 X66 F600` | 110.5 |" in text
    assert "ended before" not in text
    assert "**The run was ended before the end of its program.**" in summary_text(replace(summary, complete=False))
