"""The surface of the machined part: closed, turned outwards, flat where the part is flat, sharp where it is sharp."""

from __future__ import annotations

import math
import os
import re

import numpy as np
import pytest
import trimesh
from numpy.typing import NDArray

from twin.arrays import FloatArray
from twin.errors import StockError
from twin.geometry.polygons.region import Region
from twin.motion.sweep import Body, Sweep
from twin.tools.shape import tool_shape
from twin.workpiece import dual_contouring_kernels as contour_kernels
from twin.workpiece import lattice_kernels
from twin.workpiece.cell_cases import edge_corners, sheet_table
from twin.workpiece.lattice import Lattice
from twin.workpiece.removal import Removal
from twin.workpiece.stock import SliceSet, box_slices, circle_polygon
from twin.workpiece.to_mesh import SurfaceMesh, patch_grid, patch_mesh, surface_mesh
from twin.workpiece.trislice import CellSlices, PolygonSlices

#: Plain Python is 100 times slower: smaller parts are enough there.
COMPILED = os.environ.get("NUMBA_DISABLE_JIT") != "1"


def volume(mesh: SurfaceMesh) -> float:
    a, b, c = (mesh.vertices_mm[mesh.triangles[:, i]] for i in range(3))
    return float(np.einsum("ij,ij->", a, np.cross(b, c))) / 6.0


def open_edges(triangles: NDArray[np.int64]) -> int:
    """Edges that are not run through as often one way as the other."""
    tails, tips = triangles.ravel().astype(np.int64), np.roll(triangles, -1, axis=1).ravel().astype(np.int64)
    _, where = np.unique(np.minimum(tails, tips) * (tails.max() + 1) + np.maximum(tails, tips), return_inverse=True)
    return int(np.count_nonzero(np.bincount(where, weights=np.where(tails < tips, 1.0, -1.0))))


def notched(pitch: float) -> tuple[SliceSet, float]:
    """A block with a stepped notch in a corner, all faces between planes, and its volume."""
    whole = box_slices((0.0, 0.0, 0.0), (12.0, 10.0, 8.0), pitch)
    low, high = (4.033, 3.021, 2.047), (13.0, 11.0, 9.0)
    families = []
    for axis, (u, v) in enumerate(((1, 2), (0, 2), (0, 1))):
        (w_u, w_v), (x, y) = (whole.high_mm[u], whole.high_mm[v]), (low[u], low[v])
        full = Region.of([(0, 0), (w_u, 0), (w_u, w_v), (0, w_v)])
        ell = Region.of([(0, 0), (w_u, 0), (w_u, y), (x, y), (x, w_v), (0, w_v)])
        inside = [low[axis] < p < high[axis] for p in whole.positions_mm(axis)]
        families.append(tuple(ell if i else full for i in inside))
    removed = (12.0 - low[0]) * (10.0 - low[1]) * (8.0 - low[2])
    slices = SliceSet(low_mm=whole.low_mm, high_mm=whole.high_mm, pitch_mm=whole.pitch_mm, regions=tuple(families))
    return slices, 960.0 - removed


def ball_slices(pitch: float) -> SliceSet:
    """A ball of radius 5 from circles within a tenth of a micrometre."""
    box = box_slices((-5.0, -5.0, -5.0), (5.0, 5.0, 5.0), pitch)
    circles = [Region.of(circle_polygon(math.sqrt(25.0 - p * p), 1e-4)) for p in box.positions_mm(0)]
    return SliceSet(low_mm=box.low_mm, high_mm=box.high_mm, pitch_mm=box.pitch_mm, regions=(tuple(circles),) * 3)


def machined(seed: int, cuts: int = 25) -> CellSlices:
    store = CellSlices(box_slices((0.0, 0.0, 0.0), (10.0, 8.0, 4.0), 0.25))
    bodies = [Body.of(tool_shape(kind, size, 20.0), chord_mm=0.0025) for kind, size in (("ball", 2.0), ("flat", 1.0))]
    rng = np.random.default_rng(seed)
    with Removal(store, 0.0025, threads=1) as removal:
        for i in range(cuts):
            start = rng.uniform((-1, -1, 0), (11, 9, 4))
            removal.cut(Sweep(bodies[i % 2], start, start + rng.normal(0.0, 2.0, 3)))
    return store


