"""Rules between the tables of a job file, and between the file and the files it names."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import TypeAlias

from twin.job.facts import tools_of
from twin.job.job_file import RAPIDS
from twin.job.limits import LIMITS
from twin.job.stock_keys import STOCKS
from twin.job.tool_rules import TOOL_RULES
from twin.settings.facts import Facts
from twin.settings.problems import Location, Problem, key_path, wrong

Rule: TypeAlias = Callable[[Facts, Path], Iterator[Problem]]

_MESH_ONLY = ("unit", "stl_scale", "offset_mm")
#: Angles to propose in place of one that does not divide a turn.
_EVEN_ANGLES_DEG = (0.1, 0.2, 0.25, 0.5, *(float(n) for n in range(1, 361) if 360 % n == 0))


def one_stock(facts: Facts, _folder: Path) -> Iterator[Problem]:
    """The stock is given once; keys of a mesh are given only with a mesh."""
    if facts.wrong("stock"):
        return
    given = [key for key in STOCKS if facts.given("stock", key)]
    expected = "exactly one of " + ", ".join(STOCKS)
    if not given:
        yield Problem(("stock",), f" is empty: expected {expected}")
    elif len(given) > 1:
        yield Problem(("stock",), f" has {' and '.join(given)}: expected {expected}")
    elif given != ["stl"]:
        for key in _MESH_ONLY:
            if facts.given("stock", key) and not facts.doubtful("stock", key):
                yield wrong(("stock", key), facts.get("stock", key), "it only with stock.stl")


def box_has_extent(facts: Facts, _folder: Path) -> Iterator[Problem]:
    """A box's upper corner is above its lower one on every axis."""
    low, high = facts.get("stock", "box_mm", "min"), facts.get("stock", "box_mm", "max")
    if low is None or high is None:
        return
    for index, axis in enumerate("xyz"):
        if not low[index] < high[index]:
            expected = f"above stock.box_mm.min[{index}] = {low[index]:g} (the box's extent along {axis})"
            yield wrong(("stock", "box_mm", "max", index), high[index], expected)


def cylinder_has_extent(facts: Facts, _folder: Path) -> Iterator[Problem]:
    """A cylinder's upper end is above its lower one."""
    low, high = facts.get("stock", "cylinder_mm", "min"), facts.get("stock", "cylinder_mm", "max")
    if low is not None and high is not None and not low < high:
        yield wrong(("stock", "cylinder_mm", "max"), high, f"above stock.cylinder_mm.min = {low:g}")


def stock_offset_known(facts: Facts, _folder: Path) -> Iterator[Problem]:
    """The work offset of the stock is among those of the machine."""
    wcs, offsets = facts.get("stock", "wcs"), facts.get("machine", "offsets")
    if wcs is not None and offsets is not None and wcs not in offsets:
        known = ", ".join(offsets) or "none is given"
        yield wrong(("stock", "wcs"), wcs, f"one of the offsets in machine.offsets: {known}")


def axis_rapids_sound(facts: Facts, _folder: Path) -> Iterator[Problem]:
    """Rates of single axes are given only where the axes move independently."""
    rates = facts.get("machine", "axis_rapid_mm_min")
    if rates is None:
        return
    path = facts.get("machine", "rapid") or RAPIDS.get(facts.get("program", "dialect") or "")
    if path == "straight":
        yield wrong(("machine", "axis_rapid_mm_min"), rates, 'it only with machine.rapid = "independent"')


def some_tool(facts: Facts, _folder: Path) -> Iterator[Problem]:
    """There is a tool to cut with."""
    if not facts.wrong("tools") and facts.count("tools") == 0:
        yield wrong(("tools",), [], "at least one table [[tools]]")


def tool_numbers_differ(facts: Facts, _folder: Path) -> Iterator[Problem]:
    """No two tools have one number."""
    first: dict[int, int] = {}
    for index, tool in enumerate(tools_of(facts)):
        if tool.number is None:
            continue
        if tool.number in first:
            expected = f"a unique number, tools[{first[tool.number]}] already has it"
            yield wrong(tool.at("number"), tool.number, expected)
        first.setdefault(tool.number, index)


def tools_are_sound(facts: Facts, _folder: Path) -> Iterator[Problem]:
    """The rules between the keys of one tool."""
    for tool in tools_of(facts):
        for rule in TOOL_RULES:
            yield from rule(tool)


def first_tool_known(facts: Facts, _folder: Path) -> Iterator[Problem]:
    """The tool in the spindle at the start is among the tools."""
    number, tools = facts.get("program", "tool"), list(tools_of(facts))
    known = [tool.number for tool in tools]
    if number and None not in known and number not in known:
        yield wrong(("program", "tool"), number, f"0 or the number of a tool: {', '.join(map(str, known))}")


def angle_divides_turn(facts: Facts, _folder: Path) -> Iterator[Problem]:
    """Samples are at the same angles in every revolution."""
    angle = facts.get("simulation", "angle_step_deg")
    if angle is None:
        return
    count = 360.0 / angle
    if not math.isfinite(count) or abs(count - round(count)) > 1e-9 * count:
        nearest = min(_EVEN_ANGLES_DEG, key=lambda even: abs(even - angle))
        expected = f"an angle that divides 360 evenly, e.g. {nearest:g}"
        yield wrong(("simulation", "angle_step_deg"), angle, expected)


def laws_are_sound(facts: Facts, _folder: Path) -> Iterator[Problem]:
    """Exponents belong to Kienzle's law; ranges of validity have an extent."""
    tables: list[Location] = [("cutting",), *(tool.at("cutting") for tool in tools_of(facts))]
    for table in tables:
        if facts.get(*table, "law") != "kienzle":
            for key in ("mt", "mr", "ma"):
                if facts.get(*table, key):
                    yield wrong((*table, key), facts.get(*table, key), f'0 without {key_path(table)}.law = "kienzle"')
        for key in ("chip_range_mm", "speed_range_m_min"):
            interval = facts.get(*table, key)
            if interval is not None and not 0.0 <= interval[0] <= interval[1]:
                yield wrong((*table, key), interval, "[lowest, highest], the lowest at least 0")


def files_are_there(facts: Facts, folder: Path) -> Iterator[Problem]:
    """The program and the mesh exist."""
    for location, what in ((("program", "file"), "an NC program"), (("stock", "stl"), "an STL file")):
        name = facts.get(*location)
        if name is None:
            continue
        path = folder / name
        if not path.is_file():
            why = "is a folder" if path.is_dir() else "does not exist"
            yield wrong(location, name, f"{what}; {path} {why}")


def outputs_named_rightly(facts: Facts, _folder: Path) -> Iterator[Problem]:
    """Outputs have the suffix that viewers go by."""
    for key in ("mcap", "rrd"):
        name = facts.get("output", key)
        if name is not None and Path(name).suffix.lower() != f".{key}":
            yield wrong(("output", key), name, f"a file name that ends in .{key}")


RULES: tuple[Rule, ...] = (
    files_are_there,
    one_stock,
    box_has_extent,
    cylinder_has_extent,
    stock_offset_known,
    axis_rapids_sound,
    some_tool,
    tool_numbers_differ,
    first_tool_known,
    tools_are_sound,
    angle_divides_turn,
    laws_are_sound,
    *LIMITS,
    outputs_named_rightly,
)
