"""The table of materials: every row has its source, and is found by any of its names."""

from __future__ import annotations

import math
import re
from itertools import combinations

import pytest
from pydantic import ValidationError

from twin.errors import MaterialError
from twin.materials import Material, find_material, load_materials
from twin.materials.library import key_of

ROWS: list[Material] = list(load_materials().values())


def test_a_row_has_a_source_that_can_be_looked_up_and_sound_numbers() -> None:
    for row in ROWS:
        assert re.search(r"doi 10\.\d{4,}/\S+|github\.com/\S+|p\. \d+", row.source), row.name
        numbers = (row.Ktc, row.Kte, row.Krc, row.Kre, row.Kac, row.Kae, row.mt, row.mr, row.ma)
        assert all(math.isfinite(number) for number in numbers), row.name
        assert 10.0 < row.Ktc < 10_000.0 and abs(row.Krc) < row.Ktc and abs(row.Kac) < row.Ktc, row.name
        assert row.caution or (row.chip_range_mm and row.speed_range_m_min), row.name


@pytest.mark.parametrize(
    ("change", "problem"),
    [
        ({"caution": ""}, "expected a text for a row without chip_range_mm"),
        ({"chip_range_mm": [0.2, 0.1]}, "chip_range_mm"),
        ({"mt": 0.2}, "expected only with law"),
        ({"kind": "order of magnitude", "caution": ""}, "caution"),
        ({"source": " "}, "source"),
    ],
)
def test_an_unsound_row_is_refused(change: dict[str, object], problem: str) -> None:
    row = find_material("Al7075-T6").model_dump(exclude_none=True)
    with pytest.raises(ValidationError, match=problem):
        Material.model_validate({**row, **change})


def test_no_two_rows_share_a_name() -> None:
    for one, other in combinations(ROWS, 2):
        assert not {key_of(n) for n in one.names} & {key_of(n) for n in other.names}, (one.name, other.name)


@pytest.mark.parametrize("name", ["Al7075-T6", "al 7075 t6", "AL7075T6", "7075_t6", "al7075‑T6"])
def test_case_blanks_and_hyphens_do_not_matter(name: str) -> None:
    assert find_material(name).name == "Al7075-T6"


@pytest.mark.parametrize(
    ("name", "row"),
    [
        *((name, "C45") for name in ("AISI1045", "1.0503", "1.1191", "Ck45", "C45E")),
        *((name, "Al6082-T6") for name in ("AlMgSi1", "EN AW-6082", "EN AW-6082-T6", "AA6082", "3.2315")),
        *((name, "Al7075-T6") for name in ("3.4365", "AW-7075", "aluminum 7075", "7075-T651")),
        *((name, "Ti6Al4V") for name in ("TC4", "grade 5", "Ti Gr5", "3.7164", "3.7165")),
        ("en aw 7050", "Al7050, power law"),
        *((name, "VDI 3323 group 14") for name in ("304", "316L", "1.4404")),
        *((name, "VDI 3323 group 8") for name in ("AISI 4140", "42CrMo4", "4340")),
        ("Inconel 718", "VDI 3323 group 34"),
        ("CuZn39Pb3", "VDI 3323 group 26"),
    ],
)
def test_names_of_standards_are_known(name: str, row: str) -> None:
    assert find_material(name).name == row


def test_at_least_15_rows_are_published_tests_and_those_without_a_range_caution() -> None:
    published = [row for row in ROWS if row.kind == "published test"]
    assert len(published) >= 15
    assert all(row.caution for row in published if row.chip_range_mm is None)


def test_an_unknown_name_gets_the_nearest() -> None:
    with pytest.raises(MaterialError, match=r"material 'Al7057-T6': expected a name of the table .*Al7075-T6"):
        find_material("Al7057-T6")
    with pytest.raises(MaterialError, match=r"e\.g\. "):
        find_material("???")


def test_a_row_is_a_cutting_table() -> None:
    table = find_material("Al7075-T6").cutting()
    assert table["material"] == "Al7075-T6" and table["Ktc"] == 767.01 and "mt" not in table