@pytest.mark.parametrize("pitch", [0.5, 0.7, 3.0])
@pytest.mark.parametrize("store", [CellSlices, PolygonSlices])
def test_a_block_comes_out_exactly(pitch: float, store: type[CellSlices]) -> None:
    mesh = surface_mesh(store(box_slices((-1.0, 2.0, -8.0), (11.0, 12.0, 0.0), 0.5)), pitch)
    assert open_edges(mesh.triangles) == 0
    assert volume(mesh) == pytest.approx(960.0, rel=1e-12)
    assert mesh.vertices_mm.min(axis=0) == pytest.approx([-1.0, 2.0, -8.0], abs=1e-12)
    assert mesh.vertices_mm.max(axis=0) == pytest.approx([11.0, 12.0, 0.0], abs=1e-12)
    normals = trimesh.Trimesh(mesh.vertices_mm, mesh.triangles, process=False).face_normals
    assert np.abs(normals).max(axis=1) == pytest.approx(np.ones(len(normals)))


@pytest.mark.parametrize("pitch", [0.5, 1.1])
def test_inner_and_outer_edges_and_corners_are_sharp(pitch: float) -> None:
    slices, wanted = notched(0.5)
    mesh = surface_mesh(CellSlices(slices), pitch)
    assert open_edges(mesh.triangles) == 0
    assert volume(mesh) == pytest.approx(wanted, rel=1e-9)
    corner = np.array([4.033, 3.021, 2.047])
    assert np.linalg.norm(mesh.vertices_mm - corner, axis=1).min() < 1e-9


def test_a_ball_is_round_with_an_error_that_falls_with_the_square_of_the_pitch() -> None:
    slices = ball_slices(0.125)
    errors = []
    for pitch in (0.5, 0.25):
        mesh = surface_mesh(CellSlices(slices), pitch)
        assert open_edges(mesh.triangles) == 0
        off = np.linalg.norm(mesh.vertices_mm, axis=1) - 5.0
        errors.append(float(np.abs(off).max()))
        radial = mesh.vertices_mm / np.linalg.norm(mesh.vertices_mm, axis=1, keepdims=True)
        assert np.einsum("ij,ij->i", radial, mesh.normals).min() > math.cos(math.radians(4.0))
        assert volume(mesh) == pytest.approx(4.0 / 3.0 * math.pi * 125.0, rel=0.01 * pitch**2)
    assert errors[0] < 0.08 * 0.5**2
    assert math.log2(errors[0] / errors[1]) == pytest.approx(2.0, abs=0.3)


@pytest.mark.parametrize("seed", range(4))
def test_whatever_is_cut_the_surface_is_closed_and_holds_the_slices_volume(seed: int) -> None:
    """A cell with an edge thinner than itself may be lost: at most a cell's half on a tenth of the surface."""
    store = machined(seed)
    for pitch in (0.25, 0.5):
        mesh = surface_mesh(store, pitch)
        assert open_edges(mesh.triangles) == 0
        area = trimesh.Trimesh(mesh.vertices_mm, mesh.triangles, process=False).area
        assert volume(mesh) == pytest.approx(store.volume_mm3(2), abs=0.05 * pitch * area)
        assert np.linalg.norm(mesh.normals, axis=1) == pytest.approx(np.ones(len(mesh.normals)), abs=1e-9)
        assert len(np.unique(mesh.vertices_mm.astype(np.float32), axis=0)) == len(mesh.vertices_mm)


