"""Text exports of Kistler DynoWare: delimited text below a header of settings."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

from twin.measured.table import Table
from twin.measured.text.reader import opening_of, parse_text, text_of

_SAMPLES = re.compile(r"^Samples per channel\s*:?\s*[:,;\t]+\s*(\d+)", re.IGNORECASE | re.MULTILINE)
_CYCLES = re.compile(r"^Cycles\s*:?\s*[:,;\t]+\s*(\d+)", re.IGNORECASE | re.MULTILINE)


def is_dynoware(path: Path) -> bool:
    """Whether a file begins as an export of DynoWare does."""
    return "DynoWare" in opening_of(path)[:200]


def read_dynoware(
    path: Path, *, columns: Sequence[str] | None = None, delimiter: str | None = None, decimal: str | None = None
) -> Table:
    """An export; its header's rate, number of samples and cycles are held against the rows.

    Raises:
        MeasuredError: as `twin.measured.text.reader.read_text`.
    """
    text = text_of(path)
    read = parse_text(path, text, columns=columns, delimiter=delimiter, decimal=decimal, format_name="DynoWare export")
    notes = list(read.notes)
    head = text[:4000]
    if (found := _SAMPLES.search(head)) and int(found[1]) != len(read.values):
        notes.append(f"{len(read.values)} samples of the {found[1]} recorded: an excerpt")
    if (found := _CYCLES.search(head)) and int(found[1]) > 1:
        notes.append(f"one of {found[1]} cycles")
    return replace(read, notes=tuple(notes))
