"""Dates, times of day, text and hexadecimal columns in text files."""

from __future__ import annotations

from collections.abc import Callable
from datetime import datetime, timedelta
from pathlib import Path

import numpy as np
import pytest

from twin.errors import MeasuredError
from twin.measured.forces import read_forces
from twin.measured.log import ForceLog
from twin.measured.settings import LogReading
from twin.measured.text.clocks import moment

STEP_S = 0.25
FORCE = np.column_stack([1200.5 + np.arange(8), -280.25 * np.ones(8), 80.0 * np.ones(8)])
BEGIN = datetime(2020, 1, 2, 10, 0, 0)


def read(tmp_path: Path, text: str, **options: object) -> ForceLog:
    (tmp_path / "log.txt").write_text(text, encoding="utf-8")
    return read_forces(tmp_path / "log.txt", LogReading.model_validate(options))


def written(clock: Callable[[datetime], str], begin: datetime = BEGIN, name: str = "Time", delimiter: str = ";") -> str:
    lines = [delimiter.join([name, "Fx[N]", "Fy[N]", "Fz[N]"])]
    for k, row in enumerate(FORCE.tolist()):
        lines.append(delimiter.join([clock(begin + timedelta(seconds=STEP_S * k)), *(f"{v:.2f}" for v in row)]))
    return "\n".join(lines)


def as_expected(log: ForceLog) -> None:
    np.testing.assert_allclose(log.t_s, STEP_S * np.arange(8), atol=1e-9)
    np.testing.assert_allclose(log.force_n, FORCE)


FORMS = {
    "ISO": "%Y-%m-%dT%H:%M:%S.%f",
    "ISO with zone": "%Y-%m-%d %H:%M:%S.%f+01:00",
    "slashes from the year": "%Y/%m/%d %H:%M:%S.%f",
    "US": "%m/%d/%Y %I:%M:%S.%f %p",
    "US of 24 hours": "%m/%d/%Y %H:%M:%S.%f",
    "US of two digits": "%m/%d/%y %I:%M:%S.%f %p",
    "UK": "%d/%m/%Y %H:%M:%S.%f",
    "German": "%d.%m.%Y %H:%M:%S,%f",
    "German of two digits": "%d.%m.%y %H:%M:%S,%f",
    "month as a word": "%d-%b-%Y %H:%M:%S.%f",
    "month first": "%b %d, %Y %I:%M:%S.%f %p",
    "time first": "%H:%M:%S.%f %d.%m.%Y",
    "time alone": "%H:%M:%S.%f",
    "time with AM": "%I:%M:%S.%f %p",
    "minutes": "%M:%S.%f",
}


@pytest.mark.parametrize("form", FORMS)
@pytest.mark.parametrize("delimiter", [";", "\t", ","])
def test_forms_of_dates_and_times(form: str, delimiter: str, tmp_path: Path) -> None:
    mark = '"' if delimiter == "," else ""
    as_expected(read(tmp_path, written(lambda t: f"{mark}{t.strftime(FORMS[form])}{mark}", delimiter=delimiter)))


@pytest.mark.parametrize("form", ["US", "UK", "German", "ISO", "time alone", "time with AM", "month as a word"])
def test_midnight(form: str, tmp_path: Path) -> None:
    begin = datetime(2019, 12, 31, 23, 59, 59)
    as_expected(read(tmp_path, written(lambda t: t.strftime(FORMS[form]), begin)))


@pytest.mark.parametrize(
    "form", ["%Y. %m. %d. %H:%M:%S.%f", "%Y年%m月%d日 %H:%M:%S.%f", "%Y%m%dT%H%M%S.%f", "%a %b %d %H:%M:%S.%f %Y"]
)
def test_dates_of_other_countries_over_midnight(form: str, tmp_path: Path) -> None:
    as_expected(read(tmp_path, written(lambda t: t.strftime(form), datetime(2019, 12, 31, 23, 59, 59))))


RARER = {
    "weekday in full": lambda t: f"{t:%A, %B %d, %Y %I:%M:%S.%f %p}",
    "weekday, day first": lambda t: f"{t:%A %d %B %Y %H:%M:%S.%f}",
    "weekday in German": lambda t: f"Donnerstag, {t:%d.%m.%Y %H:%M:%S,%f}",
    "mail": lambda t: f"{t:%a, %d %b %Y %H:%M:%S.%f} GMT",
    "zone": lambda t: f"{t:%Y-%m-%d %H:%M:%S.%f} CET",
    "Uhr": lambda t: f"{t:%d.%m.%Y %H:%M:%S,%f} Uhr",
    "PM first": lambda t: f"{t:%m/%d/%Y %p %I:%M:%S.%f}",
    "brackets": lambda t: f"[{t:%Y-%m-%d %H:%M:%S.%f}]",
    "dash before the time": lambda t: f"{t:%d/%m/%Y-%H:%M:%S.%f}",
    "points": lambda t: f"{t:%d.%m.%Y %H.%M.%S.%f}",
    "underscore": lambda t: f"{t:%Y%m%d_%H%M%S.%f}",
    "compact date": lambda t: f"{t:%Y%m%d %H:%M:%S.%f}",
    "days": lambda t: f"{(t - datetime(2024, 1, 1)).days} days {t:%H:%M:%S.%f}",
}


