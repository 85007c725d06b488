"""``twin compare``: tables, JSON, report, archive, timeline, batches, and what it says to mistakes."""

from __future__ import annotations

import json
import re
import shutil
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from support.compared import log_of, records, write_log
from support.compared import run as made_run

from twin.arrays import frozen
from twin.cli import run
from twin.comparison.batch import OUT_COLUMNS
from twin.record import Attachment, RunHeader
from twin.settings.toml_text import toml_text
from twin.sinks.mcap_sink import McapSink

TOOL = made_run()
WINDOWS = ["--window", "3.00:3.02", "--window", "5.00:5.02"]


@pytest.fixture(scope="module")
def made(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("made")
    write_run(folder / "run.mcap")
    write_log(folder / "ap1.csv", log_of(TOOL, lag_s=0.0123, add_n=(1.0, -2.0, 3.0)))
    return folder


@pytest.fixture
def archive(made: Path, tmp_path: Path) -> Path:
    return Path(shutil.copy(made / "run.mcap", tmp_path))


@pytest.fixture
def measured(made: Path, tmp_path: Path) -> Path:
    return Path(shutil.copy(made / "ap1.csv", tmp_path))


def write_run(path: Path, job: str = "", **parameters: str) -> Path:
    with McapSink(path) as sink:
        for record in records(parameters):
            if isinstance(record, RunHeader):
                file = Attachment(name="job.toml", media_type="application/toml", data=job.encode())
                record = replace(record, attachments=(file,))
            sink.write(record)
    return path


def compared(capsys: pytest.CaptureFixture[str], *arguments: object) -> dict[str, Any]:
    assert run(["compare", *map(str, arguments), "--json"]) == 0
    found: dict[str, Any] = json.loads(capsys.readouterr().out)
    return found


def failed(capsys: pytest.CaptureFixture[str], *arguments: object) -> str:
    assert run(["compare", *map(str, arguments)]) == 1
    return capsys.readouterr().err


def test_the_table_of_the_paper(archive: Path, measured: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert run(["compare", str(archive), str(measured), *WINDOWS]) == 0
    text = capsys.readouterr().out
    lines = [" ".join(line.split()) for line in text.splitlines()]
    assert "window mean Fx Fy Fz maximum Fx Fy Fz" in lines
    row = next(line for line in lines if line.startswith("3.00–3.02 s") and len(line.split()) == 8)
    values = [float(v) for v in row.split()[2:]]
    assert values[:3] == pytest.approx([1.0, 2.0, 3.0], abs=0.02)
    assert any(line.startswith("lag log 0.012300 s late, by cross-correlation") for line in lines)
    assert "axes x=Fx [N],y=Fy [N],z=Fz [N], by the columns' names" in text
    assert (archive.parent / "run.ap1.compare.mcap").is_file()


def test_json_has_everything(archive: Path, measured: Path, capsys: pytest.CaptureFixture[str]) -> None:
    found = compared(capsys, archive, measured, *WINDOWS, "--lag", "auto", "--lowpass", 1000, "--offset", "air")
    assert found["lag_s"] == pytest.approx(0.0123, abs=1e-5)
    assert [c["kind"] for c in found["corrections"]] == ["lowpass", "offset", "lag"]
    assert [w["begin_s"] for w in found["windows"]] == [3.0, 5.0]
    errors = found["windows"][0]["errors"]
    assert list(errors) == ["x", "y", "z", "resultant"]
    assert errors["x"]["max_n"] < 0.2
    assert {line["tooth_order"] for line in found["windows"][0]["harmonics"]} >= {1, 2, None}
    assert found["axes"] == {"x": "Fx", "y": "Fy", "z": "Fz"}


def test_everything_can_be_switched_off(archive: Path, measured: Path, capsys: pytest.CaptureFixture[str]) -> None:
    found = compared(capsys, archive, measured, "--lag", 0)
    assert [c["kind"] for c in found["corrections"]] == ["lag"]
    assert found["corrections"][0]["values"] == {"lag_s": 0.0, "found": "given"}


def test_map_and_body(archive: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    log = log_of(TOOL)
    x, y, z = log.force_n.T
    turned = replace(log, force_n=frozen(np.column_stack([-y, -x, z]), "force_n", (None, 3)))
    path = write_log(tmp_path / "dyno.csv", turned, "t_s,A,B,C")
    found = compared(capsys, archive, path, "--map", "x=-B,y=-A,z=C", *WINDOWS)
    assert all(e["max_n"] < 0.02 for w in found["windows"] for e in w["errors"].values())
    found = compared(capsys, archive, path, "--map", "x=B,y=A,z=-C", "--force-on", "workpiece", *WINDOWS)
    assert all(e["max_n"] < 0.02 for w in found["windows"] for e in w["errors"].values())
    message = failed(capsys, archive, path)
    assert 'columns are A, B, C; give them with their signs, e.g. --map "x=A,y=B,z=C"' in message
    assert "no column 'Q'" in failed(capsys, archive, path, "--map", "x=Q,y=A,z=C")
    assert "'w=A' is not axis = column" in failed(capsys, archive, path, "--map", "w=A")


def test_the_jobs_measured_table_is_used(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = write_log(tmp_path / "dyno.csv", log_of(TOOL, lag_s=0.2), "a,b,c,d")
    keys = {"columns": ["t_s", "F1_N", "F2_N", "F3_N"], "map": "x=F1,y=F2,z=F3", "lag_s": 0.2}
    job = toml_text({"measured": {"file": path.name, **keys}})
    archive = write_run(tmp_path / "run.mcap", job, **{"measured.file": str(path)})
    found = compared(capsys, archive)
    assert found["lag_s"] == 0.2 and found["windows"][0]["errors"]["x"]["max_n"] < 1e-3
    plain = write_run(tmp_path / "plain.mcap")
    assert "no log given, and its job has no measured.file" in failed(capsys, plain)


def test_a_batch_reads_and_corrects_as_the_options_do(
    archive: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    rows = np.column_stack([log_of(TOOL).t_s, log_of(TOOL).force_n])
    text = "\n".join("\t".join(f"{v:.6f}".replace(".", ",") for v in row) for row in rows.tolist())
    (tmp_path / "dyno.txt").write_text(text)
    columns = '"t_s,Fx_N,Fy_N,Fz_N"'
    (tmp_path / "t.csv").write_text(
        "run,measured,columns,delimiter,decimal,notches,causal,lag_s\n"
        f'run.mcap,dyno.txt,{columns},tab,",",700 900:20,true,0\n'
    )
    assert run(["compare", "--batch", str(tmp_path / "t.csv"), "--json"]) == 0
    by_table = json.loads(capsys.readouterr().out)[0]["comparison"]
    options = ("--columns", "t_s,Fx_N,Fy_N,Fz_N", "--delimiter", "tab", "--decimal", ",", "--causal", "--lag", 0)
    by_options = compared(capsys, archive, tmp_path / "dyno.txt", *options, "--notch", "700", "--notch", "900:20")
    assert by_table == by_options
    assert [c["kind"] for c in by_table["corrections"]] == ["notch", "notch", "lag"]


def test_a_run_against_a_run(archive: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    found = compared(capsys, archive, shutil.copy(archive, tmp_path / "other.mcap"))
    assert found["lag_s"] == pytest.approx(0.0, abs=1e-6) and found["correlation"] > 0.9999
    assert found["measured_rpm"] == pytest.approx(3600.0) and found["warnings"] == []


def test_an_angle_becomes_time_by_the_speed(archive: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    log = log_of(TOOL, span_s=(3.0, 3.3))
    rows = np.column_stack([np.mod(360.0 * 60.0 * log.t_s, 360.0), log.force_n])
    np.savetxt(tmp_path / "a.csv", rows, delimiter=",", header="angle_deg,Fx_N,Fy_N,Fz_N", comments="", fmt="%.9g")
    assert "one of an angle, 'angle_deg'; give the spindle speed by --rpm" in failed(
        capsys, archive, tmp_path / "a.csv"
    )
    found = compared(capsys, archive, tmp_path / "a.csv", "--rpm", 3600)
    assert found["correlation"] > 0.99


def test_report_is_one_file_with_pictures_in_it(
    archive: Path, measured: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    folder = tmp_path / "report"
    assert run(["compare", str(archive), str(measured), *WINDOWS, "--report", str(folder)]) == 0
    text = (folder / "report.html").read_text()
    pictures = re.findall(r'<img alt="([^"]+)" src="data:image/png;base64,([\w+/=]+)"', text)
    assert len(pictures) == 7
    assert "http" not in text
    assert {p.name for p in folder.iterdir()} >= {"whole.png", "window_1.png", "window_2.png", "spectra.png"}
    assert {p.name for p in folder.iterdir()} >= {"histogram.png", "polar_1.png", "report.html", "comparison.json"}
    assert all((folder / p.name).read_bytes().startswith(b"\x89PNG") for p in folder.glob("*.png"))
    for words in ("mean error, N", "3.00–3.02 s", "1 × tooth passing", "by cross-correlation", "ball D8 z2"):
        assert words in text
    assert "Report" in capsys.readouterr().out


@pytest.mark.parametrize("axes", ["x=Fx,y=Fy", "z=Fz"])
def test_report_of_some_axes(axes: str, archive: Path, measured: Path, tmp_path: Path) -> None:
    assert run(["compare", str(archive), str(measured), "--map", axes, *WINDOWS[:2], "--report", str(tmp_path)]) == 0
    assert ("Fz</th>" in (tmp_path / "report.html").read_text()) == ("z" in axes)


def test_the_comparisons_file_can_be_read_again(archive: Path, measured: Path, tmp_path: Path) -> None:
    from twin.archive.comparison_file import read_comparison

    out = tmp_path / "c.mcap"
    assert run(["compare", str(archive), str(measured), *WINDOWS, "--mcap", str(out)]) == 0
    forces, result = read_comparison(out)
    assert result["lag_s"] == pytest.approx(0.0123, abs=1e-5)
    log = log_of(TOOL, lag_s=0.0123, add_n=(1.0, -2.0, 3.0))
    assert len(forces.t_s) == pytest.approx(len(log.t_s) - 61, abs=2)
    np.testing.assert_allclose(forces.simulated_n - forces.measured_n + [1.0, -2.0, 3.0], 0.0, atol=0.05)
    assert run(["info", str(out)]) == 1
    rrd = tmp_path / "c.rrd"
    assert run(["view", str(out), "--rrd", str(rrd)]) == 0 and rrd.stat().st_size > 100_000
    assert run(["view", str(out), "--rrd", str(rrd)]) == 1


def test_recording_for_the_viewer(archive: Path, measured: Path, tmp_path: Path) -> None:
    assert run(["compare", str(archive), str(measured), "--rrd", str(tmp_path / "c.rrd")]) == 0
    assert (tmp_path / "c.rrd").stat().st_size > 100_000


def test_a_folder_that_cannot_be_written_is_only_a_warning(
    archive: Path, measured: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    from twin.comparison import store

    monkeypatch.setattr(store, "archive_path", lambda run, _log: run / "below_a_file.mcap")
    assert run(["compare", str(archive), str(measured)]) == 0
    assert "the comparison is not archived" in capsys.readouterr().err
    assert run(["compare", str(archive), str(measured), "--mcap", str(archive / "a.mcap")]) == 1


@pytest.mark.parametrize(
    ("options", "message"),
    [
        (["--window", "4"], '--window[0] = "4": expected BEGIN:END in seconds, e.g. 4.00:4.02'),
        (["--window", "4:3"], "ends at 3 s, expected an end after its beginning"),
        (["--lag", "soon"], '--lag = "soon": expected auto or seconds'),
        (["--offset", "1,2"], '--offset = "1,2": expected air, none, BEGIN:END'),
        (["--notch", "x"], '--notch[0] = "x": expected HZ or HZ:QUALITY'),
        (["--lowpass", "4000"], "lowpass at 4000 Hz: expected it below half the sampling rate, 2500 Hz"),
        (["--lag", "60"], "no overlap in time"),
        (["--window", "70:71"], "window 70:71: 0 samples"),
        (["--unit", "mV"], "is in 'mV', expected a unit of force"),
        (["--rate", "-1"], "--rate = -1.0: expected a number above 0"),
        (["--columns", "t,a"], "4 columns, --columns gives 2 names: t, a"),
    ],
)
def test_mistakes_are_named(
    options: list[str], message: str, archive: Path, measured: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    text = failed(capsys, archive, measured, *options)
    assert message in text and "Traceback" not in text
    assert not list(archive.parent.glob("*.compare.mcap"))


def test_missing_files_and_arguments(archive: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert "does not exist, expected a measured log" in failed(capsys, archive, tmp_path / "none.csv")
    assert "cannot be read" in failed(capsys, tmp_path / "none.mcap", tmp_path / "none.csv")
    assert run(["compare"]) == 2
    assert run(["compare", str(archive), "--batch", "t.csv"]) == 2


@pytest.mark.parametrize("kind", ["csv", "toml"])
def test_a_batch_keeps_going_after_a_bad_row(
    kind: str, archive: Path, measured: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    table = tmp_path / f"table.{kind}"
    if kind == "csv":
        table.write_text(
            "name,run,measured,windows,lag\n"
            "first,run.mcap,ap1.csv,3.00:3.02 5.00:5.02,auto\n"
            "gone,run.mcap,none.csv,,\n"
            "last,run.mcap,ap1.csv,,0.0123\n"
        )
    else:
        table.write_text(
            '[[compare]]\nname = "first"\nrun = "run.mcap"\nmeasured = "ap1.csv"\n'
            'windows = ["3.00:3.02", "5.00:5.02"]\n'
            '[[compare]]\nname = "gone"\nrun = "run.mcap"\nmeasured = "none.csv"\n'
            '[[compare]]\nname = "last"\nrun = "run.mcap"\nmeasured = "ap1.csv"\nlag = 0.0123\n'
        )
    out = tmp_path / "errors.csv"
    assert run(["compare", "--batch", str(table), "-o", str(out)]) == 1
    said = capsys.readouterr()
    assert re.search(r"row (3|2) \(gone\): .*none.csv: does not exist", said.err)
    rows = [line.split(",") for line in out.read_text().splitlines()]
    assert rows[0] == list(OUT_COLUMNS)
    assert [r[1] for r in rows[1:]] == ["first"] * 8 + ["gone"] + ["last"] * 4
    assert float(rows[1][OUT_COLUMNS.index("mean_abs_n")]) == pytest.approx(1.0, abs=0.02)
    assert "failed" in said.out and "3.00–3.02 s" in said.out


def test_tables_that_are_none(archive: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    def table(text: str, name: str = "t.csv") -> Path:
        (tmp_path / name).write_text(text)
        return tmp_path / name

    assert "no column 'measured'" in failed(capsys, "--batch", table("run\na.mcap\n"))
    assert "no rows" in failed(capsys, "--batch", table("run,measured\n"))
    assert "no [[compare]] tables" in failed(capsys, "--batch", table("a = 1\n", "t.toml"))
    assert "t.toml:1:5: not valid TOML" in failed(capsys, "--batch", table("a = \n", "t.toml"))
    assert "cannot be read" in failed(capsys, "--batch", tmp_path / "none.csv")
    assert "speed: unknown key; expected one of" in failed(
        capsys, "--batch", table("run,measured,speed\nrun.mcap,a.csv,3\n")
    )
    assert 'drift = "maybe": expected true or false' in failed(
        capsys, "--batch", table("run,measured,drift\nrun.mcap,a.csv,maybe\n")
    )


def test_a_batch_as_json_with_reports_of_the_whole_overlap(
    archive: Path, measured: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "t.csv").write_text("run,measured\nrun.mcap,ap1.csv\n")
    assert run(["compare", "--batch", str(tmp_path / "t.csv"), "--json", "--report", str(tmp_path / "r")]) == 0
    found = json.loads(capsys.readouterr().out)
    assert found[0]["name"] == "ap1" and found[0]["comparison"]["lag_s"] == pytest.approx(0.0123, abs=1e-5)
    assert "(whole overlap)" in (tmp_path / "r" / "002_ap1" / "report.html").read_text()