def test_a_floor_on_a_plane_of_slices_is_flat() -> None:
    """Planes lie at odd eighths; the cutter's bottom is on one of them."""
    store = CellSlices(box_slices((0.0, 0.0, 0.0), (8.0, 8.0, 4.0), 0.25))
    body = Body.of(tool_shape("flat", 4.0, 20.0), chord_mm=0.0025)
    with Removal(store, 0.0025, threads=1) as removal:
        removal.cut(Sweep(body, np.array([-3.0, 4.0, 2.125]), np.array([11.0, 4.0, 2.125])))
    mesh = surface_mesh(store, 0.25)
    assert open_edges(mesh.triangles) == 0
    floor = mesh.vertices_mm[np.all(np.abs(mesh.vertices_mm[:, :2] - 4.0) < (3.9, 1.5), axis=1)][:, 2]
    top = floor[floor > 1.0]
    assert np.ptp(top) < 1e-9
    assert top[0] == pytest.approx(2.125, abs=0.25 * 1.1e-3)


def test_a_sheet_of_one_slice_and_stock_smaller_than_the_pitch() -> None:
    for size in ((4.0, 3.0, 0.02), (0.02, 0.02, 0.02)):
        mesh = surface_mesh(CellSlices(box_slices((0.0, 0.0, 0.0), size, 0.1)))
        assert open_edges(mesh.triangles) == 0
        assert volume(mesh) == pytest.approx(math.prod(size), rel=1e-9)


def test_nothing_left_makes_an_empty_mesh_and_empty_patches() -> None:
    whole = box_slices((0.0, 0.0, 0.0), (3.0, 3.0, 3.0), 1.0)
    empty = SliceSet(
        low_mm=whole.low_mm, high_mm=whole.high_mm, pitch_mm=whole.pitch_mm, regions=((Region(),) * 3,) * 3
    )
    mesh = surface_mesh(CellSlices(empty))
    assert (mesh.vertices_mm.shape, mesh.normals.shape, mesh.triangles.shape) == ((0, 3), (0, 3), (0, 3))
    grid = patch_grid(CellSlices(empty))
    patch = patch_mesh(CellSlices(empty), grid, grid.patches[0])
    assert (patch.vertices_mm.shape, patch.triangles.shape) == ((0, 3), (0, 3))


def test_patches_meet_without_cracks() -> None:
    """Put together by place, bit for bit, they close and hold the whole mesh's volume."""
    store = machined(1)
    grid = patch_grid(store, 0.25, size=9)
    patches = [patch_mesh(store, grid, p, 1.5) for p in grid.patches]
    assert [p.patch for p in patches[:2]] == ["x0_y0", "x0_y1"]
    assert {p.t_s for p in patches} == {1.5}
    corners = np.concatenate([p.vertices_mm[p.triangles.ravel()] for p in patches])
    vertices, places = np.unique(corners, axis=0, return_inverse=True)
    triangles = places.reshape(-1, 3)
    assert open_edges(triangles) == 0
    whole = surface_mesh(store, 0.25)
    assert len(triangles) == len(whole.triangles)
    assert volume(SurfaceMesh(vertices.astype(float), vertices, triangles)) == pytest.approx(volume(whole), rel=1e-5)


def test_patches_are_drawn_crisp_every_normal_is_its_faces() -> None:
    store = CellSlices(notched(0.5)[0])
    grid = patch_grid(store, 0.5)
    for patch in grid.patches:
        drawn = patch_mesh(store, grid, patch)
        faces = trimesh.Trimesh(drawn.vertices_mm, drawn.triangles, process=False).face_normals
        for corner in range(3):
            assert drawn.normals[drawn.triangles[:, corner]] == pytest.approx(faces, abs=1e-5)
        assert (drawn.vertices_mm.dtype, drawn.triangles.dtype) == (np.float32, np.uint32)


def test_only_the_patches_near_a_cut_change() -> None:
    store = machined(2, cuts=6)
    grid = patch_grid(store, 0.25, size=6)
    before = {p: patch_mesh(store, grid, p) for p in grid.patches}
    sweep = Sweep(
        Body.of(tool_shape("ball", 2.0, 20.0), chord_mm=0.0025), np.array([3.0, 2.0, 2.0]), np.array([4.0, 3.0, 2.0])
    )
    with Removal(store, 0.0025, threads=1) as removal:
        assert removal.cut(sweep) > 0.0
    changed = {
        p for p in grid.patches if not np.array_equal(patch_mesh(store, grid, p).vertices_mm, before[p].vertices_mm)
    }
    assert 0 < len(changed) < len(grid.patches) / 2


