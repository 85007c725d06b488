"""Tools of a program by number from a tool library."""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path

from twin.drafting.comments.tool_words import ToolStatement
from twin.drafting.notes import Notes
from twin.drafting.tools import MILLS, DraftTool
from twin.errors import ToolLibraryError
from twin.tool_library import LibraryTool, ToolLibrary, read_tool_library

_SAME = 0.005


def library_tools(
    file: Path, used: Sequence[int], stated: Mapping[int, ToolStatement], notes: Notes
) -> dict[int, DraftTool]:
    """The tools of a library that a program uses, by number; a tool that is not in it is noted.

    Args:
        file: the library.
        used: numbers of the tools that cut.
        stated: what the program's comments state about them; a contradiction is noted, and the library counts.

    Raises:
        ToolLibraryError: a library that cannot be read, or two of its tools with a number that the program uses and
            none of which has the diameter of the program's comment.
    """
    library = read_tool_library(file)
    found = {}
    for number in used:
        states = stated.get(number, ToolStatement())
        tool = _pick(library, number, states, notes)
        if tool is not None and (tool.diameter_mm or states.diameter_mm) is not None:
            found[number] = _drafted(number, tool, states, notes, file.parent)
    return found


def _pick(library: ToolLibrary, number: int, states: ToolStatement, notes: Notes) -> LibraryTool | None:
    shared = library.shared_numbers.get(number, ())
    same = [tool for tool in shared if _same(tool.diameter_mm, states.diameter_mm)]
    if len(same) == 1:
        notes.assume(
            f"T{number}", f'"{same[0].name}"', f"{len(shared)} tools of the library have this number, one the diameter"
        )
        return same[0]
    if not shared and all(tool.number != number for tool in library.tools):
        try:
            library.find(number=number)
        except ToolLibraryError as error:
            instead = "the program's comment is used" if states.diameter_mm is not None else "its size is not known"
            notes.warnings.append(f"T{number}: {error}; {instead}")
        return None
    return library.find(number=number)


def _drafted(number: int, tool: LibraryTool, states: ToolStatement, notes: Notes, folder: Path) -> DraftTool:
    notes.warnings += [f"T{number}: {text}" for text in tool.warnings]
    for note in tool.notes:
        notes.assume(f"T{number}", note, "the library")
    a, b = tool.diameter_mm, states.diameter_mm
    if a is not None and b is not None and not _same(a, b):
        notes.warnings.append(
            f"T{number}: the library has D{a:g} mm ({tool.title}), the program's comment D{b:g} mm ({states.name}); "
            "the library is used"
        )
    own = ToolStatement(
        number=number,
        name=tool.name,
        kind=tool.kind,
        diameter_mm=tool.diameter_mm or states.diameter_mm,
        corner_radius_mm=tool.corner_radius_mm,
        teeth=tool.teeth,
        helix_deg=tool.helix_deg,
        flute_length_mm=tool.flute_length_mm,
        angle_deg=tool.taper_deg,
        z_min_mm=states.z_min_mm,
    )
    if not tool.simulated:
        size = own.diameter_mm or 0.0
        notes.assume(f"T{number}", f"a cylinder of D{size:g} mm without forces", f"{tool.title}: {tool.obstacle}")
        own = replace(own, kind=tool.kind if tool.kind not in MILLS else "unknown")
    # the name of the file, not where a user keeps it: a run's archive holds the job
    source = tool.source.removeprefix(f"{folder}{os.sep}")
    table = {**tool.as_job_table(), "origin": f"{source}, {tool.title}"} if tool.simulated else None
    return DraftTool(number=number, states=own, known=True, library=table)


def _same(a: float | None, b: float | None) -> bool:
    return a is not None and b is not None and abs(a - b) <= _SAME * max(a, b)
