"""Rules between the keys of one tool."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator

from twin.job.facts import ToolFacts
from twin.settings.problems import Problem, missing, wrong

#: Which kinds need a key (True), may have it (False), or must not have it (not listed).
_SHAPE_KEYS = {
    "corner_radius_mm": {"bull": True, "taper": False},
    "taper_deg": {"taper": True},
}
_WHAT = {"corner_radius_mm": "the corner radius of a bull tool", "taper_deg": "the half angle of a taper tool"}
#: How far the teeth's pitch angles may be from 360 degrees in all, deg.
_FULL_TURN_DEG = 1e-6


def shape_keys(tool: ToolFacts) -> Iterator[Problem]:
    """Corner radius and taper angle are there for the kinds that have them, and for no other."""
    kind = tool.get("kind")
    if kind is None:
        return
    for key, needed in _SHAPE_KEYS.items():
        if needed.get(kind, False) and not tool.given(key):
            yield missing(tool.at(key), f"{_WHAT[key]}", tool.number)
        if kind not in needed and tool.given(key):
            kinds = " or ".join(needed)
            yield wrong(tool.at(key), tool.get(key), f"no such key for a {kind} tool, only for {kinds}", tool.number)


def corner_fits(tool: ToolFacts) -> Iterator[Problem]:
    """A corner radius is at most half the diameter."""
    corner, diameter = tool.get("corner_radius_mm"), tool.get("diameter_mm")
    if corner is None or diameter is None or tool.get("kind") not in _SHAPE_KEYS["corner_radius_mm"]:
        return
    if corner > 0.5 * diameter:
        expected = f"at most {0.5 * diameter:g}, half the diameter"
        yield wrong(tool.at("corner_radius_mm"), corner, expected, tool.number)


def corner_below_flutes_end(tool: ToolFacts) -> Iterator[Problem]:
    """The rounded part of the tool lies within its flutes."""
    kind, diameter, flutes = tool.get("kind"), tool.get("diameter_mm"), tool.get("flute_length_mm")
    if kind is None or diameter is None or flutes is None:
        return
    corner = 0.5 * diameter if kind == "ball" else tool.get("corner_radius_mm") or 0.0
    height = corner * (1.0 - math.sin(math.radians(tool.get("taper_deg") or 0.0)))
    if flutes < height * (1.0 - 1e-12):
        expected = f"at least {height:g}, the height of the rounded part"
        yield wrong(tool.at("flute_length_mm"), flutes, expected, tool.number)


def pitch_angles(tool: ToolFacts) -> Iterator[Problem]:
    """One angle above 0 a tooth, a full turn in all."""
    pitch, teeth = tool.get("pitch_deg"), tool.get("teeth")
    if pitch is None:
        return
    if teeth is not None and len(pitch) != teeth:
        expected = f"{teeth} angles, one a tooth (teeth = {teeth}), got {len(pitch)}"
        yield wrong(tool.at("pitch_deg"), pitch, expected, tool.number)
    elif min(pitch, default=0.0) <= 0.0 or abs(sum(pitch) - 360.0) > _FULL_TURN_DEG:
        expected = f"angles above 0 that sum to 360, got {sum(pitch):g}"
        yield wrong(tool.at("pitch_deg"), pitch, expected, tool.number)


def runout_within_tool(tool: ToolFacts) -> Iterator[Problem]:
    """The spindle axis passes through the cutter."""
    runout, diameter = tool.get("runout_mm"), tool.get("diameter_mm")
    if runout is not None and diameter is not None and runout >= 0.5 * diameter:
        expected = f"below {0.5 * diameter:g}, half the diameter"
        yield wrong(tool.at("runout_mm"), runout, expected, tool.number)


TOOL_RULES: tuple[Callable[[ToolFacts], Iterator[Problem]], ...] = (
    shape_keys,
    corner_fits,
    corner_below_flutes_end,
    pitch_angles,
    runout_within_tool,
)
