"""The table of materials: every row has its source, and is found by any of its names."""

from __future__ import annotations

import math
import re
from itertools import combinations

import pytest

from twin.errors import MaterialError
from twin.materials import Material, find_material, load_materials
from twin.materials.library import key_of

ROWS = list(load_materials().values())


@pytest.mark.parametrize("row", ROWS, ids=[row.name for row in ROWS])
def test_a_row_has_a_source_that_can_be_looked_up(row: Material) -> None:
    assert re.search(r"doi 10\.\d{4,}/\S+|github\.com/\S+|p\. \d+|PMC\d+", row.source), row.source
    numbers = (row.Ktc, row.Kte, row.Krc, row.Kre, row.Kac, row.Kae, row.mt, row.mr, row.ma)
    assert all(math.isfinite(number) for number in numbers)
    for interval in (row.chip_range_mm, row.speed_range_m_min):
        assert interval is not None or row.caution


def test_no_two_rows_share_a_name() -> None:
    for one, other in combinations(ROWS, 2):
        assert not {key_of(n) for n in one.names} & {key_of(n) for n in other.names}, (one.name, other.name)


@pytest.mark.parametrize("name", ["Al7075-T6", "al 7075 t6", "AL7075T6", "7075_t6", "al7075‑T6"])
def test_case_blanks_and_hyphens_do_not_matter(name: str) -> None:
    assert find_material(name).name == "Al7075-T6"


def test_an_unknown_name_gets_the_nearest() -> None:
    with pytest.raises(MaterialError, match=r"material 'Al7057-T6': expected a name of the table .*Al7075-T6"):
        find_material("Al7057-T6")
    with pytest.raises(MaterialError, match=r"e\.g\. "):
        find_material("???")


def test_a_row_is_a_cutting_table() -> None:
    table = find_material("Al7075-T6").cutting()
    assert table["material"] == "Al7075-T6" and table["Ktc"] == 767.01 and "mt" not in table
