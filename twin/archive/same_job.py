"""Whether an output was made from a job file: only such an output is replaced without being asked."""

from __future__ import annotations

import hashlib
from pathlib import Path

from twin.archive.container.frames import RunFile
from twin.archive.reader import Decoder
from twin.errors import ArchiveError
from twin.record import Attachment

#: Digits of a key.
_DIGITS = 16
#: A recording's name is within its first bytes.
_RECORDING_HEAD = 4096


def job_key(job: Path) -> str:
    """A key of a job file's path, the same for every run of it; the path cannot be read from it.

    Args:
        job: the file; empty for a job that is in no file.
    """
    return hashlib.sha256(str(job.resolve()).encode()).hexdigest()[:_DIGITS] if job.is_file() else ""


def is_run_of(archive: Path, job: Path | None) -> bool:
    """Whether an archive is of a run of this job file: of the same path, or of the same name and text."""
    if job is None or not (key := job_key(job)):
        return False
    try:
        with RunFile(archive) as file:
            header = Decoder(file).header()
    except ArchiveError:
        return False
    return header.job == key or _same_text(header.attachments, job)


def is_recording_of(recording: Path, job: Path | None) -> bool:
    """Whether a rerun recording is of a run of this job file."""
    if job is None or not (key := job_key(job)):
        return False
    try:
        with recording.open("rb") as file:
            return key.encode() in file.read(_RECORDING_HEAD)
    except OSError:
        return False


def _same_text(attachments: tuple[Attachment, ...], job: Path) -> bool:
    try:
        return any(a.name == job.name and a.data == job.read_bytes() for a in attachments)
    except OSError:
        return False
