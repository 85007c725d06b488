"""Meshes to files: binary STL and 3MF, whole or not at all."""

from __future__ import annotations

import os
from collections.abc import Callable
from pathlib import Path

from numpy.typing import ArrayLike

from twin.errors import MeshError
from twin.workpiece.from_mesh import stl_bytes, threemf_bytes
from twin.workpiece.to_mesh import SurfaceMesh

_WRITERS: dict[str, Callable[[ArrayLike, ArrayLike], bytes]] = {".stl": stl_bytes, ".3mf": threemf_bytes}


def check_mesh_path(path: Path | str, *, force: bool = False) -> Path:
    """Check that a mesh can be written there, before long work.

    Args:
        force: whether a file that is there may be replaced.

    Raises:
        MeshError: a suffix without writer, a folder that is not there, or a file that is.
    """
    target = Path(path)
    if target.suffix.lower() not in _WRITERS:
        raise MeshError(f'{path}: suffix "{target.suffix}"; expected {" or ".join(_WRITERS)}')
    if not target.parent.is_dir():
        raise MeshError(f"{path}: there is no folder {target.parent}; expected one that exists")
    if target.exists() and not force:
        raise MeshError(f"{path}: is there already; expected a new name, or leave to replace it (--force)")
    return target


def write_mesh(path: Path | str, mesh: SurfaceMesh, *, force: bool = False) -> None:
    """Write a mesh as binary STL or 3MF, by the path's suffix; under its final name only when all of it is on the disk.

    Args:
        force: whether a file that is there may be replaced.

    Raises:
        MeshError: see `check_mesh_path`; an empty mesh; or the file cannot be written.
    """
    target = check_mesh_path(path, force=force)
    if len(mesh.triangles) == 0:
        raise MeshError(f"{path}: nothing is left of the workpiece; expected a surface to write")
    partial = target.with_name(f"{target.name}.partial")
    try:
        with partial.open("wb") as file:
            file.write(_WRITERS[target.suffix.lower()](mesh.vertices_mm, mesh.triangles))
            file.flush()
            os.fsync(file.fileno())
        partial.replace(target)
    except OSError as error:
        partial.unlink(missing_ok=True)
        raise MeshError(f"{path}: cannot be written: {error.strerror}") from error
