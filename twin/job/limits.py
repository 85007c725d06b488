"""Limits of the numbers of a job that set memory or the number of steps."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from pathlib import Path

from twin.job.facts import tools_of
from twin.settings.facts import Facts
from twin.settings.problems import Problem, wrong
from twin.workpiece.slice_limit import least_pitch_mm

#: Finest angle between force samples, deg.
_LEAST_ANGLE_DEG = 0.01
#: Slowest rapids, mm/min.
_LEAST_RAPID_MM_MIN = 0.001
#: Finest step of the tool, in slice pitches.
_LEAST_STEP_PITCHES = 0.01
#: Most cells of the workpiece as drawn along its longest side.
_MOST_CELLS = 2000
#: Most edge elements of a tool times force samples per revolution.
_MOST_MAP = 4_000_000
#: An axial step that is not given is never too coarse, mm.
_DEFAULT_AXIAL_MM = 0.1


def numbers_sensible(facts: Facts, _folder: Path) -> Iterator[Problem]:
    """A number beyond any quantity of a machine would end in infinite results."""
    return facts.extremes()


def _stock_extent_mm(facts: Facts) -> Sequence[float] | None:
    """The box of a stock, where the job file alone determines it."""
    low, high = facts.get("stock", "box_mm", "min"), facts.get("stock", "box_mm", "max")
    if low is not None and high is not None:
        return [b - a for a, b in zip(low, high, strict=True)]
    bottom, top = facts.get("stock", "cylinder_mm", "min"), facts.get("stock", "cylinder_mm", "max")
    diameter, axis = facts.get("stock", "cylinder_mm", "diameter"), facts.get("stock", "cylinder_mm", "axis")
    if None in (bottom, top, diameter, axis):
        return None
    return [top - bottom if a == axis else diameter for a in "xyz"]


def pitch_below_tools(facts: Facts, _folder: Path) -> Iterator[Problem]:
    """A tool thinner than the distance of the slices would pass between them."""
    pitch = facts.get("simulation", "slice_pitch_mm")
    sizes = [(d, tool.number) for tool in tools_of(facts) if (d := tool.get("diameter_mm")) is not None]
    if pitch is None or not sizes:
        return
    thinnest, number = min(sizes, key=lambda size: size[0])
    if pitch > thinnest:
        whose = f"tool {number}" if number is not None else "a tool"
        expected = f"at most {thinnest:g}, the diameter of {whose}: it would pass between the slices"
        yield wrong(("simulation", "slice_pitch_mm"), pitch, expected)


def slices_fit(facts: Facts, _folder: Path) -> Iterator[Problem]:
    """A pitch whose slices do not fit in memory is a mistake."""
    pitch, extent = facts.get("simulation", "slice_pitch_mm"), _stock_extent_mm(facts)
    if pitch is None or extent is None or min(extent) <= 0.0:
        return
    least = least_pitch_mm(extent)
    if pitch < least:
        expected = f"at least {least:.2g}, finer slices of this stock do not fit in memory"
        yield wrong(("simulation", "slice_pitch_mm"), pitch, expected)


def drawing_fits(facts: Facts, _folder: Path) -> Iterator[Problem]:
    """A workpiece drawn in millions of cells is a mistake."""
    pitch, extent = facts.get("simulation", "preview_pitch_mm"), _stock_extent_mm(facts)
    if pitch is not None and extent is not None and max(extent) / pitch > _MOST_CELLS:
        expected = f"at least {max(extent) / _MOST_CELLS:.2g}, {_MOST_CELLS} cells along the stock's longest side"
        yield wrong(("simulation", "preview_pitch_mm"), pitch, expected)


def steps_countable(facts: Facts, _folder: Path) -> Iterator[Problem]:
    """Steps far below the slice pitch find nothing new."""
    step, pitch = facts.get("simulation", "step_mm"), facts.get("simulation", "slice_pitch_mm")
    if step is not None and pitch is not None and step < _LEAST_STEP_PITCHES * pitch:
        expected = f"at least {_LEAST_STEP_PITCHES * pitch:.3g}, a hundredth of simulation.slice_pitch_mm"
        yield wrong(("simulation", "step_mm"), step, expected)


def edges_fit(facts: Facts, _folder: Path) -> Iterator[Problem]:
    """Samples of a revolution and elements of an edge fit in memory."""
    angle, axial = facts.get("simulation", "angle_step_deg"), facts.get("simulation", "axial_step_mm")
    if angle is None:
        return
    if angle < _LEAST_ANGLE_DEG:
        yield wrong(("simulation", "angle_step_deg"), angle, f"at least {_LEAST_ANGLE_DEG:g}")
        return
    if axial is None:
        return
    sizes = [
        (flutes + 0.5 * diameter, tool.number)
        for tool in tools_of(facts)
        if (flutes := tool.get("flute_length_mm")) is not None and (diameter := tool.get("diameter_mm")) is not None
    ]
    longest, number = max(sizes, key=lambda size: size[0], default=(0.0, None))
    least = longest * 360.0 / angle / _MOST_MAP
    if axial < least:
        whose = f"tool {number}" if number is not None else "a tool"
        expected = f"at least {least:.2g}, finer edge elements of {whose} do not fit in memory"
        yield wrong(("simulation", "axial_step_mm"), axial, expected)


def edges_divided(facts: Facts, _folder: Path) -> Iterator[Problem]:
    """An edge of one element would be engaged as a whole or not at all."""
    axial = facts.get("simulation", "axial_step_mm")
    flutes = [(f, tool.number) for tool in tools_of(facts) if (f := tool.get("flute_length_mm")) is not None]
    if axial is None or not flutes:
        return
    shortest, number = min(flutes, key=lambda flute: flute[0])
    if axial > max(0.5 * shortest, _DEFAULT_AXIAL_MM):
        whose = f"tool {number}" if number is not None else "a tool"
        expected = f"at most {0.5 * shortest:g}, half the flute length of {whose}"
        yield wrong(("simulation", "axial_step_mm"), axial, expected)


def rapids_end(facts: Facts, _folder: Path) -> Iterator[Problem]:
    """Rapids come to an end."""
    rate = facts.get("machine", "rapid_mm_min")
    if rate is not None and rate < _LEAST_RAPID_MM_MIN:
        yield wrong(("machine", "rapid_mm_min"), rate, f"at least {_LEAST_RAPID_MM_MIN:g}")
    for index, rate in enumerate(facts.get("machine", "axis_rapid_mm_min") or ()):
        if rate < _LEAST_RAPID_MM_MIN:
            yield wrong(("machine", "axis_rapid_mm_min", index), rate, f"at least {_LEAST_RAPID_MM_MIN:g}")


#: Rules for the slice pitch, with those for tools and stock.
PITCH_LIMITS = (pitch_below_tools, slices_fit)
LIMITS = (numbers_sensible, rapids_end, *PITCH_LIMITS, drawing_fits, steps_countable, edges_fit, edges_divided)