@pytest.mark.parametrize("form", RARER)
@pytest.mark.parametrize("begin", [datetime(2024, 2, 28, 23, 59, 59), datetime(2024, 3, 14, 11, 59, 59)])
def test_rarer_forms_over_midnight_and_noon(form: str, begin: datetime, tmp_path: Path) -> None:
    as_expected(read(tmp_path, written(RARER[form], begin)))


def test_months_of_other_languages_that_begin_alike(tmp_path: Path) -> None:
    months = {6: "juin", 7: "juillet", 2: "février", 3: "mars"}
    for begin in (datetime(2024, 6, 30, 23, 59, 59), datetime(2024, 2, 29, 23, 59, 59)):
        text = written(lambda t: f"{t.day} {months[t.month]} {t:%Y %H:%M:%S.%f}", begin)
        as_expected(read(tmp_path, text))


def test_times_that_step_once_show_no_rate(tmp_path: Path) -> None:
    rows = "".join(f"10:00:0{k // 50};{k};1;2\n" for k in range(100))
    with pytest.raises(MeasuredError, match=r"too coarse: 100 samples at 2 times; give the sampling rate by --rate"):
        read(tmp_path, f"Time;Fx [N];Fy [N];Fz [N]\n{rows}")


def test_a_full_hour_in_minutes_and_seconds(tmp_path: Path) -> None:
    log = read(tmp_path, written(lambda t: t.strftime("%M:%S.%f"), datetime(2020, 1, 1, 9, 59, 59)))
    as_expected(log)
    assert "time passes a full hour: counted on" in log.notes


def test_seconds_of_the_day_over_midnight(tmp_path: Path) -> None:
    day = [f"{(86399.5 + STEP_S * k) % 86400.0:.3f};{x};{y};{z}" for k, (x, y, z) in enumerate(FORCE.tolist())]
    log = read(tmp_path, "\n".join(["Time [s];Fx;Fy;Fz", *day]))
    np.testing.assert_allclose(log.t_s - log.t_s[0], STEP_S * np.arange(8))
    assert "time passes midnight at line 4: counted on" in log.notes


def test_hours_of_the_day_over_midnight(tmp_path: Path) -> None:
    day = [f"{(86399.5 + STEP_S * k) % 86400.0 / 3600.0:.9f};{x};{y};{z}" for k, (x, y, z) in enumerate(FORCE.tolist())]
    log = read(tmp_path, "\n".join(["Time (h);Fx;Fy;Fz", *day]))
    np.testing.assert_allclose(log.t_s - log.t_s[0], STEP_S * np.arange(8), atol=1e-5)


def test_a_clock_that_falls_by_an_hour_is_refused(tmp_path: Path) -> None:
    text = written(lambda t: t.strftime("%H:%M:%S.%f"))
    with pytest.raises(MeasuredError, match=r"log.txt:10: time goes back"):
        read(tmp_path, f"{text}\n09:00:00.0;1;2;3\n")


@pytest.mark.parametrize("delimiter", [";", "\t", " "])
@pytest.mark.parametrize("form", ["%d.%m.%Y{0}%H:%M:%S.%f", "%m/%d/%Y{0}%I:%M:%S.%f %p", "%Y-%m-%d{0}%H:%M:%S.%f"])
def test_date_and_time_in_two_columns(delimiter: str, form: str, tmp_path: Path) -> None:
    form, begin = form.format(delimiter), datetime(2020, 1, 2, 23, 59, 59)
    text = written(lambda t: t.strftime(form), begin, f"Date{delimiter}Time", delimiter)
    log = read(tmp_path, text)
    as_expected(log)
    assert "time from Date and Time, counted from the first one" in log.notes


def test_columns_of_text_are_left_out_with_a_note(tmp_path: Path) -> None:
    rows = "".join(f"{k / 1000:.3f},OK,{k},1,2,1A{k % 7}F,E{k % 3}\n" for k in range(8))
    log = read(tmp_path, f"Time [s],Status,Fx [N],Fy [N],Fz [N],Flags (hex),Code\n{rows}")
    np.testing.assert_allclose(log.force_n[:, 0], np.arange(8))
    assert "columns of text not read: Status, Flags (hex), Code" in log.notes


def test_hexadecimal_columns_that_look_like_numbers(tmp_path: Path) -> None:
    codes = ["10", "1e5", "22", "A3", "90", "5F", "77", "0x1"]
    rows = "".join(f"{k / 1000:.3f};{code};{k};1;2\n" for k, code in enumerate(codes))
    log = read(tmp_path, f"t_s;Status;Fx;Fy;Fz\n{rows}")
    np.testing.assert_allclose(log.force_n[:, 0], np.arange(8))


