"""Tools of libraries as tables of a job file."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence

from twin.settings.toml_text import toml_value
from twin.tool_library.assemble import cleaned
from twin.tool_library.library_tool import LibraryTool

#: What a job needs and a library may lack, with a remark.
_REQUIRED = {
    "number": "not in the library; required",
    "teeth": "not in the library; required",
    "flute_length_mm": "not in the library; required",
    "helix_deg": "not in the library; 0 if it is not given",
}


def job_text(tools: Sequence[LibraryTool], heading: str) -> str:
    """Tables ``[[tools]]`` of a job file; tools that cannot be simulated are comments.

    Keys that the library lacks are commented lines, to be filled in.

    Args:
        tools: the tools.
        heading: first line, a comment.
    """
    return "\n".join([f"# {cleaned(heading)}", "", *_blocks(tools)])


def _blocks(tools: Iterable[LibraryTool]) -> Iterator[str]:
    for tool in tools:
        if tool.obstacle:
            yield f"# {tool.title} cannot be simulated: {tool.obstacle}\n"
            continue
        yield from (f"# {cleaned(text)}" for text in (tool.source, *tool.notes, *tool.warnings))
        yield "[[tools]]"
        table = tool.as_job_table()
        for key, value in table.items():
            yield f"{key} = {toml_value(value)}"
        yield from (f"# {key} =    # {remark}" for key, remark in _REQUIRED.items() if key not in table)
        yield ""
