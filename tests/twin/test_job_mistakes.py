"""What is said about a job file with mistakes: each one, word by word, and all of them together."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st
from support.job_files import NOTHING, SOUND, job_data, job_folder

from twin.errors import JobError
from twin.job import job_from_dict, load_job

NO_CORNER = "expected no such key for a ball tool, only for bull or taper"
CYLINDER = {"centre": [0, 0], "diameter": 10, "min": 0, "max": 5}

MISTAKES: list[tuple[dict[str, Any], str]] = [
    (
        {"program__dialect": "heidenhain"},
        'program.dialect = "heidenhain": expected one of "fanuc", "haas", "linuxcnc", "grbl", "auto" '
        "(control that the program is written for; auto takes the likeliest)",
    ),
    ({"program__m_codes": {"72": "stop"}}, 'program.m_codes.72 = "stop": expected one of "none"'),
    ({"program__m_codes": {"M72": "none"}}, "program.m_codes.M72: unknown key; expected a whole number"),
    (
        {"program__m_codes": 72},
        "program.m_codes = 72: expected a table by number (M codes of the machine builder, by number: "
        '{ 72 = "none" } for one that moves nothing)',
    ),
    ({"program__file": 3}, "program.file = 3: expected a file name (NC program, relative to the job file's folder)"),
    (
        {"program__block_delete": 1},
        "program.block_delete = 1: expected true or false (block delete switch: true skips the blocks that begin "
        "with /)",
    ),
    ({"program__tool": 3}, "program.tool = 3: expected 0 or the number of a tool: 1, 7"),
    (
        {"machine__rapid_mm_min": "fast"},
        'machine.rapid_mm_min = "fast": expected a number above 0 '
        "(rapid traverse rate, of each axis (independent) or along the path (straight), mm/min)",
    ),
    (
        {"machine__rapid_mm_min": True},
        "machine.rapid_mm_min = true: expected a number above 0 "
        "(rapid traverse rate, of each axis (independent) or along the path (straight), mm/min)",
    ),
    (
        {"machine__rapid_mm_min": float("nan")},
        "machine.rapid_mm_min = nan: expected a number above 0 "
        "(rapid traverse rate, of each axis (independent) or along the path (straight), mm/min)",
    ),
    (
        {"machine__offsets__G60": [0, 0, 0]},
        "machine.offsets.G60: unknown key; expected G54 to G59, G59.1 to G59.3, or G54.1 P1 to P300",
    ),
    ({"machine__offsets__G55": [0, 0]}, "machine.offsets.G55 = [0, 0]: expected a list of three numbers"),
    ({"machine__offsets__G55": [0, "1", 0]}, 'machine.offsets.G55[1] = "1": expected a number'),
    ({"stock__wcs": "G55"}, 'stock.wcs = "G55": expected one of the offsets in machine.offsets: G54'),
    (
        {"measured": {"map": "w=Fx"}},
        "measured.map = \"w=Fx\": 'w=Fx' is not axis = column, expected e.g. x=-Fy,y=-Fx,z=Fz",
    ),
    (
        {"measured": {"windows": ["4:3"]}},
        'measured.windows[0] = "4:3": ends at 3 s, expected an end after its beginning, 4 s',
    ),
    (
        {"measured": {"offset": "soon"}},
        'measured.offset = "soon": expected air, none, BEGIN:END in seconds of the log, or X,Y,Z in N',
    ),
    (
        {"measured": {"columns": 3}},
        "measured.columns = 3: expected a list of texts (names of all columns in order, with units, e.g. "
        "t_s,Fx_N,Fy_N,Fz_N)",
    ),
    (
        {"measured": {"lag_s": "soon"}},
        'measured.lag_s = "soon": expected auto or seconds, e.g. 0.0123',
    ),
    ({"stock": {}}, "stock is empty: expected exactly one of box_mm, cylinder_mm, stl"),
    (
        {"stock__cylinder_mm": CYLINDER},
        "stock has box_mm and cylinder_mm: expected exactly one of box_mm, cylinder_mm, stl",
    ),
    ({"stock__offset_mm": [0, 0, 1]}, "stock.offset_mm = [0, 0, 1]: expected it only with stock.stl"),
    (
        {"stock__box_mm__max": [60, 30, -20]},
        "stock.box_mm.max[2] = -20: expected above stock.box_mm.min[2] = -20 (the box's extent along z)",
    ),
    (
        {"stock": {"cylinder_mm": {**CYLINDER, "max": -1}}},
        "stock.cylinder_mm.max = -1: expected above stock.cylinder_mm.min = 0",
    ),
    ({"tools": []}, "tools = []: expected at least one table [[tools]]"),
    ({"tools__1__number": 1}, "tools[1].number = 1: expected a unique number, tools[0] already has it"),
    (
        {"tools__0__diameter_mm": -8.0},
        "tools[0].diameter_mm (tool 1) = -8.0: expected a number above 0 (diameter of the cutting part; for a taper "
        "tool, diameter at the tip)",
    ),
    (
        {"tools__0__teeth": 2.0},
        "tools[0].teeth (tool 1) = 2.0: expected a whole number at least 1 and at most 100 (number of flutes)",
    ),
    (
        {"tools__0__helix_deg": 90},
        "tools[0].helix_deg (tool 1) = 90: expected a number above -90 and below 90 (helix angle, right-hand positive)",
    ),
    (
        {"tools__0__flute_length_mm": NOTHING},
        "tools[0].flute_length_mm (tool 1): missing; expected a number above 0 and at most 1000 (length of the "
        "cutting part, measured from the tip)",
    ),
    ({"tools__0__helix": 30}, "tools[0].helix (tool 1): unknown key; did you mean helix_deg?"),
    (
        {"tools__1__corner_radius_mm": NOTHING},
        "tools[1].corner_radius_mm (tool 7): missing; expected the corner radius of a bull tool",
    ),
    ({"tools__0__corner_radius_mm": 4.0}, f"tools[0].corner_radius_mm (tool 1) = 4.0: {NO_CORNER}"),
    (
        {"tools__1__taper_deg": 3},
        "tools[1].taper_deg (tool 7) = 3: expected no such key for a bull tool, only for taper",
    ),
    (
        {"tools__1__kind": "taper"},
        "tools[1].taper_deg (tool 7): missing; expected the half angle of a taper tool",
    ),
    (
        {"tools__1__corner_radius_mm": 8.5},
        "tools[1].corner_radius_mm (tool 7) = 8.5: expected at most 8, half the diameter",
    ),
    (
        {"tools__0__flute_length_mm": 3.9},
        "tools[0].flute_length_mm (tool 1) = 3.9: expected at least 4, the height of the rounded part",
    ),
    (
        {"tools__1__pitch_deg": [120, 120, 120]},
        "tools[1].pitch_deg (tool 7) = [120, 120, 120]: expected 2 angles, one a tooth (teeth = 2), got 3",
    ),
    (
        {"tools__1__pitch_deg": [170, 180]},
        "tools[1].pitch_deg (tool 7) = [170, 180]: expected angles above 0 that sum to 360, got 350",
    ),
    ({"tools__1__runout_mm": 8}, "tools[1].runout_mm (tool 7) = 8: expected below 8, half the diameter"),
    (
        {"tools__1__holder": 3},
        "tools[1].holder (tool 7) = 3: expected a list of tables (holder above the shank, from the bottom up: list of "
        "{ diameter_mm, length_mm })",
    ),
    (
        {"tools__1__holder__1__diameter_mm": 0},
        "tools[1].holder[1].diameter_mm (tool 7) = 0: expected a number above 0 (diameter, mm)",
    ),
    ({"cutting__Kae": NOTHING}, "cutting.Kae: missing; expected a number (axial, per edge length, N/mm)"),
    (
        {"cutting__source": "  "},
        'cutting.source = "  ": expected text that is not empty (source of the coefficients, e.g. a paper or a test)',
    ),
    (
        {"cutting__convention": "helical"},
        'cutting.convention = "helical": expected one of "meridian" (edge length that Kte, Kre and Kae refer to: '
        "along the tool's profile (meridian), not the helix)",
    ),
    ({"simulation__slice_pich_mm": 0.1}, "simulation.slice_pich_mm: unknown key; did you mean slice_pitch_mm?"),
    (
        {"simulation__slice_pitch_mm": 8.5},
        "simulation.slice_pitch_mm = 8.5: expected at most 8, the diameter of tool 1: it would pass between the slices",
    ),
    (
        {"simulation__slice_pitch_mm": 1e-5},
        "simulation.slice_pitch_mm = 1e-05: expected at least 0.0031, finer slices of this stock do not fit in memory",
    ),
    (
        {"simulation__angle_step_deg": 7},
        "simulation.angle_step_deg = 7: expected an angle that divides 360 evenly, e.g. 6",
    ),
    ({"output__mcap": "run.bag"}, 'output.mcap = "run.bag": expected a file name that ends in .mcap'),
    (
        {"output__force_on": "part"},
        'output.force_on = "part": expected one of "tool", "workpiece" (body on which the forces in summary and '
        "export act)",
    ),
    ({"cuttings": {}}, "cuttings: unknown key; did you mean cutting?"),
    ({"machine__tool_change_s": 1e300}, "machine.tool_change_s = 1e+300: expected at most 1e+09 in magnitude"),
    ({"machine__home_mm": [0, -1e12, 0]}, "machine.home_mm[1] = -1000000000000.0: expected at most 1e+09 in magnitude"),
    (
        {"simulation__axial_step_mm": 50.0},
        "simulation.axial_step_mm = 50.0: expected at most 10, half the flute length of tool 1",
    ),
    (
        {"stock": 3},
        "stock = 3: expected a table with keys box_mm, cylinder_mm, stl, unit, stl_scale, offset_mm, wcs (the material "
        "before the first cut)",
    ),
]


def problems(path: Path) -> list[str]:
    with pytest.raises(JobError) as caught:
        load_job(path)
    assert caught.value.file == str(path)
    return caught.value.problems


@pytest.mark.parametrize(("changes", "message"), MISTAKES, ids=[message.split(" ")[0] for _, message in MISTAKES])
def test_one_mistake_has_one_message(changes: dict[str, Any], message: str, tmp_path: Path) -> None:
    assert problems(job_folder(tmp_path, **changes)) == [message]


@pytest.mark.parametrize("value", [0.1, 0.25, 0.5, 1, 1.5, 2.5, 7.5, 360 / 7, 120, 360])
def test_angles_that_divide_a_turn_are_taken(value: float, tmp_path: Path) -> None:
    assert load_job(job_folder(tmp_path, simulation__angle_step_deg=value)).simulation.angle_step_deg == value


def test_a_tapered_ball_needs_less_flute_than_its_radius(tmp_path: Path) -> None:
    taper = {"kind": "taper", "taper_deg": 30, "corner_radius_mm": 4.0, "flute_length_mm": 2.0}
    assert load_job(job_folder(tmp_path, tools__0={**SOUND["tools"][0], **taper})).tool(1).taper_deg == 30.0


def test_files_that_are_not_there(tmp_path: Path) -> None:
    path = job_folder(tmp_path, program__file="nc", stock={"stl": "part.stl"})
    (tmp_path / "nc").mkdir()
    assert problems(path) == [
        f'program.file = "nc": expected an NC program; {tmp_path / "nc"} is a folder',
        f'stock.stl = "part.stl": expected an STL file; {tmp_path / "part.stl"} does not exist',
    ]


def test_every_mistake_is_said_at_once_also_beside_others_in_the_same_table(tmp_path: Path) -> None:
    path = job_folder(
        tmp_path,
        program__dialect="sinumerik",
        stock__box_mm__max=[60, 30, -20],
        tools__0__teeth="two",
        tools__0__corner_radius_mm=1,
        tools__1__pitch_deg=[1, 2],
        simulation__angle_step_deg=7,
        simulation__slice_pitch_mm=9,
        output__mcap="a.txt",
        output__rdd="b",
    )
    wrong = [p.split(" ")[0].rstrip(":") for p in problems(path)]
    assert sorted(wrong) == sorted(
        [
            "program.dialect",
            "stock.box_mm.max[2]",
            "tools[0].teeth",
            "tools[0].corner_radius_mm",
            "tools[1].pitch_deg",
            "simulation.angle_step_deg",
            "simulation.slice_pitch_mm",
            "output.mcap",
            "output.rdd",
        ]
    )


def test_the_message_has_a_line_for_each_mistake_with_the_file_in_front(tmp_path: Path) -> None:
    path = job_folder(tmp_path, tools__0__teeth=0, cuttings={})
    with pytest.raises(JobError) as caught:
        load_job(path)
    lines = str(caught.value).splitlines()
    assert len(lines) == 2
    assert all(line.startswith(f"{path}: ") for line in lines)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (
            "a = 1\n[program\n",
            "{path}:2:9: not valid TOML: expected ']' at the end of a table declaration; write [program]",
        ),
        ("[program]\nfile = ", "{path}:2:8: not valid TOML: invalid value"),
        ("a = 1\na = 2\n", "{path}:2:6: not valid TOML: cannot overwrite a value"),
    ],
)
def test_what_is_no_toml_is_refused_with_its_place(text: str, message: str, tmp_path: Path) -> None:
    path = tmp_path / "job.toml"
    path.write_text(text)
    with pytest.raises(JobError) as caught:
        load_job(path)
    assert str(caught.value) == message.format(path=path)


def test_a_file_that_cannot_be_read(tmp_path: Path) -> None:
    with pytest.raises(JobError) as caught:
        load_job(tmp_path / "no.toml")
    expected = f"{tmp_path / 'no.toml'}: cannot be read: no such file or directory; expected a job file (TOML)"
    assert str(caught.value) == expected


def test_a_file_that_is_no_text(tmp_path: Path) -> None:
    path = tmp_path / "job.toml"
    path.write_bytes(b"[program]\nfile = '\xff'\n")
    assert problems(path) == ["byte 0xff in line 2 is not UTF-8; expected a job file (TOML) in UTF-8"]


ANYTHING = st.recursive(
    st.none() | st.booleans() | st.integers() | st.floats() | st.text(max_size=3) | st.sampled_from(["ball", "G54"]),
    lambda inner: st.lists(inner, max_size=3) | st.dictionaries(st.sampled_from(["min", "max", "a"]), inner),
    max_leaves=5,
)
PATHS = [
    *(f"tools__0__{key}" for key in SOUND["tools"][0]),
    *(f"tools__1__{key}" for key in SOUND["tools"][1]),
    *(f"{table}__{key}" for table in ("program", "machine", "stock", "simulation", "output") for key in SOUND[table]),
    *SOUND,
    *("tools__0", "stock__box_mm__min", "machine__offsets__G54", "tools__1__holder__0", "stock__stl"),
]


@given(st.dictionaries(st.sampled_from(PATHS), ANYTHING, min_size=1, max_size=1))
def test_whatever_stands_at_a_key_the_answer_is_a_job_or_a_job_error(changes: dict[str, Any]) -> None:
    try:
        job_from_dict(job_data(**changes), Path(__file__).parent)
    except JobError as error:
        assert error.problems
