"""Draws the pictures of docs/paths.md: a small torus scanned, contoured, and verified.

python tools/make_path_pictures.py
"""

from __future__ import annotations

import sys
import tempfile
from pathlib import Path

ROOT = Path(__file__).parents[1]
PICTURES = ROOT / "docs" / "pictures"
sys.path.insert(0, str(ROOT / "examples" / "torus"))

import make_torus  # noqa: E402

from twin.cli import run as twin  # noqa: E402

SMALL = make_torus.Profile(ring_mm=6.0, tube_mm=2.0, outer_mm=1.5, inner_mm=1.0, half_mm=11.0, thick_mm=2.0)


def main() -> None:
    """Makes the part, its paths and their pictures."""
    with tempfile.TemporaryDirectory() as folder:
        stl, out, job = (str(Path(folder) / name) for name in ("torus.stl", "torus.nc", "torus.toml"))
        make_torus.write_stl(stl, make_torus.torus(256, 96, SMALL))
        contour = ["--tool", "flat 3", "--axial-depth", "0.5", "--layers", "0", "--radial-depth", "1.2"]
        floor = ["--floor-z", "0", "--arcs", "0.005", "--force"]
        twin(["paths", "contour", stl, *contour, *floor, "-o", out, "--plot", str(PICTURES / "contour_path.png")])
        scan = ["--tool", "ball 3", "--pitch", "0.05", "--stepover", "0.2", "--arcs", "0.001", "--force"]
        twin(["paths", "scan", stl, *scan, "-o", out, "--plot", str(PICTURES / "scan_path.png")])
        check = ["--pitch", "0.1", "--tolerance", "0.01", "--force"]
        twin(["verify", job, stl, *check, "--plot", str(PICTURES / "verify.png")])


if __name__ == "__main__":
    main()
