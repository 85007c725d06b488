"""Mistakes of people who write their first job: the line, and what to write; files given to the wrong command."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.support.job_files import job_folder
from twin.errors import JobError
from twin.identification.cuts.load import load_cuts
from twin.job import load_job
from twin.moldmaking.load import load_mold
from twin.settings.toml_hints import hint


@pytest.mark.parametrize(
    ("line", "written"),
    [
        ("diameter_mm = 8,0", "write diameter_mm = 8.0, with a decimal point"),
        ("shank = { diameter_mm = 8,5, length_mm = 20 }", "write diameter_mm = 8.5, with a decimal point"),
        (
            "rapid_mm_min = 48,000",
            "write rapid_mm_min = 48000 or rapid_mm_min = 48.000, with a decimal point",
        ),
        ("rapid_mm_min = 1,048,000", "write rapid_mm_min = 1048000, without marks between thousands"),
        ("G54 = 0, -12.5, 0  # corner", "write G54 = [0, -12.5, 0], a list in brackets"),
        ("rapid_mm_min = 48.000,5", "write rapid_mm_min = 48000.5, without marks between thousands"),
        ("rapid_mm_min = 48'000", "write rapid_mm_min = 48000, without marks between thousands"),
        ("diameter_mm = 10.", "write diameter_mm = 10.0, with a digit on both sides of the point"),
        ("step_mm = -.5  # fine", "write step_mm = -0.5, with a digit on both sides of the point"),
        ("number = 01", "write number = 1, without 0 in front"),
        ("teeth = 2;", "write teeth = 2, with nothing after it"),
        ('kind = "ball",', 'write kind = "ball", with nothing after it'),
        ("diameter_mm = 8.0 mm", "write diameter_mm = 8.0, without a unit"),
        ("kind = ball", 'write kind = "ball", in quotes'),
        ("kind = ball  # a comment", 'write kind = "ball", in quotes'),
        ("file = ./slot.nc", 'write file = "./slot.nc", in quotes'),
        (r"file = C:\nc\slot.nc", r"write file = 'C:\nc\slot.nc', in quotes"),
        (
            r'file = "C:\Users\me\slot.nc"',
            r"a backslash begins an escape; write file = 'C:\Users\me\slot.nc' in single quotes, or / for each " + "\\",
        ),
        ("block_delete = True", "write block_delete = true"),
        ("kind = “ball”", 'write kind = "ball", with straight quotes'),
        ("teeth: 2", "write = after teeth, not :"),
        ("// my job", "a comment begins with #"),
        ("[stock", "write [stock]"),
        ("teeth = = 2", None),
    ],
)
def test_a_line_that_is_not_toml_comes_with_what_to_write(tmp_path: Path, line: str, written: str | None) -> None:
    assert hint(line) == written
    path = tmp_path / "job.toml"
    path.write_text(f"# a job\n{line}\n", encoding="utf-8")
    with pytest.raises(JobError, match=r"job.toml:[23]:\d+: not valid TOML: ") as caught:
        load_job(path)
    assert written is None or str(caught.value).endswith(written)


def test_a_windows_path_whose_backslashes_are_escapes(tmp_path: Path) -> None:
    with pytest.raises(JobError, match="a backslash begins an escape: write the path in single quotes"):
        load_job(job_folder(tmp_path, program__file="C:\temp\new.nc"))
    with pytest.raises(JobError, match=r'output.mcap = "C:.temp.run.mcap": expected a path; a backslash begins'):
        load_job(job_folder(tmp_path, output__mcap="C:\temp\run.mcap"))


def test_the_folder_of_a_job_may_have_any_name(tmp_path: Path) -> None:
    (tmp_path / "a\nb").mkdir()
    assert load_job(job_folder(tmp_path / "a\nb", output__mcap="a.mcap")).output.mcap == tmp_path / "a\nb/a.mcap"


@pytest.mark.parametrize(
    ("encoding", "message"),
    [
        ("utf-16", "job.toml: the text is in UTF-16; expected a job file (TOML) in UTF-8"),
        ("utf-32", "job.toml: the text is in UTF-32; expected a job file (TOML) in UTF-8"),
        ("latin-1", "job.toml: byte 0xe4 in line 2 is not UTF-8; expected a job file (TOML) in UTF-8"),
    ],
)
def test_a_job_in_another_encoding_names_it(tmp_path: Path, encoding: str, message: str) -> None:
    (tmp_path / "job.toml").write_bytes("[program]\n# Fräsen\n".encode(encoding))
    with pytest.raises(JobError) as caught:
        load_job(tmp_path / "job.toml")
    assert str(caught.value).endswith(message)


@pytest.mark.parametrize(
    ("name", "text", "kind"),
    [
        ("slot.nc", "G21\n", "an NC program; make its job file with twin job"),
        ("slot.txt", "%\nO1\nG21\n", "an NC program; "),
        ("run.mcap", "\x89MCAP0", "the recording of a run; see: twin info"),
        ("part.stl", "solid\n", "an STL file; "),
        ("mold.toml", '[part]\nstl = "a.stl"\n', "a mold job; run: twin mold"),
        ("cuts.toml", "[[cuts]]\n", "a file of test cuts; run: twin identify"),
    ],
)
def test_a_file_of_another_kind_is_named_with_its_command(tmp_path: Path, name: str, text: str, kind: str) -> None:
    path = tmp_path / name
    path.write_text(text)
    with pytest.raises(JobError) as caught:
        load_job(path)
    assert str(caught.value).startswith(f"{path}: is not a job file but {kind}")
    assert str(path) in caught.value.problems[0]


def test_a_replay_job_given_to_other_commands(tmp_path: Path) -> None:
    job = job_folder(tmp_path)
    for load, what in ((load_mold, "a mold job"), (load_cuts, "a file of test cuts")):
        with pytest.raises(JobError, match=f"is not {what} but a replay job; run: twin replay"):
            load(job)


def test_the_source_of_coefficients_is_wanted_and_not_required(tmp_path: Path) -> None:
    cutting = dict.fromkeys(("Ktc", "Kte", "Krc", "Kre", "Kac", "Kae"), 1.0)
    job = load_job(job_folder(tmp_path, cutting=cutting))
    assert job.cutting is not None and job.cutting.source is None
