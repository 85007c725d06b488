"""Tools of a program by number from a tool library."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path

from twin.drafting.notes import Notes
from twin.drafting.tool_words import ToolStatement
from twin.drafting.tools import DraftTool


def library_tools(
    file: Path, used: Sequence[int], stated: Mapping[int, ToolStatement], notes: Notes
) -> dict[int, DraftTool]:
    """The tools of a library that a program uses."""
    raise NotImplementedError
