"""What a sound job file gives: values, defaults, paths, text, schema."""

from __future__ import annotations

import json
import tomllib
from pathlib import Path
from typing import Any

import jsonschema
import pytest
from hypothesis import given
from hypothesis import strategies as st
from pydantic import ValidationError
from support.job_files import NOTHING, SOUND, job_data, job_folder

from twin.errors import JobError
from twin.job import job_from_dict, job_schema, load_job
from twin.settings.toml_text import toml_text

JOBS = sorted((Path(__file__).parents[2] / "examples").glob("*/job.toml"))
EXAMPLES = [path for path in JOBS if "program" in tomllib.loads(path.read_text())]  # others are jobs of `twin mold`


def test_values_arrive_typed_and_whole_numbers_serve_as_lengths(tmp_path: Path) -> None:
    job = load_job(job_folder(tmp_path))
    assert job.machine.rapid_mm_min == 48000.0 and isinstance(job.machine.rapid_mm_min, float)
    assert job.stock.box_mm is not None
    assert job.stock.box_mm.max == (60.0, 30.0, 0.0)
    assert [t.number for t in job.tools] == [1, 7]
    assert job.tool(7).pitch_deg == (170.0, 190.0)
    assert [h.diameter_mm for h in job.tool(7).holder] == [40.0, 63.0]
    assert job.cutting is not None and job.cutting.Krc == 400.0


def test_what_is_not_given_has_the_documented_default(tmp_path: Path) -> None:
    changes = dict.fromkeys(("machine", "simulation", "output", "cutting", "program__dialect"), NOTHING)
    job = load_job(job_folder(tmp_path, **changes))
    assert (job.program.dialect, job.program.arc_centres, job.program.units) == ("fanuc", "incremental", "mm")
    assert (job.program.block_delete, job.program.tool) == (False, 0)
    assert job.machine.model_dump() == {
        "rapid": None,
        "rapid_mm_min": 48000.0,
        "axis_rapid_mm_min": None,
        "max_feed_mm_min": None,
        "max_spindle_rpm": None,
        "tool_change_s": 0.0,
        "home_mm": None,
        "start_mm": None,
        "offsets": {"G54": (0.0, 0.0, 0.0)},
    }
    assert job.simulation.model_dump() == {
        "slice_pitch_mm": 0.1,
        "step_mm": 0.1,
        "angle_step_deg": 1.0,
        "axial_step_mm": 0.1,
        "engagement": "majority",
        "store": "fast",
        "preview_pitch_mm": None,
    }
    assert job.output.model_dump() == {"mcap": None, "rrd": None, "force_on": "tool", "samples": "all"}
    assert (job.stock.wcs, job.stock.stl_scale, job.stock.offset_mm) == ("G54", 1.0, (0.0, 0.0, 0.0))
    assert not job.forces


def test_files_are_relative_to_the_folder_of_the_job(tmp_path: Path) -> None:
    (tmp_path / "part.stl").write_text("solid\nendsolid\n")
    path = job_folder(tmp_path, stock={"stl": "part.stl"}, output={"mcap": "/elsewhere/a.mcap", "rrd": "a.rrd"})
    job = load_job(path)
    assert job.path == path
    assert job.program.file == tmp_path / "slot.nc"
    assert job.stock.stl == tmp_path / "part.stl"
    assert job.output.mcap == Path("/elsewhere/a.mcap")
    assert job.output.rrd == tmp_path / "a.rrd"


def test_text_is_the_file_as_written(tmp_path: Path) -> None:
    path = job_folder(tmp_path)
    path.write_text("# by hand\n" + path.read_text())
    assert load_job(path).text == path.read_text()


def test_a_byte_order_mark_is_no_mistake(tmp_path: Path) -> None:
    path = job_folder(tmp_path)
    path.write_bytes(b"\xef\xbb\xbf" + path.read_bytes())
    assert load_job(path).program.dialect == "fanuc"


def test_a_job_from_tables_has_text_that_says_the_same(tmp_path: Path) -> None:
    job_folder(tmp_path)
    job = job_from_dict(SOUND, tmp_path)
    assert job.path == tmp_path / "job.toml"
    assert tomllib.loads(job.text) == SOUND


def test_a_tool_takes_its_own_coefficients_before_those_for_all(tmp_path: Path) -> None:
    own = {**SOUND["cutting"], "Ktc": 1900.0}
    job = load_job(job_folder(tmp_path, tools__1__cutting=own))
    first, second = (job.coefficients(t) for t in job.tools)
    assert first is not None and first.Ktc == 900.0
    assert second is not None and second.Ktc == 1900.0


def test_forces_can_be_left_out(tmp_path: Path) -> None:
    own = {**SOUND["cutting"], "Ktc": 1900.0}
    job = load_job(job_folder(tmp_path, tools__1__cutting=own))
    assert job.forces
    without = job.without_forces()
    assert not without.forces
    assert without.text == job.text and without.stock == job.stock


