"""Rules between the keys of a file of test cuts, and between the file and the files it names."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any, TypeAlias

from twin.job.facts import ToolFacts
from twin.job.tool_rules import TOOL_RULES
from twin.settings.facts import Facts
from twin.settings.problems import Location, Problem, missing, wrong

Rule: TypeAlias = Callable[[Facts, Path], Iterator[Problem]]

_GEOMETRY = ("direction", "axial_depth_mm", "spindle_rpm", "feed_mm_min")
_RUN_KEYS = ("run_window_s", "lag_s")
_LOG_KEYS = ("window_s", "air_s", "spindle_angle_deg")
_WHAT = {
    "direction": 'slot, "up" or "down" (or job = "...")',
    "axial_depth_mm": "the axial depth of cut in mm",
    "radial_depth_mm": "the radial depth of cut in mm",
    "spindle_rpm": "the spindle speed in rpm",
    "feed_mm_min": "the feed in mm/min",
}
#: A radial depth within this part of the diameter is a whole slot.
_SAME = 1e-6


class CutFacts:
    """One cut's values, with the defaults where it gives none."""

    def __init__(self, facts: Facts, index: int) -> None:
        self._facts = facts
        self._index = index

    def at(self, key: str) -> Location:
        """Location of a key: in the cut, or in the defaults."""
        own = ("cuts", self._index, key)
        return own if self.given(key) or not self._facts.given("defaults", key) else ("defaults", key)

    def given(self, key: str) -> bool:
        """Whether the cut itself gives a key."""
        return self._facts.given("cuts", self._index, key)

    def get(self, key: str) -> Any:
        """The value, None where there is none or it is wrong."""
        return self._facts.get(*self.at(key))

    def absent(self, key: str) -> bool:
        """Whether neither cut nor defaults give a key."""
        return not self._facts.given(*self.at(key))


def cuts_of(facts: Facts) -> Iterator[CutFacts]:
    """The cuts one by one."""
    for index in range(facts.count("cuts")):
        if not facts.wrong("cuts", index):
            yield CutFacts(facts, index)


def some_cut(facts: Facts, _folder: Path) -> Iterator[Problem]:
    """There is a cut."""
    if not facts.wrong("cuts") and facts.count("cuts") == 0:
        yield wrong(("cuts",), [], "at least one table [[cuts]]")


def tool_is_sound(facts: Facts, _folder: Path) -> Iterator[Problem]:
    """The rules of a job's tool, and a tool where a cut needs one."""
    if facts.given("tool"):
        for rule in TOOL_RULES:
            yield from rule(_OneTool(facts))
    elif any(not cut.given("job") for cut in cuts_of(facts)):
        yield missing(("tool",), "the tool of the cuts, keys as in a job file's [[tools]]")


class _OneTool(ToolFacts):
    """The tool of a file that has one."""

    def __init__(self, facts: Facts) -> None:
        self._facts = facts
        self.number = None

    def at(self, *keys: str | int) -> Location:
        return ("tool", *keys)


def engagement_given(facts: Facts, _folder: Path) -> Iterator[Problem]:
    """A cut is a job, or has its direction, depths, speed and feed."""
    for cut in cuts_of(facts):
        if cut.given("job"):
            for key in (*_GEOMETRY, "radial_depth_mm"):
                if cut.given(key):
                    yield wrong(cut.at(key), cut.get(key), "no such key with job")
            continue
        for key in _GEOMETRY:
            if cut.absent(key):
                yield missing(cut.at(key), _WHAT[key])
        if cut.absent("radial_depth_mm") and cut.get("direction") in ("up", "down"):
            yield missing(cut.at("radial_depth_mm"), _WHAT["radial_depth_mm"])


