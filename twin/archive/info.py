"""Contents of a run's file, from its index where there is one."""

from __future__ import annotations

from dataclasses import dataclass, field
from os import PathLike
from pathlib import Path

from twin.archive import run_metadata as meta
from twin.archive.container.frames import DAMAGE, RunFile
from twin.archive.container.integrity import FileIndex, check_data, checked_index
from twin.archive.reader import Decoder
from twin.errors import ArchiveError
from twin.record import RunHeader, RunSummary


@dataclass(frozen=True, slots=True, kw_only=True)
class RunInfo:
    """Contents of a run's file.

    Attributes:
        path: the file.
        header: first record of the run.
        summary: None if the file ends before it.
        counts: number of messages on each topic.
        duration_s: machine time that the file covers.
        complete: whether the program was replayed to its end.
        intact: whether the file itself is complete; False for the file of a killed run, and for a damaged file.
        damage: what is wrong in the file, with its name and position; None if nothing was found. ``counts`` are then
            those of the records that could be read.
        attachments: size in bytes of every attached file, by name.
    """

    path: Path
    header: RunHeader
    summary: RunSummary | None
    counts: dict[str, int]
    duration_s: float
    complete: bool
    intact: bool
    damage: str | None
    attachments: dict[str, int]


def run_info(path: str | PathLike[str], *, verify: bool = False) -> RunInfo:
    """Contents of a run's file: read from its index if it is whole, else from all of it.

    The index, the counts and every record's frame are checked in any case; a damaged file gives what can be read of it.

    Args:
        verify: read every record and check every checksum.

    Raises:
        ArchiveError: not the file of a run, or its header cannot be read.
    """
    with RunFile(path) as file:
        decoder = Decoder(file)
        header = decoder.header()
        found = _Contents()
        try:
            found.read(file, verify=verify)
        except ArchiveError as error:
            found.damage = str(error)
        if found.index is None or found.damage is not None:
            found.read_all(decoder)
        whole = found.damage is None and file.footer() is not None
        summary = found.summary
        return RunInfo(
            path=file.path,
            header=header,
            summary=summary,
            counts=found.counts,
            duration_s=summary.machine_time_s if summary else found.end_ns * 1e-9,
            complete=bool(summary and summary.complete and whole),
            intact=whole,
            damage=found.damage,
            attachments={a.name: len(a.data) for a in header.attachments},
        )


@dataclass(slots=True)
class _Contents:
    """Summary and counts, from the index of a file or from its records."""

    index: FileIndex | None = None
    summary: RunSummary | None = None
    counts: dict[str, int] = field(default_factory=dict)
    end_ns: int = 0
    damage: str | None = None

    def read(self, file: RunFile, *, verify: bool) -> None:
        """Check the file, and read summary and counts by its index.

        Raises:
            ArchiveError: damaged.
        """
        self.index = checked_index(file)
        if verify:
            check_data(file)
            for _ in Decoder(file).records():
                pass
        if self.index is not None:
            self.summary = _summary_at(file, self.index)
            self.counts = self.index.counts
            self.end_ns = self.index.statistics.message_end_time if self.index.statistics else 0

    def read_all(self, decoder: Decoder) -> None:
        """Read all records, up to the first that is damaged."""
        try:
            for record in decoder.readable():
                if isinstance(record, RunSummary):
                    self.summary = record
        except ArchiveError as error:
            self.damage = self.damage or str(error)
        self.counts, self.end_ns = dict(decoder.counts), decoder.end_ns


def _summary_at(file: RunFile, index: FileIndex) -> RunSummary | None:
    """The run's summary, from its position in the index.

    Raises:
        ArchiveError: damaged.
    """
    offset = index.metadata.get(meta.SUMMARY)
    if offset is None:
        return None
    try:
        return meta.to_summary(file.values(next(file.frames(offset)))[1])
    except (*DAMAGE, StopIteration) as error:
        raise file.damaged(offset, "the summary of the run cannot be read") from error
