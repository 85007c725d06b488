"""Slices of triangle meshes against closed forms, GEOS and trimesh's own sections."""

from __future__ import annotations

import math

import numpy as np
import pytest
import shapely
import trimesh
from hypothesis import given, settings
from hypothesis import strategies as st

from twin.geometry.mesh.slicing import mesh_sections
from twin.geometry.polygons.region import Region, signed_area_mm2
from twin.workpiece.solids.from_mesh import Solid, mesh_slices, solid
from twin.workpiece.store import PLANE_AXES


def of(mesh: trimesh.Trimesh, name: str = "mesh") -> Solid:
    return solid(np.array(mesh.triangles), name)


def sections(mesh: Solid, axis: int, planes: list[float]) -> tuple[Region, ...]:
    u, v = PLANE_AXES[axis]
    return mesh_sections(mesh.vertices_mm, mesh.triangles, mesh.edges, (axis, u, v), np.array(planes))


def polygon(region: Region) -> shapely.Geometry:
    """A region by non-zero winding: its outer rings less its holes."""
    outer = [shapely.Polygon(r) for r in region.rings if signed_area_mm2(r) > 0.0]
    holes = [shapely.Polygon(r) for r in region.rings if signed_area_mm2(r) < 0.0]
    return shapely.difference(shapely.union_all(outer), shapely.union_all(holes))


def volumes(mesh: Solid, pitch: float) -> list[float]:
    slices = mesh_slices(mesh, pitch)
    return [
        sum(r.area_mm2 for r in family) * float(p) for family, p in zip(slices.regions, slices.pitch_mm, strict=True)
    ]


@pytest.mark.parametrize("axis", [0, 1, 2])
def test_a_torus_has_its_closed_form_sections(axis: int) -> None:
    """Planes across the torus's axis cut rings of area 4 pi R w, planes along it through the middle two circles."""
    big, small = 10.0, 4.0
    torus = trimesh.creation.torus(big, small, major_sections=360, minor_sections=180)
    torus.apply_transform(trimesh.geometry.align_vectors((0, 0, 1), np.eye(3)[axis]))
    mesh = of(torus)
    chord = small * (math.pi / 180) ** 2 / 2.0 + big * (math.pi / 360) ** 2 / 2.0
    for height in (-2.9, 0.013, 1.7):
        region = sections(mesh, axis, [height])[0]
        half = math.sqrt(small**2 - height**2)
        outer, hole = sorted((signed_area_mm2(r) for r in region.rings), reverse=True)
        assert outer == pytest.approx(math.pi * (big + half) ** 2, abs=2.0 * math.pi * (big + half) * chord * 4.0)
        assert hole == pytest.approx(-math.pi * (big - half) ** 2, abs=2.0 * math.pi * (big - half) * chord * 4.0)
    across = sections(mesh, (axis + 1) % 3, [0.0131])[0]
    assert [signed_area_mm2(r) for r in across.rings] == pytest.approx([math.pi * small**2] * 2, rel=2e-3)


@settings(max_examples=25, deadline=None)
@given(st.integers(0, 2**32 - 1), st.floats(-0.8, 0.8))
def test_sections_of_rotated_bodies_are_those_of_trimesh(seed: int, height: float) -> None:
    body = trimesh.creation.annulus(2.0, 4.0, 5.0, sections=16)
    body.apply_transform(trimesh.transformations.random_rotation_matrix(np.random.default_rng(seed).random(3)))
    mesh = of(body)
    for axis in range(3):
        region = sections(mesh, axis, [height])[0]
        theirs = trimesh.intersections.mesh_plane(
            trimesh.Trimesh(mesh.vertices_mm, mesh.triangles, process=False), np.eye(3)[axis], height * np.eye(3)[axis]
        )
        lines = shapely.multilinestrings(list(shapely.linestrings(theirs[:, :, list(PLANE_AXES[axis])])))
        assert shapely.hausdorff_distance(polygon(region).boundary, lines) < 2e-5
        assert polygon(region).area == pytest.approx(region.area_mm2)


def test_a_vertex_on_a_plane_counts_as_above_it() -> None:
    """So a plane on the bottom face cuts nothing, one on the top face all of it, and one on a step what is below."""
    block = trimesh.creation.box(bounds=[[0, 0, 0], [10, 10, 10]])
    for axis in range(3):
        assert [r.area_mm2 for r in sections(of(block), axis, [0.0, 5.0, 10.0])] == [0.0, 100.0, 100.0]
    octahedron = of(
        trimesh.Trimesh(
            [(5, 0, 0), (-5, 0, 0), (0, 5, 0), (0, -5, 0), (0, 0, 5), (0, 0, -5)],
            [(0, 2, 4), (2, 1, 4), (1, 3, 4), (3, 0, 4), (2, 0, 5), (1, 2, 5), (3, 1, 5), (0, 3, 5)],
        )
    )
    for axis in range(3):
        assert [r.area_mm2 for r in sections(octahedron, axis, [-5.0, 0.0, 5.0])] == [0.0, 50.0, 0.0]