def test_remarks_after_the_last_column(tmp_path: Path) -> None:
    rows = [f"{k / 1000:.3f};{k};1;2" for k in range(8)]
    rows[3] += ";begin of cut"
    log = read(tmp_path, "\n".join(["t_s;Fx;Fy;Fz;Comment", *rows]))
    np.testing.assert_allclose(log.force_n[:, 0], np.arange(8))
    assert "text after the last column at line 5 skipped" in log.notes
    log = read(tmp_path, "\n".join(["t_s;Fx;Fy;Fz;Comment", *rows[4:]]))
    assert len(log.t_s) == 4


@pytest.mark.parametrize(
    ("row", "message"),
    [
        ("0.003;bad;1;2;OK", r"log.txt:5: 'bad' is not a number, expected 5 numbers \(field 2 of 5, Fx\)"),
        ("0.003;1;2", r"log.txt:5: 3 fields, expected 5"),
    ],
)
def test_messages_name_line_and_field(row: str, message: str, tmp_path: Path) -> None:
    rows = [f"{k / 1000:.3f};{k};1;2;OK" for k in range(12)]
    rows[3] = row
    text = "\n".join(["t_s;Fx;Fy;Fz;Status", *rows])
    if "bad" in row:
        with pytest.raises(MeasuredError, match=message):
            read(tmp_path, text)
    else:
        assert "1 rows without a number omitted" in " ".join(read(tmp_path, text).notes)


def test_a_damaged_first_row_is_not_taken_for_names(tmp_path: Path) -> None:
    text = "t_s,Fx,Fy,Fz\n0,1,2,3\n0.1,red,2,3\n0.2,1,2,3\n0.3,1,2,3\n0.4,1,2,3\n"
    with pytest.raises(MeasuredError, match=r"log.txt:3: 'red' is not a number, .* \(field 2 of 4, Fx\)"):
        read(tmp_path, text)


def test_a_time_that_cannot_be_read_is_named(tmp_path: Path) -> None:
    text = written(lambda t: t.strftime("%H:%M:%S.%f"))
    with pytest.raises(MeasuredError, match=r"log.txt:10: 'noon' is not a time, expected 4 .*field 1 of 4, Time"):
        read(tmp_path, f"{text}\nnoon;1;2;3\n10:01:00.0;1;2;3\n")


@pytest.mark.parametrize(
    "text",
    [
        "13:00:00 PM",
        "10:75:00",
        "10:30:75",
        "10:75",
        "Part 10:00:00",
        "31.31.2020 10:00:00",
        "1.5",
        "abc",
        "2020-01-02x",
        "1-2",
    ],
)
def test_other_texts_are_no_moments(text: str) -> None:
    assert moment(text) is None


@pytest.mark.parametrize(("name", "step_s"), [("Time [mm:ss]", 1.0), ("Time (h:mm)", 60.0)])
def test_two_numbers_with_a_colon_need_a_name_that_shows_what_they_are(
    name: str, step_s: float, tmp_path: Path
) -> None:
    rows = "".join(f"59:{50 + k};{k};1;2\n" if k < 10 else f"00:{k - 10:02d};{k};1;2\n" for k in range(14))
    rows = rows if step_s == 1.0 else rows.replace("59:", "23:")
    log = read(tmp_path, f"{name};Fx;Fy;Fz\n{rows}")
    np.testing.assert_allclose(log.t_s, step_s * np.arange(14))
    with pytest.raises(MeasuredError, match=r"not read: Time \('(59|23):50' in line 2: mm:ss or hh:mm\? name it"):
        read(tmp_path, f"Time;Fx;Fy;Fz\n{rows}")


def test_a_damaged_row_below_the_names_is_named(tmp_path: Path) -> None:
    rows = "".join(f"{k / 10};1;2;3\n" for k in range(1, 6))
    with pytest.raises(MeasuredError, match=r"log.txt:2: 'red' is not a number, expected 4 numbers \(field 2 of 4\)"):
        read(tmp_path, f"t;Fx;Fy;Fz\n0;red;2;3\n{rows}")


def test_columns_of_text_in_place_of_forces_are_named(tmp_path: Path) -> None:
    with pytest.raises(MeasuredError, match=r"columns are none; not read: Fx \(text, 'a' in line 2\), Fy \(text, 'b'"):
        read(tmp_path, "t;Fx;Fy\n0;a;b\n1;2;b\n")


@pytest.mark.parametrize("mark", [";", "\t"])
def test_last_columns_that_are_empty_throughout(mark: str, tmp_path: Path) -> None:
    rows = "".join(f"{k / 1000:.3f};{k};1;2;OK;;\n" for k in range(8))
    text = f"t_s;Fx;Fy;Fz;Status;Operator;Program\n{rows}"
    log = read(tmp_path, text.replace(";", mark))
    np.testing.assert_allclose(log.force_n[:, 0], np.arange(8))
    with pytest.raises(MeasuredError, match="5 columns of numbers below a header of 7 names"):
        read(tmp_path, text.replace(";;", "").replace(";", mark))
