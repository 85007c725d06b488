"""Runs the examples and makes every picture of docs/gallery.md.

    python tools/make_gallery.py               # all, about ten minutes
    python tools/make_gallery.py mold paths    # some

The viewer's pictures (``replays``) need a Vulkan driver; see make_pictures.py.
"""

from __future__ import annotations

import shutil
import subprocess
import sys
import tempfile
from collections.abc import Callable
from pathlib import Path

from PIL import Image

from twin.cli import run as twin

ROOT = Path(__file__).parents[1]
PICTURES = ROOT / "docs" / "pictures"
EXAMPLES = ROOT / "examples"
MOLD_TRIANGLES = 195_000


def script(path: Path, *arguments: str) -> None:
    """Run a Python file in a process of its own."""
    subprocess.run([sys.executable, str(path), *arguments], cwd=ROOT, check=True)


def maker(name: str) -> Callable[[], None]:
    """Another script of this folder."""
    return lambda: script(Path(__file__).with_name(name))


def test_cuts() -> None:
    """Logs of test cuts, coefficients from them, their plot."""
    script(EXAMPLES / "test_cuts" / "make_logs.py")
    with tempfile.TemporaryDirectory() as folder:
        plot = Path(folder) / "cuts.png"
        twin(["identify", str(EXAMPLES / "test_cuts" / "cuts.toml"), "--plot", str(plot)])
        shutil.copyfile(plot, PICTURES / "test_cuts.png")


def mold() -> None:
    """The mold in three stages, a picture of each with a palette, which halves the file."""
    with tempfile.TemporaryDirectory() as folder:
        here = Path(folder)
        shutil.copyfile(EXAMPLES / "mold" / "job.toml", here / "job.toml")
        script(EXAMPLES / "mold" / "make_mold.py", str(here / "mold.stl"), "--triangles", str(MOLD_TRIANGLES))
        twin(["mold", str(here / "job.toml"), "--plot", str(here / "plots")])
        for plot in (here / "plots").glob("*.png"):
            with Image.open(plot) as image:
                small = image.convert("RGB").quantize(256)
                small.save(PICTURES / f"mold_{plot.stem}.png", optimize=True)


MAKERS: dict[str, Callable[[], None]] = {
    "replays": maker("make_pictures.py"),
    "comparison": maker("make_comparison_picture.py"),
    "test_cuts": test_cuts,
    "offsets": maker("make_offset_pictures.py"),
    "paths": maker("make_path_pictures.py"),
    "mold": mold,
    "surfaces": maker("make_cam_pictures.py"),
}


def main() -> None:
    """Make the groups of pictures named on the command line, or all."""
    names = sys.argv[1:] or list(MAKERS)
    unknown = [name for name in names if name not in MAKERS]
    if unknown:
        sys.exit(f"{', '.join(unknown)}: expected some of {', '.join(MAKERS)}")
    for name in names:
        print(f"--- {name}", flush=True)
        MAKERS[name]()


if __name__ == "__main__":
    main()
