"""One declaration of how a log is read and corrected: the same keys everywhere, in the forms that users write."""

from __future__ import annotations

import inspect
from typing import Any

import pytest
from pydantic import BaseModel

from twin.cli.commands.logs.compare import compare
from twin.comparison.batch import BatchRow
from twin.errors import SettingsError
from twin.identification.cuts.cuts_file import Cut, Shared
from twin.job.job_file import Measured
from twin.measured.settings import CompareSettings, LogCorrections, LogReading
from twin.settings.check import checked


@pytest.mark.parametrize("model", [Measured, BatchRow, CompareSettings, Cut, Shared])
def test_every_file_has_every_key_of_reading(model: type[BaseModel]) -> None:
    for name, field in LogReading.model_fields.items():
        other = model.model_fields[name]
        assert (other.annotation, other.default, other.description) == (
            field.annotation,
            field.default,
            field.description,
        )


@pytest.mark.parametrize("model", [Measured, BatchRow])
def test_jobs_and_batches_have_every_correction(model: type[BaseModel]) -> None:
    assert set(model.model_fields) >= {*LogCorrections.model_fields, "windows"}


def test_the_command_has_an_option_for_every_key() -> None:
    assert set(inspect.signature(compare).parameters) >= set(CompareSettings.model_fields)


@pytest.mark.parametrize(
    ("key", "written", "kept"),
    [
        ("windows", [[4.0, 4.02], "8.00:8.02"], ("4.0:4.02", "8.00:8.02")),
        ("windows", "4.00:4.02 8.00:8.02", ("4.00:4.02", "8.00:8.02")),
        ("offset", [1.2, -0.4, 3], "1.2,-0.4,3"),
        ("offset", [0.0, 0.5], "0.0:0.5"),
        ("lag_s", "auto", None),
        ("lag_s", "0.0123 s", 0.0123),
        ("notches", [700, "1400:20"], ("700", "1400:20")),
        ("columns", "t_s, Fx_N,Fy_N ,Fz_N", ("t_s", "Fx_N", "Fy_N", "Fz_N")),
        ("delimiter", "tab", "\t"),
        ("delimiter", "|", "|"),
    ],
)
def test_forms_that_users_write(key: str, written: Any, kept: Any) -> None:
    assert getattr(CompareSettings.model_validate({key: written}), key) == kept


def test_values_behind_the_texts() -> None:
    settings = CompareSettings(
        map="x=-Fy", windows=("4:5", "6:7"), offset="0:0.5", notches=("700:20",), lowpass_hz=900.0, causal=True
    )
    assert settings.axis_map is not None and settings.axis_map.entries == (("x", "-Fy"),)
    assert settings.spans == ((4.0, 5.0), (6.0, 7.0)) and settings.zero == (0.0, 0.5)
    notch, lowpass = settings.filters
    assert (notch.kind, notch.hz, notch.quality, notch.phase) == ("notch", 700.0, 20.0, "causal")
    assert (lowpass.kind, lowpass.hz, lowpass.phase) == ("lowpass", 900.0, "causal")
    assert CompareSettings().axis_map is None and CompareSettings().filters == ()


def test_cells_of_a_table_are_texts() -> None:
    cells = {
        "run": "a.mcap",
        "measured": "a.csv",
        "rate_hz": "1e3",
        "drift": "yes",
        "notches": "700 900:5",
        "lag_s": "1",
    }
    row = checked(BatchRow, cells, "table.csv", strict=False)
    assert (row.rate_hz, row.drift, row.notches, row.lag_s) == (1000.0, True, ("700", "900:5"), 1.0)
    with pytest.raises(
        SettingsError, match=r'table.toml: rate_hz = "1e3": expected a number above 0 \(sampling rate, Hz\)'
    ):
        checked(BatchRow, cells | {"drift": True}, "table.toml")
