"""Every format gives back what was written, whatever its suffix."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from support.measured_files import FORMATS, RATE_HZ, forces, times, write_csv
from support.reference import REFERENCE
from support.slot_run import SlotRun

from twin.archive.force_table import joined_arrays
from twin.errors import MeasuredError
from twin.measured.forces import force_log, read_forces
from twin.measured.read import read_log
from twin.measured.settings import LogReading
from twin.measured.spindle import spindle_speed
from twin.measured.steady import find_cut
from twin.measured.zero import in_windows
from twin.sinks.mcap_sink import McapSink

DYNOWARE = REFERENCE / "measured" / "flat_slot_dynoware"
#: Mean forces that others found in the files, N, by feed, mm/min.
PUBLISHED = {
    300: (63.0, -39.8, 55.7),
    600: (107.1, -60.1, 70.9),
    900: (137.7, -71.6, 82.6),
    1200: (171.3, -76.8, 85.2),
    1500: (210.7, -78.5, 83.5),
}


@pytest.mark.parametrize("name", FORMATS)
def test_a_format_gives_back_what_was_written(name: str, tmp_path: Path) -> None:
    file, write, accuracy = FORMATS[name]
    write(tmp_path / file)
    log = read_forces(tmp_path / file)
    assert log.rate_hz == pytest.approx(RATE_HZ, rel=1e-6)
    np.testing.assert_allclose(log.t_s, times(), atol=1e-7)
    np.testing.assert_allclose(log.force_n, forces(), atol=accuracy * np.abs(forces()).max())
    assert log.gaps == ()


@pytest.mark.parametrize("name", FORMATS)
def test_the_suffix_does_not_matter(name: str, tmp_path: Path) -> None:
    _, write, accuracy = FORMATS[name]
    path = tmp_path / "log.mat" if name == "mat5" else tmp_path / "log.dat"
    write(path)
    log = read_forces(path)
    np.testing.assert_allclose(log.force_n, forces(), atol=accuracy * np.abs(forces()).max())


@pytest.mark.parametrize("name", ["lvm", "dynoware"])
def test_text_formats_in_utf_16(name: str, tmp_path: Path) -> None:
    file, write, _ = FORMATS[name]
    write(tmp_path / file)
    path = tmp_path / file
    wanted = read_forces(path)
    text = path.read_bytes().decode("cp1252").replace("Y_Unit_Label\tN\tN\tN", "Y_Unit_Label\tkN\tN\tN")
    path.write_bytes(text.encode("utf-16"))
    log = read_forces(path)
    factors = [1000.0, 1.0, 1.0] if name == "lvm" else [1.0, 1.0, 1.0]
    np.testing.assert_allclose(log.force_n, wanted.force_n * factors)
    assert log.rate_hz == wanted.rate_hz


def test_a_run_is_a_log(tmp_path: Path) -> None:
    run = SlotRun(step_mm=4.0, per_turn=30)
    with McapSink(tmp_path / "run.mcap") as sink:
        for record in run.records():
            sink.write(record)
    log = read_forces(tmp_path / "run.mcap")
    want = joined_arrays(run.records())
    force = np.column_stack([want["fx_n"], want["fy_n"], want["fz_n"]])
    np.testing.assert_allclose(log.force_n, force, rtol=0.0, atol=1e-6 * np.abs(force).max())
    assert log.spindle_angle_rad is not None
    np.testing.assert_allclose(log.spindle_angle_rad, want["spindle_angle_rad"])


@pytest.mark.parametrize(
    ("file", "data"),
    [
        ("a.tdms", b"TDSm" + b"\x00" * 10),
        ("a.h5", b"\x89HDF\r\n\x1a\n" + b"\x00" * 90),
        ("a.mat", b"MATLAB 5.0 nonsense"),
        ("a.parquet", b"PAR1abc"),
        ("a.mcap", b"\x89MCAP0\r\nabc"),
        ("a.xlsx", b"PK\x03\x04abc"),
        ("a.csv", b"no numbers"),
    ],
)
def test_damaged_files_are_refused_by_name(file: str, data: bytes, tmp_path: Path) -> None:
    (tmp_path / file).write_bytes(data)
    with pytest.raises(MeasuredError, match=file):
        read_log(tmp_path / file)


def test_forces_in_several_groups_must_be_chosen(tmp_path: Path) -> None:
    import h5py

    with h5py.File(tmp_path / "two.h5", "w") as file:
        for k, group in enumerate(("first", "second")):
            file[f"{group}/t"] = times()
            for i, axis in enumerate("xyz"):
                file[f"{group}/F{axis}"] = (k + 1) * forces()[:, i]
    with pytest.raises(MeasuredError, match="first, second; choose one by --group first"):
        read_log(tmp_path / "two.h5")
    log = read_forces(tmp_path / "two.h5", LogReading(group="second"))
    np.testing.assert_allclose(log.force_n, 2.0 * forces())
    with pytest.raises(MeasuredError, match="no group 'third'; expected one of first, second"):
        read_log(tmp_path / "two.h5", LogReading(group="third"))


def test_a_matrix_gets_names_from_the_command_line(tmp_path: Path) -> None:
    from scipy.io import savemat

    savemat(tmp_path / "m.mat", {"data": np.column_stack([times(), forces()])})
    raw = read_log(tmp_path / "m.mat", LogReading(columns=("t_s", "Fx_N", "Fy_N", "Fz_N")))
    np.testing.assert_allclose(force_log(raw).force_n, forces())
    with pytest.raises(MeasuredError, match=r"4 columns \(data\[1\], .*\), --columns gives 2 names"):
        read_log(tmp_path / "m.mat", LogReading(columns=("t_s", "Fx_N")))


def test_missing_files_and_folders(tmp_path: Path) -> None:
    with pytest.raises(MeasuredError, match="does not exist"):
        read_log(tmp_path / "none.csv")
    with pytest.raises(MeasuredError, match="is a folder"):
        read_log(tmp_path)


def test_workpiece_and_map_turn_signs(tmp_path: Path) -> None:
    write_csv(tmp_path / "a.csv")
    raw = read_log(tmp_path / "a.csv")
    x, y, z = forces().T
    log = force_log(raw, LogReading(map="x=-Fy,y=-Fx,z=Fz"))
    np.testing.assert_allclose(log.force_n, np.column_stack([-y, -x, z]))
    log = force_log(raw, LogReading(map="x=Fy, y=Fx, z=-Fz", force_on="workpiece"))
    np.testing.assert_allclose(log.force_n, np.column_stack([-y, -x, z]))
    assert log.channels == ("Fy", "Fx", "-Fz")


@pytest.mark.skipif(not DYNOWARE.is_dir(), reason="reference data not there")
@pytest.mark.parametrize("feed", PUBLISHED)
def test_genuine_dynoware_exports_have_the_published_means(feed: int) -> None:
    raw = read_log(DYNOWARE / f"6-n6000f{feed}ap3ae25.csv")
    log = force_log(raw)
    assert raw.format == "DynoWare export"
    assert (raw.rate_hz, len(raw.t_s)) == (10000.0, 10001)
    assert log.channels == ("Fx", "Fy", "Fz")
    np.testing.assert_allclose(log.force_n.mean(axis=0), PUBLISHED[feed], atol=0.06)
    steady = in_windows(log.t_s, [find_cut(log.t_s, log.force_n, 0.01, 2).cut_s])
    np.testing.assert_allclose(log.force_n[steady].mean(axis=0), PUBLISHED[feed], atol=0.06)
    speed = spindle_speed(log, 2, 6000.0)
    assert speed is not None and abs(speed.rpm - 6000.0) < 1.0


@pytest.mark.parametrize("imaginary", [0.0, 1.0])
def test_complex_numbers_of_hdf5_are_one_force_only_without_an_imaginary_part(imaginary: float, tmp_path: Path) -> None:
    import h5py

    with h5py.File(tmp_path / "log.h5", "w") as file:
        file["t"] = times()
        file["Fx"] = forces()[:, 0] + 1j * imaginary
        file["Fy"], file["Fz"] = forces()[:, 1], forces()[:, 2]
        file["remark"] = ["a", "b"]
    if imaginary:
        with pytest.raises(MeasuredError, match=r"not read: Fx \(complex numbers, which are not one force"):
            read_forces(tmp_path / "log.h5")
    else:
        log = read_forces(tmp_path / "log.h5")
        np.testing.assert_allclose(log.force_n, forces())
        assert "not read: remark (no numbers)" in log.notes


def write_logical(path: Path) -> None:
    """Forces along x as true and false, in the format of the suffix."""
    import h5py
    import pyarrow as pa
    from nptdms import ChannelObject, TdmsWriter
    from pyarrow import parquet
    from scipy.io import savemat

    columns = {"t": times(), "Fx": forces()[:, 0] > 0.0, "Fy": forces()[:, 1], "Fz": forces()[:, 2]}
    if path.suffix == ".mat":
        savemat(path, columns)
    elif path.suffix == ".parquet":
        parquet.write_table(pa.table(columns), path)
    elif path.suffix == ".tdms":
        with TdmsWriter(path) as writer:
            writer.write_segment([ChannelObject("g", name, values) for name, values in columns.items()])
    else:
        with h5py.File(path, "w") as file:
            for name, values in columns.items():
                file[name] = values


@pytest.mark.parametrize("suffix", [".mat", ".h5", ".parquet", ".tdms"])
def test_true_and_false_are_not_forces(suffix: str, tmp_path: Path) -> None:
    path = tmp_path / f"log{suffix}"
    write_logical(path)
    with pytest.raises(MeasuredError, match="column 'Fx' holds true and false, expected forces"):
        read_forces(path)
    log = read_forces(path, LogReading.model_validate({"map": "y=Fy,z=Fz", "trigger_column": "Fx"}))
    assert log.trigger_s is not None
