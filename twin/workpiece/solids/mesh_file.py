"""Meshes to files: binary STL and 3MF, whole or not at all."""

from __future__ import annotations

import os
from collections.abc import Callable
from pathlib import Path

from numpy.typing import ArrayLike

from gcode.whole_file import whole_file
from twin.errors import MeshError
from twin.workpiece.solids.from_mesh import stl_bytes, threemf_bytes
from twin.workpiece.to_mesh import SurfaceMesh

_WRITERS: dict[str, Callable[[ArrayLike, ArrayLike], bytes]] = {".stl": stl_bytes, ".3mf": threemf_bytes}


def check_mesh_path(path: Path | str, *, force: bool = False) -> Path:
    """Check that a mesh can be written there, before long work.

    Args:
        path: file that ends in ``.stl`` or ``.3mf``.
        force: whether an existing file may be replaced.

    Raises:
        MeshError: an unknown suffix, a missing folder, or a file that exists.
    """
    target = Path(path)
    if target.suffix.lower() not in _WRITERS:
        raise MeshError(f'{path}: suffix "{target.suffix}"; expected {" or ".join(_WRITERS)}')
    if not target.parent.is_dir():
        raise MeshError(f"{path}: there is no folder {target.parent}; expected one that exists")
    if target.exists() and not force:
        raise MeshError(f"{path}: already exists; expected a new name, or --force to replace it")
    return target


def write_mesh(path: Path | str, mesh: SurfaceMesh, *, force: bool = False) -> None:
    """Write a mesh as binary STL or 3MF, mm; the file has its name only when it is complete.

    Args:
        path: file that ends in ``.stl`` or ``.3mf``.
        mesh: e.g. that of `Run.mesh`.
        force: replace a file that exists.

    Raises:
        MeshError: an unknown suffix, a missing folder, a file that exists, an empty mesh, or a file that cannot be
            written.
    """
    target = check_mesh_path(path, force=force)
    if len(mesh.triangles) == 0:
        raise MeshError(f"{path}: no material is left of the workpiece; expected a surface to write")
    try:
        with whole_file(target) as partial, partial.open("wb") as file:
            file.write(_WRITERS[target.suffix.lower()](mesh.vertices_mm, mesh.triangles))
            file.flush()
            os.fsync(file.fileno())
    except OSError as error:
        raise MeshError(f"{path}: cannot be written: {error.strerror}") from error
