"""Segments and channels with their own clocks and lengths, in LabVIEW's formats: one clock, or a refusal."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from twin.arrays import FloatArray
from twin.errors import MeasuredError
from twin.measured.forces import read_forces
from twin.measured.formats.one_clock import Named, on_one_clock
from twin.measured.log import ForceLog

STEP = 0.001
N = 40


def force(t_s: FloatArray) -> FloatArray:
    return np.column_stack([1200.0 + 1e3 * t_s, -300.0 - 2e3 * t_s, 80.0 + 5e2 * t_s])


def head(x_columns: str) -> list[str]:
    return [
        "LabVIEW Measurement\t",
        "Separator\tTab",
        "Decimal_Separator\t.",
        f"X_Columns\t{x_columns}",
        "Time_Pref\tRelative",
        "***End_of_Header***\t",
        "\t",
    ]


def segment(
    t_s: FloatArray, x_columns: str, *, stamp: str = "10:00:00.00", x0: str = "0", more: list[str] | None = None
) -> list[str]:
    """Rows for absolute times, with a column of time as in the file: 0 at the stamp."""
    lines = [*(more or []), "Channels\t3", "Samples\t40\t40\t40"]
    if stamp:
        lines += ["Date\t" + "\t".join(["2020/01/02"] * 3), "Time\t" + "\t".join([stamp] * 3)]
    lines += ["Y_Unit_Label\tNewtons\tNewtons\tNewtons", "\t".join(["X0", *[x0] * 3]), "Delta_X" + f"\t{STEP}" * 3]
    lines += ["***End_of_Header***"]
    names = "X_Value Fx X_Value Fy X_Value Fz" if x_columns == "Multi" else "X_Value Fx Fy Fz"
    lines.append("\t".join([*names.split(), "Comment"]))
    x = np.arange(len(t_s)) * STEP + float(x0)
    for at, row in zip(x.tolist(), force(t_s).tolist(), strict=True):
        cells = [f"{v:.6f}" for v in row]
        if x_columns == "Multi":
            lines.append("\t".join(f"{at:.6f}\t{c}" for c in cells))
        else:
            lines.append("\t".join([f"{at:.6f}" if x_columns == "One" else "", *cells]))
    return lines


def read(tmp_path: Path, lines: list[str]) -> ForceLog:
    (tmp_path / "log.lvm").write_text("\n".join(lines))
    return read_forces(tmp_path / "log.lvm")


def from_zero(begin_s: float = 0.0) -> FloatArray:
    return begin_s + np.arange(N) * STEP


def as_expected(log: ForceLog, *spans: FloatArray) -> None:
    np.testing.assert_allclose(log.t_s, np.concatenate(spans), atol=1e-9)
    np.testing.assert_allclose(log.force_n, force(np.concatenate(spans)), atol=1e-5)
    assert log.rate_hz == pytest.approx(1000.0)
    assert len(log.gaps) == len(spans) - 1


@pytest.mark.parametrize("x_columns", ["No", "One", "Multi"])
def test_segments_apart_by_their_headers(x_columns: str, tmp_path: Path) -> None:
    lines = [
        *head(x_columns),
        *segment(from_zero(), x_columns),
        *segment(from_zero(5.0), x_columns, stamp="10:00:05.00"),
    ]
    as_expected(read(tmp_path, lines), from_zero(), from_zero(5.0))


@pytest.mark.parametrize("x_columns", ["No", "One", "Multi"])
def test_segments_over_midnight(x_columns: str, tmp_path: Path) -> None:
    later = segment(from_zero(5.0), x_columns, stamp="00:00:03.00")
    later = [line.replace("2020/01/02", "2020/01/03") for line in later]
    lines = [*head(x_columns), *segment(from_zero(), x_columns, stamp="23:59:58.00"), *later]
    as_expected(read(tmp_path, lines), from_zero(), from_zero(5.0))


@pytest.mark.parametrize("x_columns", ["No", "One", "Multi"])
@pytest.mark.parametrize("stamp", ["10:00:00.00", "10:00:05.00"])
def test_a_column_of_time_or_x0_that_goes_on_is_the_clock(x_columns: str, stamp: str, tmp_path: Path) -> None:
    """The moments may be those of the segments, or of the file."""
    lines = [*head(x_columns), *segment(from_zero(), x_columns)]
    lines += segment(from_zero(5.0), x_columns, stamp=stamp, x0="5")
    as_expected(read(tmp_path, lines), from_zero(), from_zero(5.0))


@pytest.mark.parametrize("x_columns", ["No", "One"])
def test_segments_that_follow_within_the_digits_of_their_moments(x_columns: str, tmp_path: Path) -> None:
    lines = [*head(x_columns), *segment(from_zero(), x_columns)]
    lines += segment(from_zero(N * STEP), x_columns, stamp="10:00:00.045")
    as_expected(read(tmp_path, lines), np.arange(2 * N) * STEP)
    coarse = [line.replace("10:00:00.00", "10:00:00").replace("10:00:00.045", "10:00:00") for line in lines]
    as_expected(read(tmp_path, coarse), np.arange(2 * N) * STEP)


def test_segments_without_a_clock(tmp_path: Path) -> None:
    both = [*segment(from_zero(), "No", stamp=""), *segment(from_zero(N * STEP), "No", stamp="")]
    log = read(tmp_path, [*head("No"), *both])
    as_expected(log, np.arange(2 * N) * STEP)
    assert "2 segments joined, 1 without a gap: their headers state no later time" in log.notes
    both = [*segment(from_zero(), "One", stamp=""), *segment(from_zero(), "One", stamp="")]
    with pytest.raises(MeasuredError, match=r"log.lvm:62: the time of segment 2 begins again at 0 s, and its"):
        read(tmp_path, [*head("One"), *both])


def test_segments_that_overlap_are_refused(tmp_path: Path) -> None:
    first = [*head("No"), *segment(from_zero(), "No", stamp="10:00:05.00")]
    earlier = segment(from_zero(), "No", stamp="10:00:04.00")
    with pytest.raises(MeasuredError, match=r"log.lvm:66: segment 2 begins 1 s before the first one by its header"):
        read(tmp_path, [*first, *earlier])
    soon = segment(from_zero(), "No", stamp="10:00:05.01")
    with pytest.raises(MeasuredError, match=r"segment 2 begins at 0.01 s by its header, before the end"):
        read(tmp_path, [*first, *soon])


@pytest.mark.parametrize("x_columns", ["No", "One", "Multi"])
def test_lines_of_later_headers_and_special_blocks(x_columns: str, tmp_path: Path) -> None:
    special = ["***Start_Special***", "1\t2\t3\t4", "Channels\t9", "***End_Special***", ""]
    more = ["Notes\ta\t\t", "Test_Name\tslot", "Anything\telse"]
    later = segment(from_zero(5.0), x_columns, stamp="10:00:05.00", more=more)
    lines = [
        *head(x_columns)[:-2],
        *special,
        *head(x_columns)[-2:],
        *segment(from_zero(), x_columns),
        "",
        *special,
        *later,
    ]
    as_expected(read(tmp_path, lines), from_zero(), from_zero(5.0))


def test_a_word_among_rows_is_no_header(tmp_path: Path) -> None:
    lines = [*head("One"), *segment(from_zero(), "One"), *segment(from_zero(5.0), "One", stamp="10:00:05.00")]
    lines[20] = "overload\t1\t2\t3"
    with pytest.raises(MeasuredError, match=r"log.lvm:21: 'overload' is not a number"):
        read(tmp_path, lines)
    lines[20] = "0.005\toverload\t2\t3"
    with pytest.raises(MeasuredError, match=r"log.lvm:21: 'overload' is not a number, .*\(field 2, Fx\)"):
        read(tmp_path, lines)


def test_columns_of_time_that_differ(tmp_path: Path) -> None:
    lines = [*head("Multi"), *segment(from_zero(), "Multi")]
    begin = len(lines) - N
    for k in range(N):
        cells = lines[begin + k].split("\t")
        cells[4] = f"{(k + 4) * STEP:.6f}"
        cells[5] = f"{force(np.array([(k + 4) * STEP]))[0, 2]:.6f}"
        lines[begin + k] = "\t".join(cells)
    log = read(tmp_path, lines)
    as_expected(log, from_zero()[4:])
    assert any("channels start at different times" in n for n in log.notes)


def test_channels_of_a_header_that_start_apart(tmp_path: Path) -> None:
    lines = [*head("No"), *segment(from_zero(), "No")]
    at = next(i for i, line in enumerate(lines) if line.startswith("X0"))
    lines[at] = "X0\t0\t0\t0.01"
    log = read(tmp_path, lines)
    assert len(log.t_s) == N - 10
    np.testing.assert_allclose(log.force_n[0], [force(from_zero())[10, 0], force(from_zero())[10, 1], 80.0], atol=1e-5)


def write_tdms(path: Path, **channels: dict[str, Any]) -> Path:
    """Channels of the same motion, each with its start, offset, length, and step."""
    from nptdms import ChannelObject, TdmsWriter

    made = []
    for name, c in channels.items():
        t_s = c.get("start", 0.0) + c.get("offset", 0.0) + np.arange(c.get("n", N)) * c.get("step", STEP)
        properties: dict[str, Any] = {"wf_increment": c.get("step", STEP), "wf_start_offset": c.get("offset", 0.0)}
        if "start" in c:
            micro = np.timedelta64(round(1e6 * c["start"]), "us")
            properties["wf_start_time"] = np.datetime64("2024-05-01T10:00:00", "us") + micro
        axis = "xyz".find(name[-1])
        made.append(ChannelObject("dyno", name, force(t_s)[:, axis], properties))
    with TdmsWriter(path) as writer:
        writer.write_segment(made)
    return path


@pytest.mark.parametrize("key", ["start", "offset"])
@pytest.mark.parametrize("late", [0.004, 0.0045])
def test_tdms_channels_that_start_apart(key: str, late: float, tmp_path: Path) -> None:
    same = {"start": 0.0} if key == "start" else {}
    path = write_tdms(tmp_path / "a.tdms", Fx=same, Fy={**same, key: late}, Fz=same)
    log = read_forces(path)
    np.testing.assert_allclose(log.force_n, force(late + np.arange(len(log.t_s)) * STEP), atol=1e-9)
    assert len(log.t_s) in (N - 4, N - 5)
    assert any("channels start at different times (Fx 0 s, Fy" in n for n in log.notes)


def test_tdms_channels_without_a_common_time_are_refused(tmp_path: Path) -> None:
    path = write_tdms(tmp_path / "a.tdms", Fx={"start": 0.0}, Fy={"start": 3.0}, Fz={"start": 3.0})
    with pytest.raises(MeasuredError, match=r"with 0 common samples: Fx 0 to 0.039 s, Fy 3 to 3.039 s"):
        read_forces(path)


def test_tdms_channels_of_different_length(tmp_path: Path) -> None:
    log = read_forces(write_tdms(tmp_path / "a.tdms", Fx={"n": N + 1}, Fy={}, Fz={"n": N - 1}))
    np.testing.assert_allclose(log.force_n, force(from_zero())[: N - 1])
    assert "columns of different length (Fx 41, Fy 40, Fz 39): the first 39 samples" in log.notes
    with pytest.raises(MeasuredError, match="columns of different length: Fx 40, Fy 10, Fz 40 samples"):
        read_forces(write_tdms(tmp_path / "a.tdms", Fx={}, Fy={"n": 10}, Fz={}))


def test_tdms_channels_beside_the_forces_do_not_matter(tmp_path: Path) -> None:
    path = write_tdms(tmp_path / "a.tdms", Fx={}, Fy={}, Fz={}, temperature={"step": 0.1, "n": 4}, level={"n": 3})
    log = read_forces(path)
    np.testing.assert_allclose(log.force_n, force(from_zero()))
    assert any("temperature (10 Hz), level (3 samples)" in n for n in log.notes)
    with pytest.raises(MeasuredError, match=r"several rates: dyno/Fx|several rates: Fx 1000 Hz, Fy 500 Hz"):
        read_forces(write_tdms(tmp_path / "b.tdms", Fx={}, Fy={"step": 0.002}, Fz={}))


def test_a_start_that_one_channel_lacks_is_noted() -> None:
    columns = [Named("a", "", np.arange(5.0), 10.0, 2.0), Named("b", "", np.arange(5.0), 10.0)]
    aligned = on_one_clock(Path("x"), columns, ["a", "b"])
    assert aligned.start_s == 2.0
    assert aligned.notes == ["no start stated for b: taken as the earliest of the others"]


def test_a_tdms_file_cut_short_is_noted(tmp_path: Path, capfd: pytest.CaptureFixture[str]) -> None:
    path = write_tdms(tmp_path / "a.tdms", Fx={}, Fy={}, Fz={})
    path.write_bytes(path.read_bytes()[:-100])
    log = read_forces(path)
    assert any(n.startswith("damaged: Last segment of file has less data than expected") for n in log.notes)
    assert "".join(capfd.readouterr()) == ""


def test_numbers_that_are_damage_are_left_out(tmp_path: Path) -> None:
    import h5py

    values = force(from_zero())
    values[3, 0], values[5, 1] = 1e300, np.inf
    with h5py.File(tmp_path / "a.h5", "w") as file:
        file["t"] = from_zero()
        for i, axis in enumerate("xyz"):
            file[f"F{axis}"] = values[:, i]
            file[f"F{axis}"].attrs["unit"] = "kN"
    log = read_forces(tmp_path / "a.h5")
    assert len(log.t_s) == N - 2
    assert any("2 rows without a number omitted" in n for n in log.notes)


def test_a_rate_that_is_damage_is_not_used(tmp_path: Path) -> None:
    import h5py

    with h5py.File(tmp_path / "a.h5", "w") as file:
        file.attrs["sampling_rate"] = 1e300
        for i, axis in enumerate("xyz"):
            file[f"F{axis}"] = force(from_zero())[:, i]
    with pytest.raises(MeasuredError, match="no column of time among"):
        read_forces(tmp_path / "a.h5")


@pytest.mark.parametrize(("word", "mark"), [("Comma", ","), ("Semicolon", ";")])
def test_other_separators_of_lvm(word: str, mark: str, tmp_path: Path) -> None:
    lines = [*head("One"), *segment(from_zero(), "One"), *segment(from_zero(5.0), "One", stamp="10:00:05.00")]
    lines = [line.replace("\t", mark).replace(f"Separator{mark}Tab", f"Separator{mark}{word}") for line in lines]
    as_expected(read(tmp_path, lines), from_zero(), from_zero(5.0))
    lines = [line.replace(f"Separator{mark}{word}", f"Separator\t{word}") for line in lines]
    as_expected(read(tmp_path, lines), from_zero(), from_zero(5.0))


def test_segments_of_lvm_at_another_rate_are_refused(tmp_path: Path) -> None:
    lines = [*head("No"), *segment(from_zero(), "No", stamp="10:00:05.00")]
    slower = segment(from_zero(), "No", stamp="10:00:09.00")
    slower = ["Delta_X" + "\t0.002" * 3 if line.startswith("Delta_X") else line for line in slower]
    with pytest.raises(MeasuredError, match="segment 2 is sampled at 500 Hz, the first one at 1000 Hz"):
        read(tmp_path, [*lines, *slower])


@pytest.mark.parametrize(("again", "begin"), [(5.0, 5.0), (0.0, N * STEP), (N * STEP, N * STEP), (-5.0, None)])
def test_tdms_files_written_in_parts(again: float, begin: float | None, tmp_path: Path) -> None:
    from nptdms import ChannelObject, TdmsWriter

    def written(start: float) -> list[ChannelObject]:
        moment = np.datetime64("2024-05-01T10:00:00", "us") + np.timedelta64(round(1e6 * start), "us")
        stated = {"wf_increment": STEP, "wf_start_time": moment}
        return [ChannelObject("dyno", f"F{a}", force(from_zero())[:, i], stated) for i, a in enumerate("xyz")]

    with TdmsWriter(tmp_path / "a.tdms") as writer:
        writer.write_segment(written(0.0))
        writer.write_segment(written(again))
    if begin is None:
        with pytest.raises(MeasuredError, match=r"dyno/Fx begins again at sample 41, 5.04 s before the end"):
            read_forces(tmp_path / "a.tdms")
        return
    log = read_forces(tmp_path / "a.tdms")
    np.testing.assert_allclose(log.t_s, np.concatenate([from_zero(), from_zero(begin)]), atol=1e-9)
    assert log.rate_hz == pytest.approx(1.0 / STEP)
