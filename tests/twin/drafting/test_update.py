"""A drafted job into a file that exists: its lines stay, and it gets what it lacks."""

from __future__ import annotations

import tomllib
from pathlib import Path
from typing import Any

import pytest
from support.nc_programs import SLOT, changed, written

from twin.drafting.draft import draft_job
from twin.drafting.update import Written, write_draft
from twin.errors import JobError, TwinError
from twin.job import load_job


def write(folder: Path, text: str = SLOT, *, force: bool = False, **values: Any) -> Written:
    return write_draft(draft_job(written(folder, text), path=folder / "job.toml", **values), force=force)


def test_a_new_file_is_the_draft_and_a_second_draft_changes_nothing(tmp_path: Path) -> None:
    first = write(tmp_path)
    text = first.path.read_text()
    assert first.new and load_job(first.path).text == text
    second = write(tmp_path)
    assert (second.new, second.added, second.kept) == (False, (), ())
    assert first.path.read_text() == text


def test_changes_by_hand_stay_and_are_reported(tmp_path: Path) -> None:
    path = write(tmp_path).path
    own = path.read_text().replace("teeth = 4  # assumed: the program does not state it", "teeth = 3 # measured")
    path.write_text(own)
    again = write(tmp_path)
    assert path.read_text() == own
    assert again.kept == ("T3: teeth = 3 (drafted: 4)",)


def test_a_material_that_the_tools_of_the_file_lack(tmp_path: Path) -> None:
    """With a tool that has no forces, each cutting tool has its own coefficients; a file of before has none."""
    text = changed(("M30\n", "T4 M6 (D6 DRILL)\nS900 M3\nG0 X0 Y0 Z2.\nG1 Z-1. F90.\nM30\n"))
    write(tmp_path, text)
    again = write(tmp_path, text, material="Al7075-T6")
    assert again.kept == ('T3 without cutting (drafted: { material = "Al7075-T6" })',)


def test_tools_and_tables_that_the_file_lacks_are_added(tmp_path: Path) -> None:
    path = write(tmp_path).path
    own = path.read_text()
    more = "T4 M6 (D6 BALL NOSE)\nS900 M3\nG0 X0 Y0 Z2.\nG1 Z-1. F90.\nX9.\nM30\n"
    again = write(tmp_path, changed(("M30\n", more)), material="Al7075-T6")
    assert again.added == ("T4", "[cutting]")
    assert path.read_text().startswith(own.rstrip())
    job = load_job(path)
    assert [tool.number for tool in job.tools] == [3, 4]
    assert job.forces


def test_force_replaces_the_file(tmp_path: Path) -> None:
    path = write(tmp_path).path
    path.write_text(path.read_text().replace("teeth = 4", "teeth = 7"))
    assert write(tmp_path, force=True).new
    assert tomllib.loads(path.read_text())["tools"][0]["teeth"] == 4


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ('[program]\nfile = "other.nc"\n', "is the job of other.nc; expected one of part.nc"),
        ("G21\nG0 X1\n", "an NC program"),
        ("[program]\nfile = 'part.nc'\n[tools]\nx = 1\n", "replace the file with --force"),
    ],
)
def test_other_files_are_not_touched(tmp_path: Path, text: str, message: str) -> None:
    (tmp_path / "job.toml").write_text(text)
    with pytest.raises(JobError, match=message):
        write(tmp_path)
    assert (tmp_path / "job.toml").read_text() == text


def test_a_file_that_cannot_be_written(tmp_path: Path) -> None:
    (tmp_path / "file").touch()
    draft = draft_job(written(tmp_path, SLOT), path=tmp_path / "file" / "job.toml")
    with pytest.raises(TwinError, match=r"job\.toml: cannot be written"):
        write_draft(draft)
