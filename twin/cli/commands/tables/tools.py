"""``twin tools``."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Literal

import typer

from twin.cli.common import Force

if TYPE_CHECKING:
    from twin.tool_library import LibraryTool, ToolLibrary

_SUFFIXES = (".toml", ".csv")


def tools(
    files: Annotated[list[Path], typer.Argument(metavar="FILE...", help="Tool libraries.", show_default=False)],
    number: Annotated[
        int | None, typer.Option("--number", metavar="N", help="Only tools with this number.", show_default=False)
    ] = None,
    name: Annotated[
        str | None,
        typer.Option("--name", metavar="TEXT", help="Only tools with this text in their names.", show_default=False),
    ] = None,
    unit: Annotated[Literal["mm", "inch"], typer.Option("--unit", help="Unit of a library that states none.")] = "mm",
    output: Annotated[
        Path | None,
        typer.Option("-o", "--output", metavar="FILE", help="Write the tools as tables of a job (.toml) or as .csv."),
    ] = None,
    force: Force = False,
    as_json: Annotated[bool, typer.Option("--json", help="Print one JSON object in place of the table.")] = False,
) -> None:
    """List, check and convert tool libraries: Fusion 360, FreeCAD, LinuxCNC, Vectric, CAMotics, DIN 4000, CSV.

    A job uses a tool of a library by from = "FILE" and the tool's number or name in a table of its tools. Ends with
    exit code 1 if a library has values that cannot be right; these are listed and not used.
    """
    from twin.cli.console import print_json, results, warn
    from twin.cli.show.tool_tables import print_tools, print_written, tools_object
    from twin.errors import ToolLibraryError
    from twin.tool_library import read_tool_library

    _check_output(output, force=force)
    libraries = [read_tool_library(file, unit) for file in files]
    chosen = [(library, _chosen(library, number, name)) for library in libraries]
    if not any(found for _, found in chosen):
        raise ToolLibraryError(_none(libraries, number, name))
    for library, found in chosen:
        for tool in found:
            for warning in tool.warnings:
                warn(f"{library.path}: {tool.title}: {warning}")
    every = [tool for _, found in chosen for tool in found]
    if output is not None:
        _write(output, every, ", ".join(file.name for file in files))
    if as_json:
        print_json(tools_object(chosen))
    elif output is None:
        print_tools(results(), chosen)
    else:
        print_written(results(), output, every)
    wrong = sum(bool(tool.warnings) for tool in every)
    if wrong:
        raise ToolLibraryError(f"values that cannot be right in {wrong} of {len(every)} tools; see the warnings")


def _chosen(library: ToolLibrary, number: int | None, name: str | None) -> list[LibraryTool]:
    """The tools of a number and with a text in their names."""
    text = None if name is None else name.casefold()
    return [
        tool
        for tool in library.tools
        if (number is None or tool.number == number) and (text is None or text in tool.name.casefold())
    ]


def _none(libraries: Sequence[ToolLibrary], number: int | None, name: str | None) -> str:
    asked = [f"the number {number}"] * (number is not None) + [f'"{name}" in its name'] * (name is not None)
    files = ", ".join(str(library.path) for library in libraries)
    return f"{files}: no tool has {' and '.join(asked)}; list all with: twin tools {files}"


def _check_output(output: Path | None, *, force: bool) -> None:
    from twin.errors import ToolLibraryError
    from twin.planning.output_files import check_outputs

    if output is None:
        return
    if output.suffix.lower() not in _SUFFIXES:
        raise ToolLibraryError(f"{output}: expected a file name that ends in {' or '.join(_SUFFIXES)}")
    check_outputs({"tools": output}, force=force)


def _write(output: Path, tools: Sequence[LibraryTool], files: str) -> None:
    from twin.archive.container.partial import replacing
    from twin.errors import ToolLibraryError
    from twin.tool_library.formats.plain_csv import csv_text
    from twin.tool_library.write import job_text

    as_csv = output.suffix.lower() == ".csv"
    text = csv_text(tools) if as_csv else job_text(tools, f"tools of {files}, for a job file")
    with replacing(output, ToolLibraryError) as partial:
        partial.write_text(text, encoding="utf-8", newline="\n")
