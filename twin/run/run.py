"""A replayed or opened run, backed by its archive."""

from __future__ import annotations

import shutil
import tempfile
import weakref
from collections.abc import Iterator, Mapping
from functools import cached_property
from os import PathLike
from pathlib import Path
from types import MappingProxyType
from typing import TYPE_CHECKING, Any, TypeAlias

from numpy.typing import NDArray

from twin.archive import RunInfo, read_forces, read_run, run_info
from twin.archive.container.partial import copy_file
from twin.archive.export import force_records
from twin.archive.force_table import array_batches, joined_arrays
from twin.errors import ArchiveError
from twin.record import Collision, NcEvent, Record, RunHeader, RunSummary, WorkpiecePatch
from twin.run.interrupted import summary_of
from twin.run.patches import joined
from twin.settings.force_on import ForceOn
from twin.sinks.outputs import opened
from twin.workpiece.to_mesh import SurfaceMesh

if TYPE_CHECKING:
    import pyarrow as pa

Forces: TypeAlias = Mapping[str, NDArray[Any]]


class TemporaryArchive:
    """A file for a run that is not to be kept; removed with this object, at the latest when Python ends.

    Attributes:
        path: the file, in a folder of its own.
    """

    def __init__(self) -> None:
        folder = Path(tempfile.mkdtemp(prefix="twin-"))
        self.path = folder / "run.mcap"
        weakref.finalize(self, shutil.rmtree, folder, ignore_errors=True)


class Run:
    """One run: what `twin.replay` computed, or what `twin.open_run` found in an archive.

    Every run is backed by an MCAP archive on the disk, from which forces, events and the part are read when they are
    asked for, and then kept. So the memory in use does not grow with the program until ``forces`` is used (72 bytes a
    sample), and a replayed run and an opened one are the same in every respect. The archive of a replay that was given
    no ``mcap`` file is a temporary one (in the folder of `tempfile`, set by ``TMPDIR``), removed with the run; `save`
    keeps it.

    Units are mm, s, N, N·m, W and rad. Forces act on the tool, in machine axes.

    Attributes:
        path: the archive.
        header: program, stock, tools, settings and attached files.
        complete: whether the program was replayed to its end.
        intact: whether the archive itself is whole; False for what a killed replay left.

    Examples:
        >>> run = twin.open_run("slot.mcap")
        >>> run.summary.peak_force_n
        (41.1, 61.1, 23.6, 66.5)
        >>> run.forces["fx_n"].mean()
        -7.3
    """

    def __init__(self, archive: str | PathLike[str] | TemporaryArchive) -> None:
        self._archive = archive
        self.path = archive.path if isinstance(archive, TemporaryArchive) else Path(archive)
        self._info: RunInfo = run_info(self.path)
        if self._info.damage is not None:
            raise ArchiveError(self._info.damage)
        self.header: RunHeader = self._info.header
        self.complete: bool = self._info.complete
        self.intact: bool = self._info.intact

    @cached_property
    def summary(self) -> RunSummary:
        """Times, removed volume, peak and mean forces, by tool and in total; lines with the highest force; digest.

        The archive of a replay that was killed holds no summary: it is then summed up from the records that are there,
        with ``complete`` False, an empty ``digest``, and removed volumes that are not known (nan).
        """
        return self._info.summary or summary_of(self.records())

    @cached_property
    def forces(self) -> Forces:
        """Every force sample, one a spindle-angle step, as read-only arrays of shape (n,) by name.

        - ``t_s``: machine time from program start,
        - ``spindle_angle_rad``: continuous through the program, 0 at its start with tooth 0 at +x; falling under M4,
        - ``fx_n``, ``fy_n``, ``fz_n``: force on the tool, machine axes,
        - ``torque_nm``, ``power_w``: what the spindle supplies,
        - ``nc_line``, ``tool``: line of the NC program and tool number, int32.

        The names are those of ``twin export`` and of `to_arrow`.

        Raises:
            ArchiveError: the archive is damaged, or was written with ``[output] samples = "revolution"``.
        """
        columns = joined_arrays(force_records(self.path))
        for values in columns.values():
            values.flags.writeable = False
        return MappingProxyType(columns)

    @cached_property
    def events(self) -> tuple[NcEvent | Collision, ...]:
        """NC events (blocks, tool changes, spindle, coolant, stops, words without effect) and collisions, in order."""
        return tuple(record for record in self.records() if isinstance(record, NcEvent | Collision))

    @property
    def collisions(self) -> tuple[Collision, ...]:
        """The collisions among the events."""
        return tuple(event for event in self.events if isinstance(event, Collision))

    def records(self) -> Iterator[Record]:
        """The records of the run one by one, in order, with little memory: `RunHeader` first, `RunSummary` last.

        Between them come `NcEvent`, `Step`, `Collision` and `WorkpiecePatch` records in the order of machine time. The
        summary is missing where a killed replay did not come to it.

        Raises:
            ArchiveError: the archive is damaged, or is not there any more.
        """
        yield from read_run(self.path)

    def mesh(self) -> SurfaceMesh:
        """The machined part as triangles, in workpiece coordinates, mm: its surface as last recorded.

        The fineness is the job's ``simulation.preview_pitch_mm``. `twin.write_mesh` writes it as STL or 3MF.
        """
        last = {r.patch: r for r in self.records() if isinstance(r, WorkpiecePatch)}
        return joined(last.values())

    def to_arrow(self, on: ForceOn = "tool") -> pa.Table:
        """Every force sample as an Arrow table with the columns of ``forces``.

        Args:
            on: body on which the force acts, ``"tool"`` or ``"workpiece"`` (opposite sign).
        """
        return read_forces(self.path, on)

    def save(self, path: str | PathLike[str], *, force: bool = False) -> Path:
        """Write the run's archive, byte for byte what ``twin replay`` writes.

        Args:
            path: file that ends in ``.mcap``; missing folders above it are made.
            force: replace a file that exists.

        Returns:
            The file's path.

        Raises:
            ArchiveError: a wrong suffix, a file that exists, or one that cannot be written.
        """
        return copy_file(self.path, Path(path), force=force)

    def view(self, *, rrd: str | PathLike[str] | None = None, force: bool = False) -> None:
        """Show the run in the rerun viewer: part, tool and path in 3D, forces below, NC blocks alongside.

        Args:
            rrd: write a recording here instead of opening the viewer.
            force: replace a recording that exists.

        Raises:
            ArchiveError: a recording that exists, or cannot be written.
            TwinError: the viewer cannot be started.
        """
        target = None if rrd is None else Path(rrd)
        with opened(None, target, view=target is None, force=force) as write:
            for record in self.records():
                write(record)

    def __repr__(self) -> str:
        s = self.summary
        forces = f"peak {s.peak_force_n[3]:.1f} N, {s.samples} samples" if s.samples else "no forces"
        return f"<Run of {self.header.program}: {self._extent()}, {forces}, {s.collisions} collisions>"

    def _extent(self) -> str:
        """How much of the program the run covers."""
        planned_s, here_s = self.header.planned_time_s, self.summary.machine_time_s
        if self.complete:
            return f"{here_s:.1f} s"
        return f"{'ended early' if self.intact else 'cut off'} at {here_s:.1f} of {planned_s:.1f} s"

    def _repr_html_(self) -> str:
        """The run in a notebook: a line, a table by tool, a plot of the forces."""
        from twin.run.notebook import run_html

        kept = self.__dict__.get("forces")
        batches = array_batches(self.records()) if kept is None else [kept]
        return run_html(self.header.program, self._extent(), self.summary, batches)
