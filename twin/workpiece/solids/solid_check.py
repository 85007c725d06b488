"""Checks that a triangle mesh is a closed solid, with the positions where it is not."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from twin.arrays import FloatArray
from twin.errors import MeshError
from twin.workpiece.solids.mesh_defects import bodies, defects
from twin.workpiece.solids.mesh_defects import point as text_of
from twin.workpiece.solids.weld import Mesh


def check_closed(name: str, vertices_mm: FloatArray, mesh: Mesh) -> None:
    """Every edge must be used as often in one direction as in the other.

    Raises:
        MeshError: otherwise, with the kind of every defect, its size and position.
    """
    if mesh.closed:
        return
    found, state = "; ".join(defects(vertices_mm, mesh)), "leaks" if mesh.open.any() else "is not closed"
    raise MeshError(
        f"{name}: the surface {state}: {found}; expected a closed surface, all triangles counter-clockwise seen from "
        "outside"
    )


def check_orientation(name: str, vertices_mm: FloatArray, triangles: NDArray[np.int64]) -> None:
    """Every body must be turned outwards; a cavity is a body turned inwards inside another.

    Raises:
        MeshError: nothing enclosed, or a body inside out.
    """
    body_of = bodies(len(vertices_mm), triangles)
    a, b, c = (vertices_mm[triangles[:, i]] - vertices_mm[triangles[0, 0]] for i in range(3))
    volumes = np.bincount(body_of, weights=np.einsum("ij,ij->i", a, np.cross(b, c)) / 6.0)
    extent = math.prod(float(np.ptp(column)) for column in vertices_mm.T)
    if np.abs(volumes).max() <= 1e-12 * extent:
        raise MeshError(f"{name}: the surface encloses no volume; expected a solid")
    for body in np.flatnonzero(volumes < -1e-12 * extent):
        point = vertices_mm[triangles[np.argmax(body_of == body), 0]]
        if winding_number(point, vertices_mm, triangles[body_of != body]) < 0.5:
            at = text_of(point)
            which = f" (body {body + 1} of {len(volumes)})" if len(volumes) > 1 else ""
            raise MeshError(
                f"{name}: the surface is inside out{which}: volume {volumes[body]:.6g} mm3 at {at}; "
                "expected triangles counter-clockwise seen from outside"
            )


def winding_number(point_mm: FloatArray, vertices_mm: FloatArray, triangles: NDArray[np.int64]) -> float:
    """How often closed surfaces wind about a point: their solid angle over 4 pi (Van Oosterom and Strackee, 1983)."""
    a, b, c = (vertices_mm[triangles[:, i]] - point_mm for i in range(3))
    la, lb, lc = (np.linalg.norm(p, axis=1) for p in (a, b, c))
    volume = np.einsum("ij,ij->i", a, np.cross(b, c))
    dots = [np.einsum("ij,ij->i", p, q) for p, q in ((a, b), (b, c), (c, a))]
    angles = 2.0 * np.arctan2(volume, la * lb * lc + dots[0] * lc + dots[1] * la + dots[2] * lb)
    return float(angles.sum()) / (4.0 * np.pi)
