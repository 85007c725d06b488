"""Logs that tests write themselves, in every format: three asymmetric signals at 5 kHz."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

from twin.arrays import FloatArray

RATE_HZ = 5000.0
N = 400


def times() -> FloatArray:
    return np.arange(N) / RATE_HZ


def forces() -> FloatArray:
    """Shape (N, 3); no axis is another one with a sign."""
    t = times()
    x = 40.0 + 100.0 * np.sin(2 * np.pi * 120.0 * t) + 20.0 * np.sin(2 * np.pi * 240.0 * t + 0.5)
    y = -10.0 + 60.0 * np.abs(np.sin(2 * np.pi * 60.0 * t + 0.2)) ** 3
    z = 5.0 + 30.0 * np.cos(2 * np.pi * 120.0 * t) ** 5 - 8.0 * np.sin(2 * np.pi * 60.0 * t)
    return np.column_stack([x, y, z])


def rows() -> FloatArray:
    return np.column_stack([times(), forces()])


def write_csv(path: Path) -> None:
    lines = ["t_s,Fx_N,Fy_N,Fz_N", *(",".join(map(repr, row)) for row in rows().tolist())]
    path.write_text("\n".join(lines))


def write_dynoware(path: Path) -> None:
    head = ["DynoWare\tVersion 3.2.5.0", "Filename:\ta.dwd", f"Sampling rate [Hz]:\t{RATE_HZ:g}", "Cycles:\t1"]
    head += [f"Samples per channel:\t{N}", "Time\tFx\tFy\tFz", "s\tN\tN\tN"]
    body = ["\t".join(f"{v:.9g}".replace(".", ",") for v in row) for row in rows().tolist()]
    path.write_text("\r\n".join([*head, *body]), encoding="cp1252")


def write_tdms(path: Path) -> None:
    from nptdms import ChannelObject, TdmsWriter

    properties: dict[str, Any] = {"wf_increment": 1.0 / RATE_HZ, "wf_start_offset": 0.0, "unit_string": "kN"}
    with TdmsWriter(path) as writer:
        writer.write_segment(
            [ChannelObject("dyno", f"F{a}", 1e-3 * forces()[:, i], properties) for i, a in enumerate("xyz")]
        )


def write_lvm(path: Path) -> None:
    head = ["LabVIEW Measurement\t", "Writer_Version\t2", "Separator\tTab", "Decimal_Separator\t,", "X_Columns\tOne"]
    head += ["***End_of_Header***\t", "\t", "Channels\t3\t\t\t", "Samples\t200\t200\t200\t"]
    head += ["Y_Unit_Label\tN\tN\tN\t", "X0\t0,0E+0\t0,0E+0\t0,0E+0", f"Delta_X\t{1 / RATE_HZ:.6f}".replace(".", ",")]
    head += ["***End_of_Header***\t\t\t", "X_Value\tFx\tFy\tFz\tComment"]
    body = ["\t".join(f"{v:.9f}".replace(".", ",") for v in row) for row in rows().tolist()]
    body[0] += "\tbegin of the cut"
    second = [*head[7:], *body[N // 2 :]]
    path.write_text("\n".join([*head, *body[: N // 2], *second]))


def write_mat5(path: Path) -> None:
    from scipy.io import savemat

    savemat(
        path, {"log": {"t": times(), "Fx": forces()[:, 0], "Fy": forces()[:, 1], "Fz": forces()[:, 2], "name": "a"}}
    )


def write_mat73(path: Path) -> None:
    import h5py

    with h5py.File(path, "w", userblock_size=512) as file:
        for name, values in (("Fx", forces()[:, 0]), ("Fy", forces()[:, 1]), ("Fz", forces()[:, 2])):
            file[name] = values[None, :]
            file[name].attrs["MATLAB_class"] = np.bytes_("double")
        file["fs"] = np.array([[RATE_HZ]])
        file["comment"] = np.frombuffer("slot".encode("utf-16-le"), np.uint16)[None, :]
        file["comment"].attrs["MATLAB_class"] = np.bytes_("char")
    with path.open("r+b") as raw:
        raw.write(b"MATLAB 7.3 MAT-file, Platform: GLNXA64".ljust(124) + b"\x00\x02IM")


def write_hdf5(path: Path) -> None:
    import h5py

    with h5py.File(path, "w") as file:
        group = file.create_group("run1/dyno")
        group.attrs["sampling_rate"] = RATE_HZ
        for i, axis in enumerate("xyz"):
            group[f"force_{axis}"] = 1e-3 * forces()[:, i]
            group[f"force_{axis}"].attrs["unit"] = "kN"


def write_hdf5_compound(path: Path) -> None:
    import h5py

    made = np.zeros(N, [("time", "f8"), ("Fx", "f4"), ("Fy", "f4"), ("Fz", "f4")])
    for name, values in zip(made.dtype.names or (), rows().T, strict=True):
        made[name] = values
    with h5py.File(path, "w") as file:
        file["table"] = made
        file["table"].attrs["units"] = ["s", "N", "N", "N"]


def write_parquet(path: Path) -> None:
    import pyarrow as pa
    from pyarrow import parquet

    stamps = pa.array((times() * 1e9).round().astype(np.int64)).cast(pa.timestamp("ns"))
    columns: dict[str, Any] = {"stamp": stamps, "note": pa.array(["a"] * N)}
    columns |= {f"F{a} [N]": forces()[:, i] for i, a in enumerate("xyz")}
    parquet.write_table(pa.table(columns), path)


def write_foreign_mcap(path: Path) -> None:
    """Force messages of another program, in JSON."""
    import json

    from mcap.writer import Writer

    with path.open("wb") as file:
        writer = Writer(file)
        writer.start()
        schema = writer.register_schema(name="Wrench", encoding="jsonschema", data=b"{}")
        channel = writer.register_channel(topic="/dyno/force", message_encoding="json", schema_id=schema)
        for t, (x, y, z) in zip(times(), forces().tolist(), strict=True):
            ns = 1_700_000_000_000_000_000 + round(t * 1e9)
            data = json.dumps({"force": {"x": x, "y": y, "z": z}, "frame": "dyno"}).encode()
            writer.add_message(channel_id=channel, log_time=ns, publish_time=ns, data=data)
        writer.finish()


#: File name, writer, and relative accuracy of what it keeps.
FORMATS: dict[str, tuple[str, Callable[[Path], None], float]] = {
    "csv": ("log.csv", write_csv, 1e-12),
    "dynoware": ("log.txt", write_dynoware, 1e-6),
    "tdms": ("log.tdms", write_tdms, 1e-12),
    "lvm": ("log.lvm", write_lvm, 1e-6),
    "mat5": ("log.mat", write_mat5, 1e-12),
    "mat73": ("log.mat", write_mat73, 1e-12),
    "hdf5": ("log.h5", write_hdf5, 1e-12),
    "hdf5 compound": ("log.hdf5", write_hdf5_compound, 1e-5),
    "parquet": ("log.parquet", write_parquet, 1e-12),
    "foreign mcap": ("log.mcap", write_foreign_mcap, 1e-12),
}
