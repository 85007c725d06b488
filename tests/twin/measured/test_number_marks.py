"""Numbers with decimal and group marks of any country: the value, or a refusal that names both readings."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from twin.errors import MeasuredError
from twin.measured.forces import read_forces
from twin.measured.log import ForceLog
from twin.measured.settings import LogReading
from twin.measured.text.marks import Marks, UnclearMarksError, weighed

#: Forces above and below 1000, one of them in millions.
FORCES = [(1010.25, -280.5, 0.75), (989.125, -1300.25, 82.5), (1020.5, -281.0, -1234567.25), (1030.0, -999.0, 83.0)]


def grouped(value: float, group: str, decimal: str, digits: int) -> str:
    text = f"{value:,.{digits}f}"
    return text.translate({ord(","): group, ord("."): decimal})


def read(tmp_path: Path, text: str, **options: object) -> ForceLog:
    (tmp_path / "log.csv").write_text(text, encoding="utf-8")
    return read_forces(tmp_path / "log.csv", LogReading.model_validate(options))


def log_text(delimiter: str, group: str, decimal: str, *, digits: int = 3, quoted: bool = False, n: int = 4) -> str:
    mark = '"' if quoted else ""
    lines = [delimiter.join(["Time [ms]", "Fx [N]", "Fy [N]", "Fz [N]"])]
    for k in range(n):
        cells = [f"{mark}{grouped(v, group, decimal, digits)}{mark}" for v in FORCES[k % len(FORCES)]]
        lines.append(delimiter.join([f"{k}", *cells]))
    return "\n".join(lines)


PAIRS = [(g, d) for d in ".," for g in (".", ",", " ", "\u00a0", "\u202f", "\u2009", "'", "\u2019") if g != d]


@pytest.mark.parametrize(
    ("delimiter", "group", "decimal"), [(t, g, d) for t in (";", "\t", "|", ",") for g, d in PAIRS if t != d]
)
def test_every_pair_of_marks(delimiter: str, group: str, decimal: str, tmp_path: Path) -> None:
    quoted = delimiter == group
    log = read(tmp_path, log_text(delimiter, group, decimal, quoted=quoted))
    np.testing.assert_allclose(log.force_n, FORCES, atol=1e-9)


@pytest.mark.parametrize("group", ["\u00a0", "\u202f", "'", "\u2019"])
def test_groups_in_columns_set_apart_by_blanks(group: str, tmp_path: Path) -> None:
    text = log_text("  ", group, ".").replace(" [", "[")
    np.testing.assert_allclose(read(tmp_path, text).force_n, FORCES, atol=1e-9)


@pytest.mark.parametrize("group", list(",.'\u00a0 "))
def test_whole_numbers_with_groups(group: str, tmp_path: Path) -> None:
    rows = "".join(f"{k};{grouped(1010.0 - 21.0 * k, group, '.', 0)};-280;{80 + k}\n" for k in range(4))
    log = read(tmp_path, f"Time [ms];Fx [N];Fy [N];Fz [N]\n{rows}")
    np.testing.assert_allclose(log.force_n[:, 0], [1010.0, 989.0, 968.0, 947.0])


def test_groups_that_begin_far_below_the_first_rows(tmp_path: Path) -> None:
    rows = [f"{k};{5 + k % 7};2;{3 + k % 5}\n" for k in range(1000)]
    rows[450] = "450;1,250;2;3\n"
    rows[451] = "451;1,251;2;3\n"
    log = read(tmp_path, "Time [ms];Fx [N];Fy [N];Fz [N]\n" + "".join(rows))
    assert log.force_n[449:453, 0].tolist() == [6.0, 1250.0, 1251.0, 9.0]


@pytest.mark.parametrize("column", ["1,201;1,202;1,203;1,204", "1,201;950;1,203;1,204"])
def test_a_comma_that_may_be_either_is_refused(column: str, tmp_path: Path) -> None:
    rows = "".join(f"{k};{x};-280;80\n" for k, x in enumerate(column.split(";")))
    text = f"Time [ms];Fx [N];Fy [N];Fz [N]\n{rows}"
    with pytest.raises(MeasuredError, match=r"log.csv:2: '1,201' may be 1.201 or 1201.* --decimal"):
        read(tmp_path, text)
    assert read(tmp_path, text, decimal=".").force_n[0, 0] == 1201.0
    assert read(tmp_path, text, decimal=",").force_n[0, 0] == 1.201


def test_points_are_decimal_unless_whole_numbers_stand_beside_them(tmp_path: Path) -> None:
    fixed = "".join(f"{k};1.{200 + k};-2.280;3.080\n" for k in range(12))
    assert read(tmp_path, f"t [ms];Fx;Fy;Fz\n{fixed}").force_n[0].tolist() == [1.2, -2.28, 3.08]
    whole = "".join(f"{k};1.{201 + k};{-280 + k * 7 % 13};80\n" for k in range(12))
    with pytest.raises(MeasuredError, match=r"log.csv:2: '1.201' may be 1.201 or 1201"):
        read(tmp_path, f"t [ms];Fx;Fy;Fz\n{whole}")


@pytest.mark.parametrize(
    ("text", "decimal", "value"),
    [
        ("1,234,567", ".", 1234567.0),
        ("12,34,567.5", ".", 1234567.5),
        ("\u22121 234,5", ",", -1234.5),
        ("+1.234.567,5e1", ",", 12345675.0),
        ("1.5", ",", None),
        ("1,5", ".", None),
        ("1_000", ".", None),
        ("12,34.5", ".", None),
        ("1 23", ".", None),
    ],
)
def test_numbers(text: str, decimal: str, value: float | None) -> None:
    assert Marks(decimal).number(text) == value


def test_a_decimal_mark_elsewhere_makes_the_other_one_a_group_mark(tmp_path: Path) -> None:
    rows = "".join(f"0,00{k};1.20{k};-280;80\n" for k in range(4))
    assert read(tmp_path, f"Zeit [s];Fx;Fy;Fz\n{rows}").force_n[1, 0] == 1201.0
    with pytest.raises(UnclearMarksError):
        weighed([["1,201"], ["1,202"]], ";")


def test_a_point_in_a_file_with_decimal_commas_is_named(tmp_path: Path) -> None:
    rows = "".join(f"0,00{k};1,5;-280,25;80\n" for k in range(4))
    with pytest.raises(MeasuredError, match=r"log.csv:6: '12.5' is not a number, .* \(field 2 of 4, Fx\)"):
        read(tmp_path, f"Zeit [s];Fx;Fy;Fz\n{rows}0,004;12.5;1;1\n0,005;1;1;1\n")


@pytest.mark.parametrize(
    ("stated", "decimal"),
    [
        *((text, ",") for text in ("10.000 Hz", "10.000,00 Hz", "10000 Hz", "10 000,0 Hz", "10 kHz", "10,0 kHz")),
        *((text, ".") for text in ("10,000 Hz", "10,000.0 Hz", "10'000 Hz", "10.0 kHz", "1e4 Hz")),
    ],
)
def test_rates_above_the_columns_have_the_marks_of_the_numbers_below(stated: str, decimal: str, tmp_path: Path) -> None:
    rows = "".join(f"{k}.5;1.25;0.2\n".replace(".", decimal) for k in range(4))
    assert read(tmp_path, f"Sampling rate: {stated}\nFx;Fy;Fz\n{rows}").rate_hz == 10_000.0


@pytest.mark.parametrize("group", ["", ".", " ", "'"])
@pytest.mark.parametrize("decimals", [2, 3])
def test_decimal_commas_in_quotes_between_commas(group: str, decimals: int, tmp_path: Path) -> None:
    rows = [f'"{k},000","{grouped(1202.0 + k, group, ",", decimals)}","-280,00","0,25"\n' for k in range(4)]
    log = read(tmp_path, '"Time [ms]","Fx [N]","Fy [N]","Fz [N]"\n' + "".join(rows))
    np.testing.assert_allclose(log.force_n, [(1202.0 + k, -280.0, 0.25) for k in range(4)])
    assert log.rate_hz == 1000.0


@pytest.mark.parametrize("names", ["Time [ms]\tFx [N]\tFy [N]\tFz [N]", "Time (ms)\tFx\tFy\tFz"])
def test_tabs_separate_where_blanks_group(names: str, tmp_path: Path) -> None:
    rows = "".join(f"{k}\t{1 + k} 202.25\t-280.00\t80.5\n" for k in range(5))
    log = read(tmp_path, f"{names}\n{rows}")
    np.testing.assert_allclose(log.force_n[:, 0], [1202.25 + 1000.0 * k for k in range(5)])


def test_groups_of_blanks_in_columns_set_apart_by_blanks_are_refused(tmp_path: Path) -> None:
    rows = "".join(f"{k} {1 + k} 202.25 -280.00 80.5\n" for k in range(5))
    with pytest.raises(MeasuredError, match=r"log.csv:2: 5 columns .* 4 names \(Time \(ms\), Fx, Fy, Fz\)"):
        read(tmp_path, f"Time (ms) Fx Fy Fz\n{rows}")


@pytest.mark.parametrize("cells", ['{k} "1 202.25" "-280" 80.5', '"{k}"  "1,202.25"  "-280"  "80.5"'])
def test_quotes_in_columns_set_apart_by_blanks(cells: str, tmp_path: Path) -> None:
    rows = "".join(cells.format(k=k) + "\n" for k in range(5))
    log = read(tmp_path, f'"Time [ms]" "Fx [N]" "Fy [N]" "Fz [N]"\n{rows}')
    np.testing.assert_allclose(log.force_n, [(1202.25, -280.0, 80.5)] * 5)


@pytest.mark.parametrize(("rows", "message"), [
    ("0.00{k};1.202,00;-280,00;80,00", r"Time \[s\] \('0.000' in line 2: expected a decimal comma as in other columns"),
    ("{k}.000;1.202,00;-280,00;80,00", r"log.csv:2: '0.000' is not a number.* decimal comma as in other columns"),
    ('"0,00{k}";1202.00;-280.00;80.00', r"Time \[s\] \('0,000' in line 2: expected a decimal point"),
])  # fmt: skip
def test_two_decimal_marks_in_one_file_are_refused(rows: str, message: str, tmp_path: Path) -> None:
    text = "".join(rows.format(k=k) + "\n" for k in range(5))
    with pytest.raises(MeasuredError, match=message):
        read(tmp_path, f"Time [s];Fx [N];Fy [N];Fz [N]\n{text}")
