"""MATLAB files: cells, structs and their arrays are read, objects refused by class; damage is an error, never more."""

from __future__ import annotations

import random
import struct
import zlib
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from support.measured_files import RATE_HZ, forces, times

from twin.errors import MeasuredError
from twin.measured.forces import read_forces
from twin.measured.formats.matlab_v5 import DamagedError, variables
from twin.measured.log import ForceLog
from twin.measured.read import read_log

X, Y, Z = forces().T
T = times()
ROWS = np.column_stack([T, X, Y, Z]).tolist()
CHANNELS = [{"name": f"F{a}", "data": v, "unit": "N", "dt": 1 / RATE_HZ} for a, v in zip("xyz", (X, Y, Z), strict=True)]


def cell(*values: Any) -> np.ndarray[Any, Any]:
    made = np.empty(len(values), object)
    made[:] = values
    return made


def cells(rows: list[list[Any]]) -> np.ndarray[Any, Any]:
    made = np.empty((len(rows), len(rows[0])), object)
    for i, row in enumerate(rows):
        for k, value in enumerate(row):
            made[i, k] = value
    return made


def struct_array(elements: list[dict[str, Any]]) -> np.ndarray[Any, Any]:
    made = np.empty((1, len(elements)), [(k, object) for k in elements[0]])
    for i, each in enumerate(elements):
        made[0, i] = tuple(each.values())
    return made


SHAPES: dict[str, dict[str, Any]] = {
    "arrays": {"t": T, "Fx": X, "Fy": Y, "Fz": Z},
    "a cell of three": {"F": cell(X, Y, Z), "fs": RATE_HZ},
    "a matrix of three": {"F": np.column_stack([X, Y, Z]), "fs": RATE_HZ},
    "a table in cells": {"raw": cells([["t", "Fx", "Fy", "Fz"], *ROWS])},
    "names above arrays": {"raw": cells([["t", "Fx", "Fy", "Fz"], [T, X, Y, Z]])},
    "a struct": {"log": {"t": T, "Fx": X, "Fy": Y, "Fz": Z, "by": "me"}},
    "structs of channels": {"ch": struct_array(CHANNELS)},
    "structs of numbers": {"s": struct_array([dict(zip(("t", "Fx", "Fy", "Fz"), row, strict=True)) for row in ROWS])},
    "a cell of channels": {"ch": cell(*CHANNELS)},
    "Simulink": {
        "S": {"time": T, "signals": struct_array([{"values": c["data"], "label": c["name"]} for c in CHANNELS])}
    },
    "times one longer": {"t": np.append(T, 1.0), "Fx": X, "Fy": Y, "Fz": Z},
}


def read5(tmp_path: Path, data: dict[str, Any], *, compress: bool = False) -> ForceLog:
    from scipy.io import savemat

    savemat(tmp_path / "log.mat", data, do_compression=compress)
    return read_forces(tmp_path / "log.mat")


@pytest.mark.parametrize("compress", [False, True])
@pytest.mark.parametrize("shape", SHAPES)
def test_values_of_version_5(shape: str, compress: bool, tmp_path: Path) -> None:
    log = read5(tmp_path, SHAPES[shape], compress=compress)
    np.testing.assert_allclose(log.force_n, forces())
    np.testing.assert_allclose(log.t_s, T, atol=1e-12)


def test_version_4(tmp_path: Path) -> None:
    from scipy.io import savemat

    savemat(tmp_path / "log.mat", {"t": T, "Fx": X, "Fy": Y, "Fz": Z, "who": "me"}, format="4")
    np.testing.assert_allclose(read_forces(tmp_path / "log.mat").force_n, forces())


def write73(path: Path, fill: Callable[[Any], None]) -> Path:
    import h5py

    with h5py.File(path, "w", userblock_size=512) as file:
        fill(file)
    with path.open("r+b") as raw:
        raw.write(b"MATLAB 7.3 MAT-file, Platform: GLNXA64".ljust(124) + b"\x00\x02IM")
    return path


def put(file: Any, name: str, values: Any, class_name: str, **attributes: Any) -> Any:
    if isinstance(values, str):
        values = np.frombuffer(values.encode("utf-16-le"), np.uint16)[None, :]
    made = file.create_dataset(name, data=values)
    made.attrs["MATLAB_class"] = np.bytes_(class_name)
    for key, value in attributes.items():
        made.attrs[key] = value
    return made


def references(file: Any, values: list[Any]) -> Any:
    import h5py

    made = np.empty((1, len(values)), h5py.ref_dtype)
    for i, value in enumerate(values):
        kind = "char" if isinstance(value, str) else "double"
        node = put(file, f"#refs#/{len(file['#refs#']) if '#refs#' in file else 0}", value, kind)
        made[0, i] = node.ref
    return made


