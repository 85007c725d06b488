"""Makes casting.stl: a bracket with a round boss and a bore, drawn as one watertight solid."""

from __future__ import annotations

from pathlib import Path

import mapbox_earcut
import numpy as np
import trimesh

SEGMENTS = 48
BASE_MM = ((0.0, 0.0), (70.0, 0.0), (70.0, 22.0), (26.0, 22.0), (26.0, 50.0), (0.0, 50.0))
HEIGHT_MM = 16.0
BORE_MM = (13.0, 37.0, 5.0)


def casting() -> trimesh.Trimesh:
    """An L-shaped plate with 4 degrees of draft and a through bore."""
    outline = np.array(BASE_MM)
    x, y, radius = BORE_MM
    angle = np.linspace(0.0, 2.0 * np.pi, SEGMENTS, endpoint=False)
    bore = np.column_stack((x + radius * np.cos(angle), y + radius * np.sin(angle)))
    centre = outline.mean(axis=0)
    draft = 1.0 - HEIGHT_MM * np.tan(np.radians(4.0)) / 40.0
    vertices = np.concatenate((outline, bore))
    n = len(vertices)
    faces = mapbox_earcut.triangulate_float64(vertices, np.array([len(outline), n], dtype=np.uint32)).reshape(-1, 3)
    top = np.column_stack((centre + (vertices - centre) * draft, np.full(n, HEIGHT_MM)))
    bottom = np.column_stack((vertices, np.zeros(n)))
    sides = _sides(len(outline), 0, n) + _sides(SEGMENTS, len(outline), n)
    triangles = np.concatenate((faces[:, ::-1], faces + n, np.array(sides)))
    mesh = trimesh.Trimesh(np.concatenate((bottom, top)), triangles, process=False)
    mesh.fix_normals()
    return mesh


def _sides(count: int, first: int, above: int) -> list[tuple[int, int, int]]:
    around = [(first + i, first + (i + 1) % count) for i in range(count)]
    return [t for a, b in around for t in ((a, b, b + above), (a, b + above, a + above))]


if __name__ == "__main__":
    mesh = casting()
    assert mesh.is_watertight
    mesh.export(Path(__file__).parent / "casting.stl")
    print(f"casting.stl: {len(mesh.faces)} triangles, {mesh.volume:.1f} mm3")
