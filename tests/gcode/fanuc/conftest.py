"""Short ways to look at what a program of a FANUC or Haas control leaves behind."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import pytest

from gcode.dialects import dialect_named
from gcode.errors import GcodeError
from gcode.events import LinearMotion, Motion, Point
from gcode.flow.runner import Runner
from gcode.language.program import program_of
from gcode.settings import MachineSettings


def _raise(error: GcodeError) -> None:
    raise error


@pytest.fixture
def value() -> Callable[..., float | None]:
    """Value of a variable after a program: ``value("#100=2*3")``; #100 unless `index` says otherwise."""

    def value_of(text: str, index: int = 100, dialect: str = "fanuc", **settings: Any) -> float | None:
        runner = Runner(program_of(text, "t.nc"), dialect_named(dialect), MachineSettings(**settings), _raise)
        for _ in runner.run():
            pass
        return runner.session.variables.number(index)

    return value_of


@pytest.fixture
def ends(motions: Callable[..., list[Motion]]) -> Callable[..., list[Point]]:
    """Where the motions of a program end, machine coordinates, mm."""

    def ends_of(text: str, dialect: str = "fanuc", **settings: Any) -> list[Point]:
        return [motion.end_mm for motion in motions(text, dialect, **settings)]

    return ends_of


@pytest.fixture
def strokes(motions: Callable[..., list[Motion]]) -> Callable[..., list[str]]:
    """The motions of a program in short: ``R`` rapid or ``F`` feed and the end, e.g. ``R 5 0 10``."""

    def strokes_of(text: str, dialect: str = "fanuc", **settings: Any) -> list[str]:
        told = []
        for motion in motions(text, dialect, **settings):
            rapid = isinstance(motion, LinearMotion) and motion.rapid
            told.append(" ".join(["R" if rapid else "F", *(f"{round(x, 9) + 0.0:g}" for x in motion.end_mm)]))
        return told

    return strokes_of