def test_cells_of_version_7_3(tmp_path: Path) -> None:
    def fill(file: Any) -> None:
        put(file, "F", references(file, [X[None], Y[None], Z[None]]), "cell")
        put(file, "fs", np.array([[RATE_HZ]]), "double")

    log = read_forces(write73(tmp_path / "a.mat", fill))
    np.testing.assert_allclose(log.force_n, forces())
    assert log.rate_hz == RATE_HZ


def test_structs_of_version_7_3(tmp_path: Path) -> None:
    def fill(file: Any) -> None:
        ch = file.create_group("ch")
        ch.attrs["MATLAB_class"] = np.bytes_("struct")
        ch["name"] = references(file, ["Fx", "Fy", "Fz"])
        ch["data"] = references(file, [X[None], Y[None], Z[None]])
        one = file.create_group("log")
        one.attrs["MATLAB_class"] = np.bytes_("struct")
        put(one, "t", T[None], "double")

    np.testing.assert_allclose(read_forces(write73(tmp_path / "a.mat", fill)).force_n, forces())


def opaque5(class_name: str) -> bytes:
    """A file of version 5 with one object, as MATLAB writes them."""

    def element(kind: int, data: bytes) -> bytes:
        return struct.pack("<II", kind, len(data)) + data + b"\0" * (-len(data) % 8)

    numbers = element(6, struct.pack("<6I", 0xDD000000, 2, 1, 1, 1, 1))
    inner = element(6, struct.pack("<II", 13, 0)) + element(5, struct.pack("<ii", 6, 1)) + element(1, b"") + numbers
    body = element(6, struct.pack("<II", 17, 0))
    body += element(1, b"T") + element(1, b"MCOS") + element(1, class_name.encode()) + element(14, inner)
    return b"MATLAB 5.0 MAT-file".ljust(124) + struct.pack("<H", 0x0100) + b"IM" + element(14, body)


@pytest.mark.parametrize("version", [5, 7])
@pytest.mark.parametrize(
    ("class_name", "how"),
    [
        ("table", r"writetable\(T, 'log.csv'\)"),
        ("timetable", r"writetimetable\(T, 'log.csv'\)"),
        ("timeseries", r"t = T.Time; F = T.Data; save\('log.mat', 't', 'F'\)"),
        ("Dyno", "save its numbers as arrays"),
    ],
)
def test_objects_are_refused_by_class(version: int, class_name: str, how: str, tmp_path: Path) -> None:
    def fill(file: Any) -> None:
        put(file, "T", np.array([[0xDD000000, 2, 1, 1, 1, 1]], np.uint32), class_name, MATLAB_object_decode=np.int32(3))

    path = tmp_path / "a.mat"
    if version == 5:
        path.write_bytes(opaque5(class_name))
    else:
        write73(path, fill)
    with pytest.raises(
        MeasuredError, match=rf"not read: T \(a MATLAB {class_name}, which only MATLAB can read; .*: {how}\)"
    ):
        read_log(path)


@pytest.mark.parametrize("form", ["4", "5", "7.3"])
def test_complex_forces_are_refused_unless_they_are_real(form: str, tmp_path: Path) -> None:
    from scipy.io import savemat

    path = tmp_path / "a.mat"
    for imaginary in (0.0, 2.0):
        if form == "7.3":
            x = np.zeros((1, len(X)), [("real", "f8"), ("imag", "f8")])
            x["real"], x["imag"] = X, imaginary
            columns = {"Fx": x, "t": T[None], "Fy": Y[None], "Fz": Z[None]}
            write73(path, lambda file, of=columns: [put(file, k, v, "double") for k, v in of.items()])
        else:
            savemat(path, {"t": T, "Fx": X + imaginary * 1j, "Fy": Y, "Fz": Z}, format=form)
        if imaginary:
            with pytest.raises(MeasuredError, match=r"not read: Fx \(a MATLAB complex array, .*Fx = real\(Fx\)"):
                read_forces(path)
        else:
            np.testing.assert_allclose(read_forces(path).force_n, forces())


def test_references_in_a_ring_are_an_error(tmp_path: Path) -> None:
    def fill(file: Any) -> None:
        import h5py

        ring = file.create_dataset("F", (1, 2), h5py.ref_dtype)
        ring.attrs["MATLAB_class"] = np.bytes_("cell")
        ring[0, 0] = ring[0, 1] = ring.ref

    with pytest.raises(MeasuredError, match=r"a.mat: no MATLAB file that can be read: (values nested|more than)"):
        read_log(write73(tmp_path / "a.mat", fill))


def test_any_damage_of_version_5(tmp_path: Path) -> None:
    from scipy.io import savemat

    rng = random.Random(11)
    data = {
        **SHAPES["structs of channels"],
        "c": SHAPES["a table in cells"]["raw"][:4],
        "text": "abc",
        "u": np.uint8(5),
    }
    for compress in (False, True):
        savemat(tmp_path / "log.mat", data, do_compression=compress)
        whole = (tmp_path / "log.mat").read_bytes()
        for _ in range(300):
            made = bytearray(whole)
            for _ in range(rng.randrange(1, 5)):
                made[rng.choice((rng.randrange(124, 600), rng.randrange(len(made))))] = rng.choice(
                    (0, 1, 127, 255, 14, 9)
                )
            if rng.random() < 0.2:
                del made[rng.randrange(len(made)) :]
            try:
                list(variables(bytes(made), 1 << 24))
            except DamagedError:
                continue


