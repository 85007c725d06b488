"""Contents of a run's file, from its index where there is one."""

from __future__ import annotations

from dataclasses import dataclass
from os import PathLike
from pathlib import Path

from mcap.opcode import Opcode
from mcap.records import Channel, Metadata, MetadataIndex, Statistics

from twin.archive import run_metadata as meta
from twin.archive.frames import DAMAGE, RunFile, stream
from twin.archive.reader import Decoder
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
        intact: whether the file itself is complete; False for the file of a killed run.
        attachments: size in bytes of every attached file, by name.
    """

    path: Path
    header: RunHeader
    summary: RunSummary | None
    counts: dict[str, int]
    duration_s: float
    complete: bool
    intact: bool
    attachments: dict[str, int]


def run_info(path: str | PathLike[str]) -> RunInfo:
    """Contents of a run's file: read from its index if it is complete, else from all of it.

    Raises:
        ArchiveError: as `read_run`.
    """
    with RunFile(path) as file:
        decoder = Decoder(file)
        header = decoder.header()
        footer = file.footer()
        if footer is None or not footer.summary_start:
            summary = _last_summary(decoder)
            counts, end_ns = dict(decoder.counts), decoder.end_ns
        else:
            try:
                summary, counts, end_ns = _from_index(file, footer.summary_start)
            except DAMAGE as error:
                raise file.damaged(footer.summary_start) from error
        return RunInfo(
            path=file.path,
            header=header,
            summary=summary,
            counts=counts,
            duration_s=summary.machine_time_s if summary else end_ns * 1e-9,
            complete=bool(summary and summary.complete and footer),
            intact=footer is not None,
            attachments={a.name: len(a.data) for a in header.attachments},
        )


def _last_summary(decoder: Decoder) -> RunSummary | None:
    """Read all records, for their counts; returns the summary if there is one."""
    found = None
    for record in decoder.records():
        found = record if isinstance(record, RunSummary) else found
    return found


def _from_index(file: RunFile, start: int) -> tuple[RunSummary | None, dict[str, int], int]:
    """Run summary, messages by topic, and last log time, from the summary section."""
    topics: dict[int, str] = {}
    statistics = summary = None
    for frame in file.frames(start):
        if frame.opcode == Opcode.CHANNEL:
            channel = Channel.read(stream(frame.body))
            topics[channel.id] = channel.topic
        elif frame.opcode == Opcode.STATISTICS:
            statistics = Statistics.read(stream(frame.body))
        elif frame.opcode == Opcode.METADATA_INDEX:
            index = MetadataIndex.read(stream(frame.body))
            if index.name == meta.SUMMARY:
                frame_there = next(file.frames(index.offset), None)
                if frame_there is None:
                    raise ValueError(f"no metadata at byte {index.offset}")
                summary = meta.to_summary(Metadata.read(stream(frame_there.body)).metadata)
    if statistics is None:
        return summary, {}, 0
    counts = {topics[c]: n for c, n in statistics.channel_message_counts.items()}
    return summary, counts, statistics.message_end_time