def test_the_measured_log_is_relative_to_the_job(tmp_path: Path) -> None:
    table = {"file": "ap1.csv", "map": "x=-Fy,y=-Fx,z=Fz", "columns": ["t_s", "Fx", "Fy", "Fz"], "windows": ["4:4.02"]}
    job = load_job(job_folder(tmp_path, measured=table))
    assert job.measured is not None
    assert job.measured.file == tmp_path / "ap1.csv"
    assert job.measured.windows == ("4:4.02",) and job.measured.lag_s is None


def test_a_job_is_frozen(tmp_path: Path) -> None:
    job = load_job(job_folder(tmp_path))
    with pytest.raises(ValidationError):
        job.simulation.step_mm = 2.0  # type: ignore[misc]


def test_asking_for_a_tool_that_is_not_there(tmp_path: Path) -> None:
    job = load_job(job_folder(tmp_path))
    with pytest.raises(JobError) as caught:
        job.tool(3)
    assert str(caught.value) == f"{job.path}: tools: no tool has the number 3; expected one of 1, 7"


@pytest.mark.parametrize("path", EXAMPLES, ids=lambda p: p.parent.name)
def test_examples_load_and_fit_the_schema(path: Path) -> None:
    assert load_job(path).forces
    jsonschema.validate(tomllib.loads(path.read_text()), job_schema())


def test_schema_is_sound_and_takes_the_sound_job() -> None:
    schema = job_schema()
    jsonschema.Draft202012Validator.check_schema(schema)
    jsonschema.validate(SOUND, schema)
    assert json.loads(json.dumps(schema)) == schema
    assert "null" not in json.dumps(schema)


@pytest.mark.parametrize(
    "changes",
    [
        {"tools__0__teeth": "two"},
        {"tools__0__feed": 3},
        {"stock__stl": "part.stl"},
        {"stock__box_mm": NOTHING},
        {"tools": []},
        {"simulation__slice_pitch_mm": 0},
        {"program__dialect": "heidenhain"},
        {"cutting__source": ""},
    ],
    ids=str,
)
def test_schema_refuses_what_the_program_refuses(changes: dict[str, Any], tmp_path: Path) -> None:
    data = job_data(**changes)
    with pytest.raises(jsonschema.ValidationError):
        jsonschema.validate(data, job_schema())
    with pytest.raises(JobError):
        load_job(job_folder(tmp_path, **changes))


NAMES = st.text(st.characters(exclude_categories=["Cs"]), max_size=8)
SCALARS = st.booleans() | st.integers(-(2**60), 2**60) | st.floats(allow_nan=False) | NAMES
VALUES = st.recursive(
    SCALARS, lambda inner: st.lists(inner, max_size=3) | st.dictionaries(NAMES, inner, max_size=3), max_leaves=8
)


@given(st.dictionaries(NAMES, VALUES, max_size=4))
def test_written_toml_reads_the_same(data: dict[str, Any]) -> None:
    assert tomllib.loads(toml_text(data)) == data


def keys_of(schema: dict[str, Any]) -> set[str]:
    return {key for table in (schema, *schema["$defs"].values()) for key in table["properties"]}


def test_every_key_is_in_the_documentation() -> None:
    text = (Path(__file__).parents[2] / "docs" / "job-file.md").read_text()
    assert {key for key in keys_of(job_schema()) if key not in text} == set()


def test_the_job_in_the_documentation_is_sound(tmp_path: Path) -> None:
    text = (Path(__file__).parents[2] / "docs" / "job-file.md").read_text()
    job_folder(tmp_path).write_text(text.split("```toml\n")[1].split("```")[0])
    assert load_job(tmp_path / "job.toml").forces


def test_a_job_with_another_simulation_is_checked(tmp_path: Path) -> None:
    job = load_job(job_folder(tmp_path))
    coarse = job.with_simulation(slice_pitch_mm=2.0, store="reference")
    assert (coarse.simulation.slice_pitch_mm, coarse.simulation.store) == (2.0, "reference")
    assert coarse.simulation.angle_step_deg == job.simulation.angle_step_deg
    assert coarse.tools == job.tools and job.simulation.slice_pitch_mm == 0.5
    with pytest.raises(JobError, match="slice_pitch_mm = 0"):
        job.with_simulation(slice_pitch_mm=0)
    with pytest.raises(JobError, match="slice_pich_mm: unknown key"):
        job.with_simulation(slice_pich_mm=1.0)


def test_a_job_with_another_program_table(tmp_path: Path) -> None:
    job = load_job(job_folder(tmp_path, program__m_codes={"117": "none"}))
    assert job.program.m_codes == {117: "none"}
    changed = job.with_program(tool=7, dialect="auto", m_codes={72: "none"})
    assert (changed.program.tool, changed.program.dialect, changed.program.m_codes) == (7, "auto", {72: "none"})
    with pytest.raises(JobError, match="no tool has the number 9; expected one of 1, 7"):
        job.with_program(tool=9)