def test_a_step_on_a_plane_gives_what_is_below_it() -> None:
    profile = shapely.Polygon([(0, 0), (10, 0), (10, 4), (6, 4), (6, 10), (0, 10)])
    step = trimesh.creation.extrude_polygon(profile, 5.0)
    below, at, above = sections(of(step), 1, [3.9, 4.0, 4.1])
    assert [below.area_mm2, at.area_mm2, above.area_mm2] == pytest.approx([50.0, 50.0, 30.0])


def test_bodies_that_overlap_count_once_and_cavities_are_left_out() -> None:
    a = trimesh.creation.box(bounds=[[0, 0, 0], [10, 10, 10]])
    b = trimesh.creation.box(bounds=[[5, 5, 0], [15, 15, 10]])
    hole = trimesh.creation.box(bounds=[[1, 1, 1], [4, 4, 9]])
    corners = np.concatenate((a.triangles, b.triangles, np.array(hole.triangles)[:, ::-1]))
    for region in mesh_slices(solid(corners, "three"), 10.0).regions[2]:
        assert region.area_mm2 == pytest.approx(100.0 + 100.0 - 25.0 - 9.0)
        assert sorted(np.sign([signed_area_mm2(r) for r in region.rings])) == [-1.0, 1.0]


def test_volume_of_a_sphere_converges_with_the_square_of_the_pitch() -> None:
    """The midpoint rule: a plane's area differs from its slab's mean by pi p^2 / 12, so the volume is over by it."""
    ball = trimesh.creation.icosphere(subdivisions=5, radius=10.0)
    mesh = of(ball)
    for pitch in (2.0, 1.0, 0.5):
        fitted = 20.0 / math.ceil(20.0 / pitch)
        for volume in volumes(mesh, pitch):
            assert volume - mesh.volume_mm3 == pytest.approx(math.pi * fitted**2 / 12.0 * 20.0, rel=0.1)


def test_regions_are_valid_rounded_and_turned_right() -> None:
    ball = trimesh.creation.icosphere(subdivisions=3, radius=10.0)
    cavity = trimesh.creation.icosphere(subdivisions=2, radius=6.0)
    slices = mesh_slices(solid(np.concatenate((ball.triangles, np.array(cavity.triangles)[:, ::-1])), "shell"), 1.0)
    for family in slices.regions:
        for region in family:
            assert len(region.rings) in (1, 2)
            assert polygon(region).is_valid
            assert polygon(region).area == pytest.approx(region.area_mm2)
            assert all(np.array_equal(r, np.round(r, 5)) for r in region.rings)


@pytest.mark.parametrize("scale", [0.01, 1000.0])
def test_a_scaled_part_has_scaled_slices(scale: float) -> None:
    ball = trimesh.creation.icosphere(subdivisions=3, radius=10.0)
    plain = volumes(of(ball), 1.0)
    scaled = volumes(solid(np.array(ball.triangles) * scale, "scaled"), scale)
    assert scaled == pytest.approx(np.array(plain) * scale**3, rel=1e-3)


def test_the_slices_box_is_the_meshs_and_a_thin_plate_has_one_plane() -> None:
    plate = trimesh.creation.box(bounds=[[-1, 2, 3], [9, 12, 3.02]])
    slices = mesh_slices(of(plate), 0.1)
    assert (slices.low_mm.tolist(), slices.high_mm.tolist()) == ([-1.0, 2.0, 3.0], [9.0, 12.0, 3.02])
    assert [len(f) for f in slices.regions] == [100, 100, 1]


def test_two_bodies_that_touch_along_an_edge_close_all_rings() -> None:
    a = trimesh.creation.box(bounds=[[0, 0, 0], [1, 1, 1]])
    b = trimesh.creation.box(bounds=[[1, 1, 0], [2, 2, 1]])
    mesh = solid(np.concatenate((a.triangles, b.triangles)), "two")
    for axis in range(3):
        areas = [r.area_mm2 for r in sections(mesh, axis, [0.25, 0.75])]
        assert areas == pytest.approx([2.0 if axis == 2 else 1.0] * 2)
