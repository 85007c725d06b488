"""Bounds on unpacked sizes: a file of a few kB may claim, or unpack to, more than the memory holds."""

from __future__ import annotations

from pathlib import Path

from twin.errors import MeasuredError

#: Always allowed, bytes.
_FREE_BYTES = 1 << 28
#: Bytes that one byte of a file may unpack to beyond that: measured forces are noise, and do not pack this tightly.
_MOST_FACTOR = 16


def most_bytes(path: Path) -> int:
    """The bytes that a file may unpack to."""
    return max(_FREE_BYTES, _MOST_FACTOR * path.stat().st_size)


def check_size(path: Path, claimed: float, what: str) -> None:
    """Refuse a size before anything is unpacked.

    Args:
        claimed: bytes.
        what: subject of the message.

    Raises:
        MeasuredError: too large for the file.
    """
    if claimed > most_bytes(path):
        raise MeasuredError(
            f"{path}: {what} would unpack to {claimed / 1e9:.3g} GB, from a file of {path.stat().st_size / 1e6:.3g} "
            f"MB, expected at most {most_bytes(path) / 1e9:.3g} GB: the file is damaged"
        )
