"""Numbers beyond any quantity of a machine are refused by name, in each table of settings and in texts with numbers."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import annotated_types as at
import pytest
from pydantic import BaseModel

from tests.support.compared import log_of, run
from tests.support.job_files import job_data, job_folder
from tests.support.small_parts import box
from twin.cam.slices.sections import slice_part
from twin.comparison.delay import simulated_at_rate
from twin.drafting.settings import DraftSettings
from twin.errors import CutsError, JobError, MeasuredError, SettingsError, ToolPathError
from twin.identification.cuts.load import cuts_from_dict
from twin.job import job_from_dict, load_job
from twin.measured.filters import Filter, parse_notch
from twin.measured.settings import CompareSettings
from twin.measured.spans import parse_offset
from twin.measured.uniform import resample
from twin.planning.paths import prepare
from twin.planning.settings import PathSettings, ReachSettings
from twin.settings.check import checked
from twin.settings.keys import bare, fields_of
from twin.verification.settings import VerifySettings

MODELS: tuple[type[BaseModel], ...] = (CompareSettings, DraftSettings, PathSettings, ReachSettings, VerifySettings)
REQUIRED = {PathSettings: {"strategy": "scan", "tool": "ball 8"}}


@pytest.mark.parametrize("model", MODELS)
def test_every_number_of_a_table_has_limits(model: type[BaseModel]) -> None:
    for name, field in fields_of(model).items():
        if bare(field.annotation) in (int, float):
            positive = any(isinstance(note, at.Gt) for note in field.metadata)
            small = [1e-320] if positive and bare(field.annotation) is float else []
            for value in [10**400 if bare(field.annotation) is int else 1e300, *small]:
                with pytest.raises(SettingsError, match=rf"given: .*\b{name}\b"):
                    checked(model, {**REQUIRED.get(model, {}), name: value}, "given")


@pytest.mark.parametrize("value", [1e12, -1e300])
def test_numbers_in_lists_and_tables_have_limits(value: float) -> None:
    with pytest.raises(SettingsError, match=r"region_mm\[2\] = .*: expected at most 1e\+09 in magnitude"):
        checked(VerifySettings, {"region_mm": (0.0, 0.0, abs(value), 1.0)}, "given")
    with pytest.raises(JobError, match=r"offsets.G54\[1\] = .*: expected at most 1e\+09 in magnitude"):
        job_from_dict(job_data(machine__offsets__G54=[0.0, value, 0.0]))
    with pytest.raises(CutsError, match=r"fit.start.Kae = .*: expected at most 1e\+09 in magnitude"):
        cuts_from_dict({"fit": {"start": {"Kae": value}}}, Path("cuts.toml"))


@pytest.mark.parametrize(
    ("made", "message"),
    [
        (Filter(kind="lowpass", hz=1e-320), "expected it below half the sampling rate, 2500 Hz, and at least 0.005 Hz"),
        (parse_notch("1e-9:5"), "and at least 0.005 Hz"),
        (parse_notch("50:inf"), "expected it 0.005 to 2500 Hz wide, a quality of 0.02 to 1e\\+04"),
        (parse_notch("50:1e-9"), "quality 1e-09: expected it"),
    ],
)
def test_filters_of_next_to_no_width_are_refused(made: Filter, message: str) -> None:
    with pytest.raises(MeasuredError, match=message):
        made.apply(log_of(run()).force_n, 5000.0)


def test_a_rate_that_makes_millions_of_samples_is_refused() -> None:
    with pytest.raises(MeasuredError, match=r"rate 1e\+06 Hz makes 7.6e\+06 samples, expected at most 4000000"):
        resample(log_of(run()), 1e6)


def test_the_simulation_at_next_to_no_rate_takes_little_memory() -> None:
    assert simulated_at_rate(run(), 0.0, 2, 1e-9).shape == (2, 3)


@pytest.mark.parametrize("text", ["nan,0,0", f"0,{'9' * 400},0", "1:1e300"])
def test_zeros_and_spans_are_finite(text: str) -> None:
    with pytest.raises(MeasuredError, match=r"expected (forces|times) of at most 1e\+09"):
        parse_offset(text)


@pytest.mark.parametrize(
    ("values", "message"),
    [
        ({"overhang_mm": 1e8}, "points of rows; expected at most 1e\\+08"),
        ({"tolerance_mm": 1e8}, r"tolerance_mm = 1e\+08: expected at most 2, the radius"),
        ({"layers": 10**8}, "points of rows; expected at most 1e\\+08"),
        ({"strategy": "contour", "axial_depth_mm": 1e-7}, "make 2e\\+07 levels of 1 layers; expected at most 10000"),
        ({"strategy": "contour", "layers": 10**6}, "levels of 1000000 layers; expected at most 10000"),
    ],
)
def test_paths_without_end_are_refused(values: dict[str, Any], message: str) -> None:
    part = slice_part(box((0.0, 0.0, -2.0), (6.0, 6.0, 0.0)), 1.0)
    with pytest.raises(ToolPathError, match=message):
        prepare(checked(PathSettings, {"strategy": "scan", "tool": "flat 4", "pitch_mm": 1.0} | values, "given"), part)


def test_a_pitch_for_a_job_that_was_read_suits_its_tools(tmp_path: Path) -> None:
    with pytest.raises(JobError, match=r"slice_pitch_mm = 100\.0: expected at most 8, the diameter of tool 1"):
        load_job(job_folder(tmp_path)).with_simulation(slice_pitch_mm=100.0)
