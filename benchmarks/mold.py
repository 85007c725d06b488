"""The example's mold for benchmarks, by its own script."""

from __future__ import annotations

import importlib.util
import tempfile
from pathlib import Path

from twin.workpiece.solids.from_mesh import Solid, load_mesh

_SCRIPT = Path(__file__).parents[1] / "examples" / "mold" / "make_mold.py"


def write_mold(path: Path, triangles: int) -> None:
    """The mold with about this many triangles as an STL file."""
    spec = importlib.util.spec_from_file_location("make_mold", _SCRIPT)
    assert spec is not None
    assert spec.loader is not None
    maker = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(maker)
    maker.write_stl(path, maker.mold_triangles(triangles))


def mold(triangles: int) -> Solid:
    """The mold with about this many triangles, through its STL."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "mold.stl"
        write_mold(path, triangles)
        return load_mesh(path)