def test_a_variable_that_unpacks_to_too_much(tmp_path: Path) -> None:
    body = zlib.compress(struct.pack("<II", 14, (1 << 30) - 8) + bytes(1 << 22))
    head = b"MATLAB 5.0 MAT-file".ljust(124) + struct.pack("<H", 0x0100) + b"IM"
    data = head + struct.pack("<II", 15, len(body)) + body
    with pytest.raises(DamagedError, match=r"a variable unpacks to more than the 0.00105 GB expected of this file"):
        list(variables(data, 1 << 20))
    with pytest.raises(DamagedError, match="an element claims"):
        list(variables(data, 1 << 24))


def test_a_data_set_larger_than_its_file_may_be(tmp_path: Path) -> None:
    import h5py

    for name in ("a.h5", "a.mat"):
        with h5py.File(tmp_path / name, "w") as file:
            file.create_dataset("Fx", (1 << 36,), "f8", chunks=(1 << 16,), compression="gzip")
        with pytest.raises(MeasuredError, match=rf"{name}: its (data sets|variables) would unpack to 550 GB"):
            read_log(tmp_path / name)


def test_clocks_of_data_sets_in_hdf5(tmp_path: Path) -> None:
    import h5py

    with h5py.File(tmp_path / "a.h5", "w") as file:
        for group, rate in (("dyno", RATE_HZ), ("slow", 10.0)):
            file.create_group(group).attrs["sampling_rate"] = rate
        for i, axis in enumerate("xyz"):
            file[f"dyno/F{axis}"] = np.rint(100.0 * forces()[:, i]).astype(np.int32)
            file[f"dyno/F{axis}"].attrs["scale_factor"] = 0.01
        file["slow/temperature"] = np.arange(5.0)
    log = read_forces(tmp_path / "a.h5")
    assert log.rate_hz == RATE_HZ
    np.testing.assert_allclose(log.force_n, forces(), atol=0.005)
    with h5py.File(tmp_path / "a.h5", "r+") as file:
        for i, axis in enumerate("xyz"):
            file[f"dyno/F{axis}"].attrs["sampling_rate"] = RATE_HZ
            file[f"dyno/F{axis}"].attrs["t0"] = 0.002 * (i == 1)
    log = read_forces(tmp_path / "a.h5")
    np.testing.assert_allclose(log.force_n[:, 0], forces()[10:, 0], atol=0.005)
    np.testing.assert_allclose(log.force_n[:, 1], forces()[:-10, 1], atol=0.005)


def test_channels_of_structs_with_their_own_starts(tmp_path: Path) -> None:
    late = [{**c, "t0": 0.002 if c["name"] == "Fy" else 0.0} for c in CHANNELS]
    log = read5(tmp_path, {"ch": struct_array(late)})
    np.testing.assert_allclose(log.force_n[:, 0], X[10:])
    np.testing.assert_allclose(log.force_n[:, 1], Y[:-10])
    assert any("channels start at different times" in note for note in log.notes)


def test_objects_next_to_forces_are_noted(tmp_path: Path) -> None:
    def fill(file: Any) -> None:
        for name, values in (("t", T), ("Fx", X), ("Fy", Y), ("Fz", Z)):
            put(file, name, values[None], "double")
        put(file, "when", np.array([[0xDD000000, 2]], np.uint32), "datetime", MATLAB_object_decode=np.int32(3))
        file.create_group("T").attrs["MATLAB_class"] = np.bytes_("table")

    log = read_forces(write73(tmp_path / "a.mat", fill))
    np.testing.assert_allclose(log.force_n, forces())
    noted = next(note for note in log.notes if note.startswith("not read: "))
    assert "T (a MATLAB table" in noted and "when (a MATLAB datetime" in noted


@pytest.mark.parametrize("name", ["a.h5", "a.mat"])
@pytest.mark.parametrize("size", [512, 1 << 19])
def test_a_chunk_that_unpacks_to_more_than_it_holds(name: str, size: int, tmp_path: Path) -> None:
    import h5py

    packer = zlib.compressobj(9)
    zeros = bytes(1 << 23)
    packed = b"".join(packer.compress(zeros) for _ in range(40 if size > 512 else 1)) + packer.flush()
    with h5py.File(tmp_path / name, "w") as file:
        made = file.create_dataset("Fx", (size,), "f8", chunks=(size,), compression="gzip")
        made.id.write_direct_chunk((0,), packed)
    with pytest.raises(MeasuredError, match=r"data set /Fx: a chunk (of \d+ bytes|that unpacks to more than 4194304)"):
        read_log(tmp_path / name)
