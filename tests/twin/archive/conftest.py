"""A small run with every kind of record, and what it means that two records are the same."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable, Iterable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from twin.record import (
    Attachment,
    Collision,
    Engagement,
    ForceSamples,
    NcEvent,
    Record,
    RunHeader,
    RunSummary,
    Step,
    ToolRecord,
    ToolSummary,
    WorkpiecePatch,
)
from twin.sinks.mcap_sink import McapSink

DT_S = 1 / 21600
Steps = Callable[..., list[Step]]
Write = Callable[..., Path]


def make_header() -> RunHeader:
    profile = np.array([[0.0, 0.0], [2.0, 0.5], [4.0, 4.0], [4.0, 20.0], [6.0, 20.0], [6.0, 40.0]])
    return RunHeader(
        twin_version="0.1.0",
        program="slot.nc",
        stock_bounds_mm=np.array([[0.0, 0.0, -20.0], [60.0, 60.0, 0.0]]),
        slice_pitch_mm=(0.1, 0.1, 0.05),
        tools=(
            ToolRecord(number=1, description="ball D8 z2", profile_mm=profile),
            ToolRecord(number=12, description="flat Ø4 z3", profile_mm=profile[2:]),
        ),
        planned_time_s=61.7,
        parameters={"cutting.Ktc": "935.62", "program.file": "slot.nc"},
        attachments=(
            Attachment(name="slot.nc", media_type="text/plain", data=b"%\nN10 G1 X60 F200\n%\n"),
            Attachment(name="job.toml", media_type="application/toml", data=b""),
        ),
    )


def storable(values: np.ndarray) -> np.ndarray:
    """Forces of a step as a file can hold them: whole multiples of a power of two, about a millionth of the largest."""
    exponent = np.frexp(np.abs(values).max(initial=0.0))[1]
    return np.ldexp(np.rint(np.ldexp(values, 20 - exponent)), exponent - 20)


def make_step(index: int, samples: int = 5, tool: int = 1, seed: int = 0) -> Step:
    rng = np.random.default_rng([seed, index])
    t_s = (index * 5 + np.arange(samples)) * DT_S
    return Step(
        index=index,
        t_s=index * 5 * DT_S,
        duration_s=5 * DT_S,
        start_mm=(0.1 * index, -1 / 3, -2.0),
        end_mm=(0.1 * index + 0.1, -1 / 3, -2.0),
        nc_line=3 + index // 4,
        tool=tool,
        rapid=samples == 0,
        feed_mm_min=200.0,
        spindle_rpm=-3600.0,
        engagement=Engagement(axial_depth_mm=2.0, arc_rad=np.pi, chip_thickness_mm=0.02, cutting=True)
        if samples
        else Engagement(),
        samples=ForceSamples(
            t_s=t_s,
            spindle_angle_rad=-t_s * 120 * np.pi,
            force_n=storable(rng.normal(0.0, 50.0, (samples, 3))),
            torque_nm=storable(rng.uniform(0.0, 1.0, samples)),
            power_w=storable(rng.uniform(0.0, 300.0, samples)),
        ),
    )


def make_patch(t_s: float, name: str, seed: int, n: int = 7) -> WorkpiecePatch:
    rng = np.random.default_rng(seed)
    axes = np.concatenate([np.eye(3, dtype=np.float32), 0.0 - np.eye(3, dtype=np.float32)])
    return WorkpiecePatch(
        t_s=t_s,
        patch=name,
        vertices_mm=rng.normal(0.0, 30.0, (n, 3)).astype(np.float32),
        normals=axes[rng.integers(0, 6, n)],
        triangles=rng.integers(0, max(n, 1), (2 * n, 3), dtype=np.uint32),
    )


def make_summary(complete: bool = True) -> RunSummary:
    force = (1.5, 2.5, 3.5, 1 / 3)
    tool = ToolSummary(
        number=1,
        description="ball D8 z2",
        cutting_time_s=1.0,
        air_time_s=0.5,
        rapid_time_s=0.25,
        removed_volume_mm3=7.1,
        peak_force_n=force,
        mean_force_n=force,
        peak_torque_nm=0.4,
        mean_torque_nm=0.2,
        peak_power_w=150.0,
        peak_line=4,
    )
    return RunSummary(
        complete=complete,
        machine_time_s=0.0125,
        cutting_time_s=0.01,
        removed_volume_mm3=7.1,
        steps=40,
        samples=200,
        peak_force_n=force,
        mean_force_n=force,
        collisions=1,
        tools=(tool,),
        top_lines=((4, "N10 G1 X60 F200 (Schlichten, größer)", 66.5), (3, "", 1.0)),
        digest="3b0c",
    )


def make_run(steps: int = 12, samples: int = 5) -> list[Record]:
    """Every kind of record: events before and between steps, a rapid without samples, a tool change, patches."""
    kinds = ("block", "tool", "spindle", "coolant", "stop", "dwell", "notice")
    run: list[Record] = [make_header()]
    run += [NcEvent(t_s=0.0, nc_line=i + 1, kind=kind, text=f"{i}: text of {kind}") for i, kind in enumerate(kinds)]
    run += [make_patch(0.0, "x0_y0", 1), make_patch(0.0, "x0_y1", 2)]
    for index in range(steps):
        step = make_step(index, samples=0 if index == 2 else samples, tool=1 if index < 6 else 12)
        if index == 6:
            run.append(make_patch(step.t_s, "x0_y1", 3, n=0))
            run.append(
                Collision(
                    t_s=step.t_s,
                    nc_line=4,
                    tool=12,
                    kind="shank",
                    point_mm=(0.1, -0.2, 1 / 3),
                    volume_mm3=0.7,
                    message="slot.nc:4: shank of T12 in the stock at X0.1 Y-0.2 Z0.333",
                )
            )
        run.append(step)
    return [*run, make_summary()]


def assert_same(got: Any, wanted: Any, at: str = "") -> None:
    """Same type and same value, bit for bit, down to the last array."""
    assert type(got) is type(wanted), at
    if dataclasses.is_dataclass(got):
        for f in dataclasses.fields(got):
            assert_same(getattr(got, f.name), getattr(wanted, f.name), f"{at}.{f.name}")
    elif isinstance(got, np.ndarray):
        assert (got.dtype, got.shape, got.tobytes()) == (wanted.dtype, wanted.shape, wanted.tobytes()), at
        assert not got.flags.writeable, at
    elif isinstance(got, list | tuple):
        assert len(got) == len(wanted), at
        for i, pair in enumerate(zip(got, wanted, strict=True)):
            assert_same(*pair, f"{at}[{i}]")
    else:
        assert got == wanted, at


@pytest.fixture
def run_records() -> list[Record]:
    return make_run()


@pytest.fixture
def same() -> Callable[..., None]:
    return assert_same


@pytest.fixture
def new_step() -> Callable[..., Step]:
    return make_step


@pytest.fixture
def write(tmp_path: Path) -> Write:
    """Writes records to a file in a fresh folder and tells its path."""

    def to_file(records: Iterable[Record], name: str = "run.mcap") -> Path:
        with McapSink(tmp_path / name) as sink:
            for record in records:
                sink.write(record)
        return tmp_path / name

    return to_file