@pytest.mark.parametrize("pitch", [0.0, -1.0, math.nan])
def test_a_pitch_that_is_no_length_is_refused(pitch: float) -> None:
    store = CellSlices(box_slices((0.0, 0.0, 0.0), (3.0, 3.0, 3.0), 1.0))
    with pytest.raises(StockError, match=f"^{re.escape(f'mesh pitch {pitch:g} mm; expected a number above 0')}$"):
        surface_mesh(store, pitch)


def test_nodes_lie_on_slices_no_further_apart_than_asked() -> None:
    store = CellSlices(box_slices((0.0, 0.0, 0.0), (10.0, 7.3, 0.1), 0.1))
    lattice = Lattice.of(store, 0.35)
    for axis in range(3):
        nodes, planes = lattice.nodes_mm[axis], lattice.planes[axis]
        assert (planes[0], planes[1], planes[-2], planes[-1]) == (-1, 0, store.count(axis) - 1, -1)
        assert nodes[1:-1] == pytest.approx(store.low_mm[axis] + (planes[1:-1] + 0.5) * store.pitch_mm[axis])
        assert np.diff(nodes).max() <= 0.35
        assert np.diff(nodes).min() > 0.0


def test_every_crossed_edge_of_a_cube_has_a_sheet_and_every_sheet_three_edges() -> None:
    table, corners = sheet_table(), edge_corners()
    for case in range(256):
        inside = (case >> np.arange(8) & 1).astype(bool)
        crossed = inside[corners[:, 0]] != inside[corners[:, 1]]
        assert np.array_equal(table[case] >= 0, crossed)
        numbers, counts = np.unique(table[case][crossed], return_counts=True)
        assert numbers.tolist() == list(range(len(numbers)))
        assert len(numbers) <= 4
        assert np.all(counts >= 3)


def quads_of(inside: NDArray[np.bool_]) -> FloatArray:
    """The quadrilaterals of any pattern of nodes; all crossings in the middle."""
    shape = inside.shape
    assert len(shape) == 3
    flat = np.ascontiguousarray(inside).ravel()
    numbers, axes = np.empty((3, flat.size), dtype=np.int32), np.empty(3 * flat.size, dtype=np.int8)
    axes = axes[: lattice_kernels.number_edges(flat, shape, numbers, axes)]
    points, normals = np.zeros((len(axes), 3)), np.zeros((len(axes), 3))
    x, y, z = (np.arange(float(n)) for n in shape)
    first, cases = np.empty(flat.size, dtype=np.int32), np.empty(flat.size, dtype=np.uint8)
    room = 2 * len(axes)
    vertices = np.empty((room, 3)), np.empty((room, 3)), np.empty(room, dtype=np.bool_), np.empty(room, dtype=np.int64)
    contour_kernels.place_vertices(
        contour_kernels.Nodes(flat, x, y, z),
        contour_kernels.Crossings(numbers, points, normals),
        sheet_table(),
        contour_kernels.Limits(0.99, (0.02, 0.1), 1e-3),
        contour_kernels.Vertices(first, cases, *vertices),
    )
    quads = np.empty((len(axes), 5), dtype=np.int32)
    count = contour_kernels.join_quads(shape, (0, 0), numbers, axes, sheet_table(), first, cases, quads)
    return quads[:count, :4]


@pytest.mark.parametrize("share", [0.1, 0.5, 0.8])
def test_any_pattern_of_nodes_has_a_closed_surface(share: float) -> None:
    """Even noise: every edge is run through as often one way as the other."""
    n = 14 if COMPILED else 6
    inside = np.zeros((n, n, n), dtype=np.bool_)
    inside[1:-1, 1:-1, 1:-1] = np.random.default_rng(5).random((n - 2,) * 3) < share
    quads = quads_of(inside).astype(np.int64)
    triangles = np.concatenate((quads[:, [0, 1, 2]], quads[:, [0, 2, 3]]))
    assert len(quads) > 0
    assert open_edges(triangles) == 0
