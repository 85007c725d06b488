"""Short ways to run a text and to look at what came out."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import pytest

import gcode.cli
from gcode.dialects import dialect_named
from gcode.errors import GcodeError
from gcode.events import PLANE_AXES, ArcMotion, Event, LinearMotion, Motion, Point
from gcode.flow.interpreter import interpret
from gcode.settings import MachineSettings

Run = Callable[..., list[Event]]
Motions = Callable[..., list[Motion]]
Refusal = Callable[..., GcodeError]


def run_text(text: str, dialect: str = "fanuc", **settings: Any) -> list[Event]:
    return list(interpret(text, file="t.nc", dialect=dialect_named(dialect), settings=MachineSettings(**settings)))


@pytest.fixture
def run() -> Run:
    """All events of a text: ``run(text, dialect, **settings)``."""
    return run_text


@pytest.fixture
def cli(capsys: pytest.CaptureFixture[str]) -> Callable[..., tuple[int, str, str]]:
    """Exit code, standard output and standard error of a command."""

    def call(*arguments: object) -> tuple[int, str, str]:
        code = gcode.cli.run([str(a) for a in arguments])
        captured = capsys.readouterr()
        return code, captured.out, captured.err

    return call


@pytest.fixture
def motions() -> Motions:
    """The motions of a text."""

    def motions_of(text: str, dialect: str = "fanuc", **settings: Any) -> list[Motion]:
        return [e for e in run_text(text, dialect, **settings) if isinstance(e, LinearMotion | ArcMotion)]

    return motions_of


@pytest.fixture
def refusal() -> Refusal:
    """The error that refuses a text."""

    def refusal_of(text: str, dialect: str = "fanuc", **settings: Any) -> GcodeError:
        with pytest.raises(GcodeError) as caught:
            run_text(text, dialect, **settings)
        return caught.value

    return refusal_of


@pytest.fixture
def point_at() -> Callable[[ArcMotion, float], Point]:
    """Point of an arc at a part of its sweep, by turning the start about the centre."""

    def point(arc: ArcMotion, part: float) -> Point:
        i, j, k = PLANE_AXES[arc.plane]
        angle = arc.sweep_rad * part
        u, v = arc.start_mm[i] - arc.centre_mm[i], arc.start_mm[j] - arc.centre_mm[j]
        where = [0.0, 0.0, 0.0]
        where[i] = arc.centre_mm[i] + u * math.cos(angle) - v * math.sin(angle)
        where[j] = arc.centre_mm[j] + u * math.sin(angle) + v * math.cos(angle)
        where[k] = arc.start_mm[k] + part * (arc.end_mm[k] - arc.start_mm[k])
        return (where[0], where[1], where[2])

    return point