def depths_fit(facts: Facts, _folder: Path) -> Iterator[Problem]:
    """Depths lie within the tool."""
    diameter, flutes = facts.get("tool", "diameter_mm"), facts.get("tool", "flute_length_mm")
    for cut in cuts_of(facts):
        axial, radial, direction = cut.get("axial_depth_mm"), cut.get("radial_depth_mm"), cut.get("direction")
        if cut.given("job"):
            continue
        if axial is not None and flutes is not None and axial > flutes:
            yield wrong(cut.at("axial_depth_mm"), axial, f"at most {flutes:g}, tool.flute_length_mm")
        if radial is None or diameter is None or direction is None:
            continue
        if direction == "slot" and abs(radial - diameter) > _SAME * diameter:
            expected = f'{diameter:g}, the diameter, for a slot (or direction = "up" or "down")'
            yield wrong(cut.at("radial_depth_mm"), radial, expected)
        elif radial > diameter * (1.0 + _SAME):
            yield wrong(cut.at("radial_depth_mm"), radial, f"at most {diameter:g}, the diameter")


def one_measurement(facts: Facts, _folder: Path) -> Iterator[Problem]:
    """A cut has a log or a mean force, and only keys that go with it."""
    for cut in cuts_of(facts):
        given = [key for key in ("log", "mean_force_n") if cut.given(key)]
        if len(given) != 1:
            at = cut.at("log")
            yield Problem(at[:-1], f" has {' and '.join(given) or 'neither'}: expected one of log and mean_force_n")
        elif given == ["mean_force_n"]:
            for key in _LOG_KEYS:
                if cut.given(key):
                    yield wrong(cut.at(key), cut.get(key), "it only with log")
        elif cut.given("mean_error_n"):
            yield wrong(cut.at("mean_error_n"), cut.get("mean_error_n"), "it only with mean_force_n")
        for key in _RUN_KEYS:
            if cut.given(key) and not cut.given("job"):
                yield wrong(cut.at(key), cut.get(key), "it only with job")


def errors_above_zero(facts: Facts, _folder: Path) -> Iterator[Problem]:
    """Standard errors are positive."""
    for cut in cuts_of(facts):
        errors = cut.get("mean_error_n")
        if errors is not None and min(errors) <= 0.0:
            yield wrong(cut.at("mean_error_n"), errors, "three numbers above 0")


def windows_in_order(facts: Facts, _folder: Path) -> Iterator[Problem]:
    """Windows begin before they end."""
    seen: set[Location] = set()
    for cut in cuts_of(facts):
        for key in ("window_s", "run_window_s"):
            window, at = cut.get(key), cut.at(key)
            if window is not None and not window[0] < window[1] and at not in seen:
                seen.add(at)
                yield wrong(at, list(window), "from, to with from below to")
        for window in cut.get("air_s") or ():
            if not window[0] < window[1] and cut.at("air_s") not in seen:
                seen.add(cut.at("air_s"))
                yield wrong(cut.at("air_s"), list(window), "from, to with from below to")


def files_are_there(facts: Facts, folder: Path) -> Iterator[Problem]:
    """Logs and jobs exist."""
    for cut in cuts_of(facts):
        for key, what in (("log", "a measured log"), ("job", "a job file")):
            name = cut.get(key)
            if name is not None and not (folder / name).is_file():
                why = "is a folder" if (folder / name).is_dir() else "does not exist"
                yield wrong(cut.at(key), name, f"{what}; {folder / name} {why}")


def bounds_in_order(facts: Facts, _folder: Path) -> Iterator[Problem]:
    """Lower bounds are below upper ones, and the start lies between."""
    lower, upper, start = (facts.get("fit", key) or {} for key in ("lower", "upper", "start"))
    for name in {**lower, **upper, **start}:
        low, high, at = lower.get(name), upper.get(name), start.get(name)
        if low is not None and high is not None and not low < high:
            yield wrong(("fit", "upper", name), high, f"above fit.lower.{name} = {low:g}")
        elif at is not None and ((low is not None and at < low) or (high is not None and at > high)):
            yield wrong(("fit", "start", name), at, "a value within the bounds")


RULES: tuple[Rule, ...] = (
    some_cut,
    tool_is_sound,
    engagement_given,
    depths_fit,
    one_measurement,
    errors_above_zero,
    windows_in_order,
    files_are_there,
    bounds_in_order,
)
