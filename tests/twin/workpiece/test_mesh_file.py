"""Meshes to files: what is written can be read, and nothing is left half written."""

from __future__ import annotations

import errno
import os
import re
from pathlib import Path

import numpy as np
import pytest
import trimesh

from twin.errors import MeshError
from twin.workpiece.solids.from_mesh import load_mesh
from twin.workpiece.solids.mesh_file import write_mesh
from twin.workpiece.stock import box_slices, cylinder_slices
from twin.workpiece.to_mesh import SurfaceMesh, surface_mesh
from twin.workpiece.trislice import CellSlices


def block() -> SurfaceMesh:
    return surface_mesh(CellSlices(box_slices((0.0, 0.0, 0.0), (3.0, 4.0, 5.0), 0.5)))


def cylinder() -> tuple[CellSlices, SurfaceMesh]:
    slices = cylinder_slices(centre_mm=(5.0, 5.0), diameter_mm=10.0, axis="z", low_mm=0.0, high_mm=4.0, pitch_mm=0.25)
    return CellSlices(slices), surface_mesh(CellSlices(slices))


def test_an_stl_can_be_read_as_stock_again(tmp_path: Path) -> None:
    store, mesh = cylinder()
    write_mesh(tmp_path / "part.stl", mesh)
    again = load_mesh(tmp_path / "part.stl")
    assert len(again.triangles) == len(mesh.triangles)
    assert again.volume_mm3 == pytest.approx(store.volume_mm3(2), rel=2e-3)
    assert trimesh.load_mesh(tmp_path / "part.stl").is_watertight


def test_a_3mf_holds_the_same_body_in_mm(tmp_path: Path) -> None:
    write_mesh(tmp_path / "part.3mf", block())
    scene = trimesh.load_scene(tmp_path / "part.3mf")
    body = scene.to_mesh()
    assert scene.units == "millimeter"
    assert body.is_watertight
    assert body.volume == pytest.approx(60.0, rel=1e-6)
    assert body.extents == pytest.approx([3.0, 4.0, 5.0])


def test_a_file_that_is_there_is_kept_unless_forced(tmp_path: Path) -> None:
    path = tmp_path / "part.stl"
    path.write_text("precious")
    message = f"{path}: already exists; expected a new name, or --force to replace it"
    with pytest.raises(MeshError, match=f"^{re.escape(message)}$"):
        write_mesh(path, block())
    assert path.read_text() == "precious"
    write_mesh(path, block(), force=True)
    assert load_mesh(path).volume_mm3 == pytest.approx(60.0)
    assert list(tmp_path.iterdir()) == [path]


def test_wrong_places_and_kinds_are_refused(tmp_path: Path) -> None:
    with pytest.raises(MeshError, match=r'part\.obj: suffix "\.obj"; expected \.stl or \.3mf$'):
        write_mesh(tmp_path / "part.obj", block())
    with pytest.raises(MeshError, match=r"part\.stl: there is no folder .*nowhere; expected one that exists$"):
        write_mesh(tmp_path / "nowhere" / "part.stl", block())
    nothing = SurfaceMesh(np.empty((0, 3)), np.empty((0, 3)), np.empty((0, 3), dtype=np.int64))
    with pytest.raises(MeshError, match=r"part\.stl: no material is left of the workpiece; expected a surface"):
        write_mesh(tmp_path / "part.stl", nothing)
    assert list(tmp_path.iterdir()) == []


def test_a_full_disk_leaves_nothing_behind(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def full(_: int) -> None:
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    monkeypatch.setattr(os, "fsync", full)
    with pytest.raises(MeshError, match=r"part\.stl: cannot be written: No space left on device$"):
        write_mesh(tmp_path / "part.stl", block())
    assert list(tmp_path.iterdir()) == []
