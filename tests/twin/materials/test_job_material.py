"""A job that names a material has the numbers of its row; its own keys win."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import jsonschema
import pytest
from support.job_files import NOTHING, job_data

from twin.errors import JobError
from twin.job import Job, job_from_dict, job_schema
from twin.materials import find_material

ROW = find_material("Al7075-T6")
NAMES = ("Ktc", "Kte", "Krc", "Kre", "Kac", "Kae")


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    (tmp_path / "slot.nc").write_text("M30\n")
    return tmp_path


def job(folder: Path, **cutting: Any) -> Job:
    return job_from_dict(job_data(cutting=cutting), folder)


def test_a_name_stands_for_the_numbers_of_its_row(folder: Path) -> None:
    cutting = job(folder, material="al 7075 t6").cutting
    assert cutting is not None and cutting.material == "Al7075-T6" and cutting.source == ROW.source
    assert [getattr(cutting, n) for n in NAMES] == [getattr(ROW, n) for n in NAMES]


def test_own_keys_win_and_the_source_reports_them(folder: Path) -> None:
    cutting = job(folder, material="Al7075-T6", Ktc=900.0).cutting
    assert cutting is not None and cutting.Ktc == 900.0 and cutting.Krc == ROW.Krc
    assert cutting.source == f"{ROW.source}; changed in the job: Ktc"
    cutting = job(folder, material="Al7075-T6", Ktc=900.0, source="own test").cutting
    assert cutting is not None and cutting.source == "own test"


def test_a_tool_has_its_own_material(folder: Path) -> None:
    data = job_data(cutting=NOTHING, tools__1__cutting={"material": "7075"})
    one, other = (job_from_dict(data, folder).coefficients(tool) for tool in job_from_dict(data, folder).tools)
    assert one is None and other is not None and other.Ktc == ROW.Ktc


def test_with_material_replaces_the_coefficients_of_all_tools(folder: Path) -> None:
    data = job_data(tools__1__cutting={"material": "7075", "Ktc": 1.0})
    changed = job_from_dict(data, folder).with_material("7075")
    assert [c.Ktc for tool in changed.tools if (c := changed.coefficients(tool))] == [ROW.Ktc] * 2


@pytest.mark.parametrize(
    ("cutting", "problem"),
    [
        (
            {"material": "Al7057-T6"},
            'cutting.material = "Al7057-T6": expected a name of the table (twin materials): did',
        ),
        ({"material": 3}, "cutting.material = 3: expected text"),
        ({"material": "7075", "mt": 0.2}, 'cutting.mt = 0.2: expected 0 without cutting.law = "kienzle"'),
        (
            {"material": "7075", "chip_range_mm": [0.2, 0.1]},
            "cutting.chip_range_mm = [0.2, 0.1]: expected [lowest, highe",
        ),
        ({"source": "x"}, "cutting.Ktc: missing"),
    ],
)
def test_mistakes(folder: Path, cutting: dict[str, Any], problem: str) -> None:
    with pytest.raises(JobError) as caught:
        job(folder, **cutting)
    assert caught.value.problems[0].startswith(problem)


def test_the_schema_takes_a_material_in_place_of_the_numbers(folder: Path) -> None:
    check = jsonschema.Draft202012Validator(job_schema())
    assert check.is_valid(job_data(cutting={"material": "Al7075-T6"}))
    assert not check.is_valid(job_data(cutting={"source": "x"}))
    assert check.is_valid(job_data())
