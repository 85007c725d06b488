"""The drop-cutter against the bare definition, against itself triangle by triangle, and against opencamlib."""

from __future__ import annotations

from collections.abc import Callable
from itertools import pairwise

import numpy as np
import pytest
import trimesh
from support.golden_section import dropped
from support.terrain import block, plane32, rough, terrain, waves

from twin.arrays import FloatArray
from twin.cam.surface.drop_cutter import DropCutter
from twin.cam.surface.surface import surface_of
from twin.tools.text import parse_tool

TOOLS = ("ball 4", "ball 8", "flat 3", "bull 6 r1", "bull 5 r2", "taper 2 r0.5 a15", "taper 2 a25")
FLOOR = -20.0


@pytest.mark.parametrize("text", TOOLS)
def test_the_definition_on_loose_triangles(text: str) -> None:
    rngs = [np.random.default_rng(seed) for seed in range(3)]
    steep = ((1.0, 1.0, 0.2), (1.0, 1.0, 1.0), (1.0, 1.0, 3.0))
    triangles = np.array([rng.uniform(-6.0, 6.0, (6, 3, 3)) * z for rng, z in zip(rngs, steep, strict=True)])
    points = np.array([rng.uniform(-8.0, 8.0, (30, 2)) for rng in rngs])
    found = [DropCutter(t, text, floor_mm=FLOOR).drop(p) for t, p in zip(triangles, points, strict=True)]
    assert np.array(found) == pytest.approx(dropped(triangles, parse_tool(text), points, FLOOR), abs=1e-6)


@pytest.mark.parametrize("text", TOOLS)
def test_the_definition_on_a_joined_surface(text: str) -> None:
    triangles = terrain(rough, 4)
    points = np.random.default_rng(11).uniform(-2.0, 8.0, (20, 2))
    found = DropCutter(triangles, text, floor_mm=FLOOR).drop(points)
    assert found == pytest.approx(dropped(triangles, parse_tool(text), points, FLOOR), abs=1e-6)


def turned_torus() -> FloatArray:
    mesh = trimesh.creation.torus(4.0, 1.2, 24, 10)
    mesh.apply_transform(trimesh.transformations.rotation_matrix(0.7, (0.3, 1.0, 0.2)))
    return np.array(mesh.triangles)


SURFACES: dict[str, Callable[[], FloatArray]] = {
    "rough": lambda: terrain(rough, 10),
    "waves": lambda: terrain(waves, 12),
    "block": lambda: terrain(block, 12),
    "plane of a file": lambda: terrain(plane32, 8),
    "noise": lambda: terrain(lambda x, y: 1e-7 * rough(x, y), 8),
    "dome": lambda: terrain(lambda x, y: -0.01 * ((x - 3.0) ** 2 + (y - 3.0) ** 2), 8),
    "star": lambda: star(),
    "box": lambda: np.array(trimesh.creation.box((4.0, 3.0, 2.0)).triangles),
    "ball": lambda: np.array(trimesh.creation.icosphere(2, 3.0).triangles),
    "cylinder": lambda: np.array(trimesh.creation.cylinder(2.0, 3.0, sections=17).triangles),
    "torus with undercuts": turned_torus,
}


def star() -> FloatArray:
    """A pyramid with valleys: its apex has edges of both kinds and is touched all the same."""
    angle = np.linspace(0.0, 2.0 * np.pi, 15)
    rim = np.where(np.arange(15) % 2 == 0, 5.0, 1.5)
    low = np.column_stack((rim * np.cos(angle), rim * np.sin(angle), np.zeros(15)))
    low[-1] = low[0]
    return np.array([(a, b, (0.0, 0.0, 4.0)) for a, b in pairwise(low)])


@pytest.mark.parametrize("name", SURFACES)
def test_what_cones_leave_out_is_never_missed(name: str) -> None:
    # a triangle alone has all its edges and vertices; the highest of all triangles is the truth
    triangles = SURFACES[name]()
    low, high = triangles.min(axis=(0, 1)), triangles.max(axis=(0, 1))
    rng = np.random.default_rng(12)
    points = np.concatenate(
        (
            rng.uniform(low[:2] - 3.0, high[:2] + 3.0, (120, 2)),
            triangles.reshape(-1, 3)[::9, :2],
            triangles.mean(axis=1)[::7, :2],
        )
    )
    whole, pieces = surface_of(triangles), [surface_of(triangle[None], threads=1) for triangle in triangles]
    for text in (*TOOLS[::2], None):
        tool = None if text is None else parse_tool(text)
        together = DropCutter(whole, tool, floor_mm=FLOOR).drop(points)
        alone = np.full(len(points), FLOOR)
        for piece in pieces:
            np.maximum(alone, DropCutter(piece, tool, floor_mm=FLOOR, threads=1).drop(points), out=alone)
        assert together == pytest.approx(alone, abs=1e-9), text


@pytest.mark.parametrize(("text", "size"), [("ball 8", 12), ("ball 2", 40), ("flat 5", 12), ("bull 6 r1", 12)])
@pytest.mark.parametrize("shape", [waves, rough])
def test_opencamlib_gives_the_same_heights(text: str, size: int, shape: Callable[..., FloatArray]) -> None:
    ocl = pytest.importorskip("opencamlib")
    triangles = terrain(shape, size)
    points = np.random.default_rng(13).uniform(-1.0, 7.0, (800, 2))
    tool = parse_tool(text)
    diameter, length = 2.0 * tool.nominal_radius_mm, 100.0
    cutter = {
        "ball": lambda: ocl.BallCutter(diameter, length),
        "flat": lambda: ocl.CylCutter(diameter, length),
        "bull": lambda: ocl.BullCutter(diameter, tool.corner_radius_mm, length),
    }[text.split()[0]]()
    surface = ocl.STLSurf()
    for t in triangles:
        surface.addTriangle(ocl.Triangle(*(ocl.Point(*map(float, p)) for p in t)))
    batch = ocl.BatchDropCutter()
    batch.setSTL(surface)
    batch.setCutter(cutter)
    for x, y in points.tolist():
        batch.appendPoint(ocl.CLPoint(x, y, -30.0))
    batch.run()
    theirs = np.array([p.z for p in batch.getCLPoints()])
    ours = DropCutter(triangles, text, floor_mm=-30.0).drop(points)
    off = np.abs(ours - theirs)
    # where it differs by more, the definition decides: theirs lies below a point of the surface, or above all of them
    doubtful = np.flatnonzero(off > 1e-6)
    assert len(doubtful) <= 0.02 * len(points)
    truth = dropped(triangles, tool, points[doubtful[:20]], -30.0)
    assert ours[doubtful[:20]] == pytest.approx(truth, abs=1e-6)
