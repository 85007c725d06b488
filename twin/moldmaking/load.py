"""Read a mold job, check everything that can be checked without the part, and report every mistake at once."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from os import PathLike
from pathlib import Path
from typing import Any

from pydantic import ValidationError

from twin.errors import JobError, ToolError
from twin.job.library import with_library_tools
from twin.moldmaking.model import MoldFile, MoldJob
from twin.settings.extremes import extremes, numbers_in
from twin.settings.problems import Problem, missing, problems_of, wrong
from twin.settings.toml_file import read_toml
from twin.tools.shape import ToolShape, tool_shape

_STAGES = ("rough", "semi", "finish")


def load_mold(path: str | PathLike[str]) -> MoldJob:
    """Read a mold job.

    Raises:
        JobError: the file cannot be read, is not TOML, or has mistakes; the message lists all of them.
    """
    path = Path(path)
    data, _ = read_toml(path, "a mold job", JobError, own="part")
    return _job(data, path)


def mold_from_dict(data: Mapping[str, Any], folder: str | PathLike[str] = ".") -> MoldJob:
    """Make a mold job from tables as `tomllib` returns them.

    Raises:
        JobError: see `load_mold`.
    """
    return _job(data, Path(folder) / "mold.toml")


def shape_of(job: MoldFile, number: int) -> ToolShape:
    """Shape of the cutting part of a tool."""
    tool = next(t for t in job.tools if t.number == number)
    return tool_shape(
        tool.kind, tool.diameter_mm, tool.flute_length_mm, tool.corner_radius_mm or 0.0, tool.taper_deg or 0.0
    )


def _job(data: Mapping[str, Any], path: Path) -> MoldJob:
    data, unknown = with_library_tools(data, path.parent)
    try:
        file = MoldFile.model_validate(data)
    except ValidationError as error:
        found = [str(p) for p in (*unknown, *problems_of(error.errors(include_url=False), MoldFile))]
        raise JobError(str(path), found) from error
    if unknown:
        raise JobError(str(path), [str(p) for p in unknown])
    problems = [
        *extremes(numbers_in(data), MoldFile),
        *_tool_problems(file),
        *_stage_problems(file),
        *_stock_problems(file, path.parent),
    ]
    if problems:
        raise JobError(str(path), [str(p) for p in problems])
    return _joined(file, path)


def _joined(file: MoldFile, path: Path) -> MoldJob:
    folder = path.parent
    values = dict(file)
    values["part"] = file.part.model_copy(update={"stl": folder / file.part.stl})
    values["output"] = file.output.model_copy(update={"folder": folder / file.output.folder})
    return MoldJob(**values, path=path)


def _tool_problems(file: MoldFile) -> Iterator[Problem]:
    """Tools with duplicate numbers or impossible shapes."""
    if not file.tools:
        yield wrong(("tools",), [], "at least one table [[tools]]")
    seen: set[int] = set()
    for index, tool in enumerate(file.tools):
        if tool.number in seen:
            yield wrong(("tools", index, "number"), tool.number, "a unique number")
        seen.add(tool.number)
        try:
            shape_of(file, tool.number)
        except ToolError as error:
            yield Problem(("tools", index), f": {error}", tool.number)


def _stage_problems(file: MoldFile) -> Iterator[Problem]:
    """Tools that are missing or too large, depths beyond the tool radius, allowances that grow, and no stepover."""
    known = {t.number: t for t in file.tools}
    last: tuple[str, float] | None = None
    for name in _STAGES:
        stage = getattr(file, name)
        if stage.tool not in known:
            listed = ", ".join(map(str, known)) or "none is given"
            yield wrong((name, "tool"), stage.tool, f"the number of a tool: {listed}")
            continue
        diameter = known[stage.tool].diameter_mm
        if last is not None and diameter > last[1]:
            expected = f"a tool no larger than that of [{last[0]}], D{last[1]:g}: it would reach nothing more"
            yield wrong((name, "tool"), stage.tool, f"{expected}, got D{diameter:g}")
        last = (name, diameter)
        radial = getattr(stage, "radial_depth_mm", None)
        if radial is not None and radial > 0.5 * diameter:
            yield wrong(
                (name, "radial_depth_mm"), radial, f"at most {0.5 * diameter:g}, the radius of tool {stage.tool}"
            )
    if file.semi.allowance_mm > file.rough.allowance_mm:
        expected = f"at most rough.allowance_mm = {file.rough.allowance_mm:g}, the allowance of roughing"
        yield wrong(("semi", "allowance_mm"), file.semi.allowance_mm, expected)
    if (file.finish.stepover_mm is None) == (file.finish.scallop_mm is None):
        yield missing(
            ("finish", "stepover_mm"), "either stepover_mm or scallop_mm, which set the distance between rows"
        )


def _stock_problems(file: MoldFile, folder: Path) -> Iterator[Problem]:
    """A part file that is missing, or a stock without extent."""
    stl = folder / file.part.stl
    if not stl.is_file():
        why = "is a folder" if stl.is_dir() else "does not exist"
        yield wrong(("part", "stl"), str(file.part.stl), f"an STL file; {stl} {why}")
    box = file.stock.box_mm
    if box is not None:
        for axis, low, high in zip("xyz", box.min, box.max, strict=True):
            if not low < high:
                yield wrong(("stock", "box_mm", "max"), high, f"above {low:g} along {axis}")
        if file.stock.top_mm:
            yield wrong(("stock", "top_mm"), file.stock.top_mm, "no value where box_mm is given")
