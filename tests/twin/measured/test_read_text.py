"""Text files as people's programs write them: each quirk is handled with a note, or refused with its line."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from twin.errors import MeasuredError
from twin.measured.forces import read_forces
from twin.measured.log import ForceLog
from twin.measured.settings import LogReading

ROWS = [(0.000, 1.5, -2.25, 3.0), (0.001, 2.5, -3.25, 4.0), (0.002, 3.5, -4.25, 5.0), (0.003, 4.5, -5.25, 6.0)]
WANT = np.array(ROWS)[:, 1:]


def body(delimiter: str = ",", decimal: str = ".", rows: list[tuple[float, ...]] | None = None) -> str:
    lines = (delimiter.join(f"{v:g}".replace(".", decimal) for v in row) for row in rows or ROWS)
    return "\n".join(lines) + "\n"


def read(tmp_path: Path, text: str | bytes, **options: object) -> ForceLog:
    path = tmp_path / "log.txt"
    path.write_bytes(text if isinstance(text, bytes) else text.encode())
    return read_forces(path, LogReading.model_validate(options))


@pytest.mark.parametrize(
    ("delimiter", "decimal"),
    [(",", "."), (";", "."), (";", ","), ("\t", "."), ("\t", ","), ("|", "."), ("  ", "."), (" ", ",")],
)
def test_delimiters_and_decimal_marks(delimiter: str, decimal: str, tmp_path: Path) -> None:
    names = delimiter.join(["time", "Fx", "Fy", "Fz"])
    log = read(tmp_path, f"{names}\n{body(delimiter, decimal)}")
    np.testing.assert_allclose(log.force_n, WANT)
    assert log.rate_hz == pytest.approx(1000.0)


@pytest.mark.parametrize(
    "header",
    [
        "Time [s],Fx [N],Fy [N],Fz [N]",
        "t_s,Fx_N,Fy_N,Fz_N",
        "time (s);Force X (N);Force Y (N);Force Z (N)".replace(";", ","),
        "Zeit,Kraft_X,Kraft_Y,Kraft_Z",
        "# t, F_x, F_y, F_z",
        "% t,fx,fy,fz",
        '"Time","Cutting force x","Cutting force y","Cutting force z"',
        "Seconds,X Force / N,Y Force / N,Z Force / N",
        "t,x,y,z",
        "X_Value,Dyno Fx,Dyno Fy,Dyno Fz",
        "time,Fx,Fy,Fz\ns,N,N,N",
        "time,Fx,Fy,Fz\n[s],[N],[N],[N]",
        "Operator: me\nSampling rate: 1000 Hz\n\ntime,Fx,Fy,Fz\n(s),(N),(N),(N)",
        "\ufefft,Fx,Fy,Fz",
    ],
)
def test_styles_of_headers(header: str, tmp_path: Path) -> None:
    log = read(tmp_path, f"{header}\n{body()}")
    np.testing.assert_allclose(log.force_n, WANT)
    np.testing.assert_allclose(log.t_s, [0.0, 0.001, 0.002, 0.003])


@pytest.mark.parametrize(
    "header", ["Time (s)  Fx (N)  Fy (N)  Fz (N)", "Time (s) Fx (N) Fy (N) Fz (N)", "t [s] Fx Fy Fz"]
)
def test_headers_with_blanks_above_columns_set_apart_by_blanks(header: str, tmp_path: Path) -> None:
    np.testing.assert_allclose(read(tmp_path, f"{header}\n{body('  ')}").force_n, WANT)


@pytest.mark.parametrize(
    ("header", "force", "time"),
    [
        ("t [ms],Fx [kN],Fy [kN],Fz [kN]", 1000.0, 1e-3),
        ("t_us,Fx_kN,Fy_kN,Fz_kN", 1000.0, 1e-6),
        ("t,Fx,Fy,Fz\nms,mN,mN,mN", 1e-3, 1e-3),
        ("t,Fx (lbf),Fy (lbf),Fz (lbf)", 4.4482216152605, 1.0),
        ("t,Fx [daN],Fy [daN],Fz [daN]", 10.0, 1.0),
    ],
)
def test_units_are_turned_into_newtons_and_seconds(header: str, force: float, time: float, tmp_path: Path) -> None:
    log = read(tmp_path, f"{header}\n{body()}")
    np.testing.assert_allclose(log.force_n, force * WANT)
    np.testing.assert_allclose(log.t_s, time * np.array([0.0, 0.001, 0.002, 0.003]), atol=1e-15)


def test_voltages_are_refused_unless_the_map_has_their_factor(tmp_path: Path) -> None:
    text = f"t_s,Fx [mV],Fy [mV],Fz [mV]\n{body()}"
    with pytest.raises(MeasuredError, match=r"column 'Fx \[mV\]' is in 'mV', expected a unit of force .* x=2.5\*Fx"):
        read(tmp_path, text)
    log = read_forces(tmp_path / "log.txt", LogReading(map="x=-2.0*Fx,y=0.5*Fy,z=3*Fz"))
    np.testing.assert_allclose(log.force_n, WANT * [-2.0, 0.5, 3.0])
    assert any("taken as N/mV" in note for note in log.notes)


def test_moments_are_no_forces(tmp_path: Path) -> None:
    log = read(tmp_path, f"t,Fx [N],Fy [N],Fz [N],Mz [N.m]\n{body(rows=[(*r, 9.0) for r in ROWS])}")
    np.testing.assert_allclose(log.force_n, WANT)


def test_no_header_needs_names_and_they_are_asked_for(tmp_path: Path) -> None:
    with pytest.raises(
        MeasuredError, match=r"columns are column2, column3, column4; .* --map \"x=column2,y=column3,z=column4\""
    ):
        read(tmp_path, body())
    log = read(tmp_path, body(), columns=["t_s", "Fx_N", "Fz_N", "Fy_N"])
    np.testing.assert_allclose(log.force_n, WANT[:, [0, 2, 1]])


def test_no_time_needs_a_rate(tmp_path: Path) -> None:
    text = "Fx,Fy,Fz\n" + body(rows=[r[1:] for r in ROWS])
    with pytest.raises(MeasuredError, match=r"no column of time among Fx, Fy, Fz; give the sampling rate by --rate"):
        read(tmp_path, text)
    log = read(tmp_path, text, rate_hz=2000.0)
    np.testing.assert_allclose(log.t_s, np.arange(4) / 2000.0)
    stated = read(tmp_path, "Sampling frequency; 2.5 kHz\n" + text.replace(",", ";"))
    assert stated.rate_hz == 2500.0


def test_settings_in_numbers_and_a_long_header_stand_above_the_names(tmp_path: Path) -> None:
    above = "\n".join(["1,2,3,4", *(f"# setting {k} = {k}" for k in range(700)), "t,Fx,Fy,Fz"])
    np.testing.assert_allclose(read(tmp_path, f"{above}\n{body(rows=ROWS * 1)}").force_n, WANT)


def test_blank_lines_between_rows_are_nothing(tmp_path: Path) -> None:
    np.testing.assert_allclose(read(tmp_path, "t,Fx,Fy,Fz\n\n" + body().replace("\n", "\n\n")).force_n, WANT)


def test_repeated_headers_are_passed_over(tmp_path: Path) -> None:
    text = "t,Fx,Fy,Fz\ns,N,N,N\n" + body(rows=ROWS[:2]) + "t,Fx,Fy,Fz\ns,N,N,N\n" + body(rows=ROWS[2:])
    log = read(tmp_path, text)
    np.testing.assert_allclose(log.force_n, WANT)
    assert "repeated header at line 5, 6 skipped" in log.notes


def test_rows_without_a_number_are_left_out_and_make_a_gap(tmp_path: Path) -> None:
    rows = "0,1,2,3\n0.001,1,2,3\n0.002,NaN,2,3\n0.003,,,\n0.004,1,2,3\n0.005,1,2,3\n"
    log = read(tmp_path, f"t,Fx,Fy,Fz\n{rows}")
    np.testing.assert_allclose(log.t_s, [0.0, 0.001, 0.004, 0.005])
    assert log.gaps == ((0.001, 0.004),)
    assert any("2 rows without a number omitted, the first at 0.0020 s" in n for n in log.notes)


def test_a_gap_in_the_time_is_told(tmp_path: Path) -> None:
    log = read(tmp_path, "t,Fx,Fy,Fz\n" + body(rows=[*ROWS, (0.5, 1.0, 1.0, 1.0), (0.501, 1.0, 1.0, 1.0)]))
    assert log.gaps == ((0.003, 0.5),)
    assert any("1 gap in the time: 0.0030 to 0.5000 s" in n for n in log.notes)


def test_time_that_goes_back_is_refused_with_its_line(tmp_path: Path) -> None:
    text = "t,Fx,Fy,Fz\n" + body() + "0.0015,1,1,1\n"
    with pytest.raises(MeasuredError, match=r"log.txt:6: time goes back, from 0.003 s to 0.0015 s"):
        read(tmp_path, text)


def test_words_among_the_numbers_are_refused_with_their_line(tmp_path: Path) -> None:
    with pytest.raises(MeasuredError, match=r"log.txt:4: 'overload' is not a number, expected 4 numbers"):
        read(tmp_path, "t,Fx,Fy,Fz\n" + body(rows=ROWS[:2]) + "0.002,overload,1,1\n" + body(rows=ROWS[3:]))


def test_a_last_line_cut_short_is_passed_over(tmp_path: Path) -> None:
    log = read(tmp_path, "t,Fx,Fy,Fz\n" + body() + "0.004,1.")
    np.testing.assert_allclose(log.force_n, WANT)
    assert "line 6, the last one, is cut short and skipped" in log.notes


def test_coarse_times_are_counted(tmp_path: Path) -> None:
    rows = [(round(k / 5000.0, 3), float(k), 1.0, 1.0) for k in range(501)]
    log = read(tmp_path, "t,Fx,Fy,Fz\n" + body(rows=rows))
    np.testing.assert_allclose(np.diff(log.t_s), 1 / 5000.0, rtol=1e-9)
    assert any("too coarse" in n for n in log.notes)


def test_times_of_day(tmp_path: Path) -> None:
    lines = [f"2024-05-01T12:30:{k * 0.25:06.3f};1;2;3" for k in range(8)]
    log = read(tmp_path, "Timestamp;Fx;Fy;Fz\n" + "\n".join(lines))
    np.testing.assert_allclose(log.t_s, 0.25 * np.arange(8))


def test_an_index_column_is_no_time_and_no_force(tmp_path: Path) -> None:
    rows: list[tuple[float, ...]] = [(k, *row) for k, row in enumerate(ROWS)]
    log = read(tmp_path, "No,t,Fx,Fy,Fz\n" + body(rows=rows))
    np.testing.assert_allclose(log.force_n, WANT)


def test_utf16_is_read(tmp_path: Path) -> None:
    np.testing.assert_allclose(read(tmp_path, ("t,Fx,Fy,Fz\n" + body()).encode("utf-16")).force_n, WANT)


def test_a_header_that_does_not_fit_is_refused(tmp_path: Path) -> None:
    with pytest.raises(MeasuredError, match=r"log.txt:2: 4 columns of numbers below a header of 3 names \(t, Fx, Fy\)"):
        read(tmp_path, "t,Fx,Fy\n" + body())
    with pytest.raises(MeasuredError, match=r"4 columns, --columns gives 2 names: a, b"):
        read(tmp_path, "t,Fx,Fy,Fz\n" + body(), columns=["a", "b"])


def test_spindle_angle_and_trigger_are_found(tmp_path: Path) -> None:
    t = np.arange(300) / 1000.0
    angle = np.mod(360.0 * 20.0 * t, 360.0)
    pulse = (np.mod(20.0 * t + 1e-9, 1.0) < 0.2) * 5.0
    lines = [",".join(f"{v:.9g}" for v in row) for row in np.column_stack([t, t, t, t, angle, pulse])]
    log = read(tmp_path, "t,Fx,Fy,Fz,Spindle angle [deg],Trigger [V]\n" + "\n".join(lines))
    assert log.spindle_angle_rad is not None and log.trigger_s is not None
    np.testing.assert_allclose(np.diff(log.spindle_angle_rad), 2 * np.pi * 20.0 / 1000.0, rtol=1e-6)
    np.testing.assert_allclose(np.diff(log.trigger_s), 0.05, atol=1e-9)


@pytest.mark.parametrize(
    ("lines", "message"),
    [
        ([",".join(["1.5"] * 20_000)] * 3, r"log.txt:2: a line of 79999 characters, expected a row of at most 32768"),
        (["0,1,2,3", "1,2,3,4" + "," * 40_000 + "5"], r"log.txt:3: a line of 40008 characters"),
    ],
)
def test_very_long_rows_are_refused_at_once(lines: list[str], message: str, tmp_path: Path) -> None:
    with pytest.raises(MeasuredError, match=message):
        read(tmp_path, "\n".join(["t,Fx,Fy,Fz", *lines]))


def test_very_many_columns_are_refused(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("twin.measured.read._MOST_COLUMNS", 3)
    with pytest.raises(MeasuredError, match=r"log.txt: 4 columns, expected at most 3"):
        read(tmp_path, "t,Fx,Fy,Fz\n" + body())


def test_messages_list_no_more_than_a_hundred_columns(tmp_path: Path) -> None:
    row = ",".join(["0.5"] * 300)
    with pytest.raises(MeasuredError, match=r"c99 and 200 more; give the sampling rate") as error:
        read(tmp_path, "\n".join([",".join(f"c{i}" for i in range(300)), row, row]))
    assert len(str(error.value)) < 1000


def test_a_long_line_above_the_rows_does_not_matter(tmp_path: Path) -> None:
    assert len(read(tmp_path, f"# {'x' * 100_000}\nt,Fx,Fy,Fz\n{body()}").t_s) > 2
