"""Files that ``twin reach`` writes: a recording, meshes, a picture."""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING

from twin.errors import ArchiveError, MeshError

if TYPE_CHECKING:
    from twin.cam.reach.reach import Reach
    from twin.cam.slices.sections import SlicedPart


def check(rrd: Path | None, mesh: Path | None, plot: Path | None, tools: Sequence[str], *, force: bool) -> None:
    """Refuse outputs that could not be written, before long work.

    Raises:
        ArchiveError, MeshError: a file that is there, a suffix without a writer, a folder that is not there.
    """
    for path, suffix in ((rrd, ".rrd"), (plot, ".png")):
        if path is None:
            continue
        if path.suffix.lower() != suffix:
            raise ArchiveError(f"{path}: expected a file name that ends in {suffix}")
        if path.exists() and not force:
            raise ArchiveError(f"{path}: is there already; expected a new name, or leave to replace it (--force)")
        if not path.parent.is_dir():
            raise ArchiveError(f"{path}: there is no folder {path.parent}; expected one that exists")
    if mesh is not None:
        if mesh.exists() and not mesh.is_dir():
            raise MeshError(f"{mesh}: is a file; expected a folder for meshes")
        for path in (mesh / _file_name(text) for text in tools):
            if path.exists() and not force:
                raise MeshError(f"{path}: is there already; expected a new name, or leave to replace it (--force)")


@contextmanager
def progress_line() -> Iterator[Callable[[str], None]]:
    """A line on the terminal that says what is being worked on; nothing where standard error is none."""
    if not sys.stderr.isatty():
        yield lambda _: None
        return
    from twin.cli.console import errors

    with errors().status("slicing") as status:
        yield lambda text: status.update(text)


def write(
    sliced: SlicedPart,
    reaches: dict[str, Reach],
    rrd: Path | None,
    mesh: Path | None,
    plot: Path | None,
    *,
    force: bool,
) -> None:
    """Write what was asked for; a tool that leaves nothing has no mesh."""
    if mesh is not None:
        _write_meshes(reaches, mesh, force=force)
    if rrd is not None:
        from twin.cli.show.stills import reaches_still
        from twin.sinks.rerun.still import write_still

        write_still(rrd, reaches_still(reaches, sliced.mesh), force=force)
    if plot is not None:
        from twin.cli.show.reach_plot import write_plot

        write_plot(plot, sliced, reaches)


def _write_meshes(reaches: dict[str, Reach], folder: Path, *, force: bool) -> None:
    from twin.cam.reach.uncut_mesh import uncut_mesh
    from twin.workpiece.mesh_file import write_mesh

    folder.mkdir(parents=True, exist_ok=True)
    for text, reach in reaches.items():
        if reach.uncut_regions:
            write_mesh(folder / _file_name(text), uncut_mesh(reach.uncut_regions), force=force)


def _file_name(text: str) -> str:
    from twin.cli.show.stills import entity_name

    return f"{entity_name(text)}.stl"
