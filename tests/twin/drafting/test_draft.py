"""A job from an NC program: what it holds, what it names as assumed, and what it refuses."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest
from support.nc_programs import SLOT, changed, written

import twin
from gcode.errors import GcodeError
from twin.drafting.draft import JobDraft, draft_job
from twin.errors import MaterialError, ReplayError, SettingsError, ToolLibraryError
from twin.job import job_from_text
from twin.simulation.replay import Replay


def drafted(folder: Path, text: str = SLOT, **values: Any) -> JobDraft:
    return draft_job(written(folder, text), path=folder / "job.toml", **values)


def tool_of(draft: JobDraft, index: int = 0) -> dict[str, Any]:
    return [table for table in draft.tables if table.listed][index].values()


def test_the_draft_is_a_job_that_its_text_is(tmp_path: Path) -> None:
    draft = drafted(tmp_path, material="Al7075-T6")
    job = draft.job()
    (tool,) = job.tools
    assert (tool.number, tool.kind, tool.diameter_mm, tool.teeth) == (3, "flat", 8.0, 4)
    assert job.program.file == tmp_path / "part.nc"
    assert job.forces and job.cutting is not None and job.cutting.material == "Al7075-T6"
    assert job.stock.box_mm is not None and job.stock.box_mm.max == (44.0, 4.0, 0.0)
    assert job.text == draft.toml_text()
    assert job_from_text(draft.toml_text(), job.path) == job
    assert not draft.warnings and not draft.open


def test_every_assumed_value_has_a_comment_and_an_entry(tmp_path: Path) -> None:
    draft = drafted(tmp_path)
    text = draft.toml_text()
    assert "teeth = 4  # assumed: the program does not state it" in text
    assert "4 flutes, helix 30 deg, flute length 20 mm (T3: the program does not state them)" in draft.assumed
    subjects = [a.subject for a in draft.assumptions]
    assert {"program", "machine", "stock", "T3", "simulation"} == set(subjects)
    assert text.count("# assumed") == 8
    assert "# [cutting]\n# material = ..." in text
    assert len(draft.open) == 1 and "give --material NAME" in draft.open[0]
    assert not draft.job().forces


def test_values_given_are_not_assumed(tmp_path: Path) -> None:
    draft = drafted(
        tmp_path, dialect="haas", stock="box 80 40 20 at 20 0 0", pitch_mm=0.5, angle_step_deg=10, m_codes=(77,)
    )
    job = draft.job()
    assert (job.program.dialect, job.simulation.slice_pitch_mm, job.simulation.angle_step_deg) == ("haas", 0.5, 10.0)
    assert job.program.m_codes == {77: "none"}
    assert {a.subject for a in draft.assumptions} == {"machine", "T3"}


def test_a_tool_without_a_size_is_marked_and_has_no_forces(tmp_path: Path) -> None:
    text = changed(("(T3 D=8. CR=0. - ZMIN=-2. - flat end mill)\n", ""))
    draft = drafted(tmp_path, text, material="Al7075-T6")
    assert "diameter_mm = 6.0  # CHECK: the program does not state it" in draft.toml_text()
    assert draft.open[0].startswith("T3: the program does not state its diameter; drawn with D6 mm, and no forces")
    assert not draft.job().forces
    assert tool_of(drafted(tmp_path, text.replace("G21", "G20")))["diameter_mm"] == 6.35


@pytest.mark.parametrize(
    ("comment", "values"),
    [
        ("T3 D=8. CR=4. - ball end mill", {"kind": "ball", "diameter_mm": 8.0, "teeth": 2, "helix_deg": 30.0}),
        ("T3 D=8. CR=2. - bull nose end mill", {"kind": "bull", "corner_radius_mm": 2.0}),
        ("T3 D=8. CR=0. TAPER=45deg - chamfer mill", {"kind": "taper", "diameter_mm": 0.3, "taper_deg": 45.0}),
        ("T3 D=6. CR=0. TAPER=3deg - tapered mill", {"kind": "taper", "diameter_mm": 6.0, "taper_deg": 3.0}),
        ("T3 50. FACE MILL", {"kind": "flat", "diameter_mm": 50.0, "teeth": 5, "flute_length_mm": 10.0}),
        ("T3 D=4. CR=0. - flat end mill", {"teeth": 2, "flute_length_mm": 10.0}),
        ("T3 BULL NOSE 10 MM", {"kind": "bull", "corner_radius_mm": 1.0}),
    ],
)
def test_tools_of_each_kind(tmp_path: Path, comment: str, values: dict[str, Any]) -> None:
    draft = drafted(tmp_path, changed(("T3 D=8. CR=0. - ZMIN=-2. - flat end mill", comment)), material="Al7075-T6")
    assert {key: tool_of(draft).get(key) for key in values} == values
    assert draft.job().forces


def test_drills_are_drawn_and_have_no_forces(tmp_path: Path) -> None:
    more = "T5 M6 (6.8 MM DRILL)\nS900 M3\nG0 X5. Y0. Z2.\nG83 X5. Z-9. R2. Q3. F90.\nG80\nM30\n"
    draft = drafted(tmp_path, changed(("M30\n", more)), material="Al7075-T6")
    job = draft.job()
    assert [job.coefficients(tool) is not None for tool in job.tools] == [True, False]
    assert "a cylinder of D6.8 mm without forces (T5: a drill is not simulated)" in draft.assumed
    assert tool_of(draft, 0)["cutting"] == {"material": "Al7075-T6"}


def test_the_flutes_reach_as_deep_as_the_program(tmp_path: Path) -> None:
    draft = drafted(tmp_path, changed(("Z-2. F200.", "Z-35. F200."), ("ZMIN=-2.", "ZMIN=-35.")))
    assert tool_of(draft)["flute_length_mm"] == 36.0
    assert "flute length 36 mm (T3: the program goes 35 mm deep, 4.4 diameters)" in draft.assumed


def test_a_program_without_a_tool_change(tmp_path: Path) -> None:
    text = changed(("T3 M6\n", ""), ("G43 Z20. H3", "Z20."), ("(T3 D=8", "(M6 T4)\n(T4 D=8"))
    draft = drafted(tmp_path, text)
    assert draft.job().program.tool == 4
    assert "T4 in the spindle at the start (program: it cuts before its first tool change)" in draft.assumed
    assert drafted(tmp_path, text, tool=9).job().program.tool == 9


def test_work_offsets_that_are_used(tmp_path: Path) -> None:
    draft = drafted(tmp_path, changed(("G54\n", "G55\n")))
    assert (draft.job().machine.offsets, draft.job().stock.wcs) == ({"G55": (0.0, 0.0, 0.0)}, "G55")
    draft = drafted(tmp_path, changed(("X40. F640.", "X40. F640.\nG56 X0.")))
    assert "2 work offsets (G54, G56)" in draft.warnings[0]
    draft.job()


def test_the_machine_zero_of_g53_is_above_the_stock(tmp_path: Path) -> None:
    draft = drafted(tmp_path, changed(("G28 G91 Z0.\nG90\n", "G53 G0 Z-5.\n")))
    assert draft.job().machine.offsets == {"G54": (0.0, 0.0, -100.0)}
    assert "G54 at Z-100 (machine: the program does not state" in "\n".join(draft.assumed)
    with Replay(draft.job(), preview=False) as replay:
        assert not [record for record in replay if isinstance(record, twin.Collision)]


def test_offsets_with_other_numbers_than_the_tool_have_rows(tmp_path: Path) -> None:
    draft = drafted(tmp_path, changed(("H3", "H13"), ("X40. F640.", "G41 D23 X9. F640.\nX40.\nG40 X50.")))
    assert [tool.number for tool in draft.job().tools] == [3, 13, 23]
    assert "# row 23 of the offset table, which T3 uses (H23, D23)" in draft.toml_text()
    assert "radius 4 mm in D23 (T3: cutter compensation; a post may expect the wear only)" in draft.assumed
    assert draft.job().stock.box_mm.max[1] == pytest.approx(8.0)  # type: ignore[union-attr]


def test_a_program_posted_for_wear_has_no_radius_in_its_offset(tmp_path: Path) -> None:
    """The path of the centre has inside corners sharper than the tool."""
    corner = "G41 D3 X9. F640.\nX40.\nG3 X41. Y1. J1.\nG1 Y30.\nG40 X30.\n"
    draft = drafted(tmp_path, changed(("X40. F640.", corner)))
    assert draft.job().tools[0].offset_radius_mm == 0.0
    assert "cutter compensation with the tools' radii is refused" in draft.warnings[0]
    with Replay(draft.job(), preview=False) as replay:
        assert replay.planned_time_s > 0.0


def test_a_comment_that_states_wear(tmp_path: Path) -> None:
    text = changed(
        ("T3 D=8. CR=0. - ZMIN=-2. - flat end mill", "T3 | 8. FLAT ENDMILL | H3 | D3 | WEAR COMP | TOOL DIA. - 8."),
        ("X40. F640.", "G41 D3 X9. F640.\nX40.\nG40 X50."),
    )
    draft = drafted(tmp_path, text)
    assert draft.job().tools[0].offset_radius_mm == 0.0
    assert not [line for line in draft.assumed if "radius 4 mm" in line] and not draft.warnings


def test_tools_and_stock_of_comments_are_stated(tmp_path: Path) -> None:
    draft = drafted(tmp_path, changed(("(SLOT)", "(STOCK 80 X 30 X 10)")))
    assert draft.stated == ("T3 flat D8 (line 3)", "stock 80 x 30 x 10 mm (line 2)")


@pytest.mark.parametrize(("cycle", "kind"), [("G81 X9. Z-3. R2. F100.", "drill"), ("G84 X9. Z-3. R2. F99.", "tap")])
def test_a_tool_that_only_drills_is_not_an_end_mill(tmp_path: Path, cycle: str, kind: str) -> None:
    cut = "G1 Z-2. F200.\nX40. F640."
    text = changed(("T3 D=8. CR=0. - ZMIN=-2. - flat end mill", "T3 : 8."), (cut, f"{cycle}\nG80"))
    draft = drafted(tmp_path, text, material="Al7075-T6")
    assert any(line.startswith(f"a {kind} (T3: it only") for line in draft.assumed)
    assert not draft.job().forces


def test_codes_of_units_of_other_controls(tmp_path: Path) -> None:
    draft = drafted(tmp_path, changed(("G21 G17", "G70 G17"), ("D=8.", "D=.25"), ("(SLOT)", "(FOR MACH3)")))
    job = draft.job()
    assert (job.program.g70_units, job.tools[0].diameter_mm) == (True, 6.35)
    assert "G70 and G71 set inches and millimetres (program: line 4 has no words" in draft.assumed[0]
    with Replay(job, preview=False) as replay:
        assert replay.planned_time_s > 0.0
    with pytest.raises(GcodeError, match="G70"):
        drafted(tmp_path, changed(("X40. F640.", "G70 I5. J0. L6.")), dialect="haas")


def test_additional_work_offsets(tmp_path: Path) -> None:
    job = drafted(tmp_path, changed(("G54\n", "G54.1 P3\n"))).job()
    assert (job.machine.offsets, job.stock.wcs) == ({"G54.1 P3": (0.0, 0.0, 0.0)}, "G54.1 P3")
    with Replay(job, preview=False) as replay:
        assert replay.planned_time_s > 0.0


def test_offsets_that_the_program_sets_need_no_warning(tmp_path: Path) -> None:
    pairs = ("X40. F640.", "X40. F640.\nG56 X0."), ("G54\n", "G10 L2 P3 X9.\nG54\n")
    assert not drafted(tmp_path, changed(*pairs)).warnings


def test_a_contour_along_the_sides_of_an_assumed_box(tmp_path: Path) -> None:
    """Its outside is cut as a full slot, which a real blank is too small for."""
    contour = changed(("X40. F640.", "X80. F640.\nY60.\nX0.\nY0."))
    assert drafted(tmp_path, contour).warnings[0].startswith("T3 runs along the sides of the assumed stock only")
    assert not drafted(tmp_path, contour, stock="box 80 60 9").warnings


def test_arcs_with_absolute_centres_are_recognised(tmp_path: Path) -> None:
    arc = "X40. F640.\nG3 X40. Y20. I40. J10.\nG3 X30. Y10. I35. J15."
    draft = drafted(tmp_path, changed(("X40. F640.", arc)))
    assert draft.job().program.arc_centres == "absolute"
    assert any("arc centres I, J, K are coordinates" in line for line in draft.assumed)


def test_a_program_that_the_likeliest_dialect_refuses(tmp_path: Path) -> None:
    draft = drafted(tmp_path, "G21\nG64 P0.01\nT1 M6 (D6 END MILL)\nS900 M3\nG0 X0 Y0 Z1\nG1 Z-1 F90\nX9\nM2\n")
    assert draft.job().program.dialect == "linuxcnc"
    assert any(line.startswith("dialect linuxcnc (program: fanuc refuses line 2") for line in draft.assumed)


@pytest.mark.parametrize(
    ("values", "error", "message"),
    [
        ({"material": "Al7075-T7"}, MaterialError, "did you mean .*Al7075-T6"),
        ({"pitch_mm": 0.0}, SettingsError, "pitch_mm = 0.0: expected a number above 0"),
        ({"colour": "red"}, SettingsError, "colour"),
    ],
)
def test_wrong_values_are_refused(tmp_path: Path, values: dict[str, Any], error: type[Exception], message: str) -> None:
    with pytest.raises(error, match=message):
        drafted(tmp_path, **values)


def test_a_flute_length_below_the_corner_radius_is_not_used(tmp_path: Path) -> None:
    draft = drafted(tmp_path, changed(("T3 D=8. CR=0. - ZMIN=-2. - flat end mill", "T3 BALL 8 MM LOC 1")))
    assert tool_of(draft)["flute_length_mm"] == 20.0
    assert draft.warnings == (
        "T3: its comment states a flute length of 1 mm, less than its corner radius; it is not used",
    )


def test_programs_that_cannot_be_drafted_are_refused(tmp_path: Path) -> None:
    with pytest.raises(ReplayError, match=r"part\.nc:15: feed motion with T0"):
        drafted(tmp_path, changed(("X40. F640.", "T0 M6\nX40. F640."), ("T3 M6\nG54", "T3 M6\nG54")))
    with pytest.raises(ReplayError, match="has no feed motion"):
        drafted(tmp_path, "G21\nG0 X1.\nM30\n")
    with pytest.raises(GcodeError, match="G999"):
        drafted(tmp_path, "G21\nG999\nM30\n")


def library(folder: Path, *rows: str) -> Path:
    path = folder / "tools.csv"
    path.write_text("\n".join(["number,name,kind,diameter_mm,teeth,flute_length_mm", *rows]))
    return path


def test_tools_of_a_library_win_over_comments(tmp_path: Path) -> None:
    file = library(tmp_path, "3,cutter A,flat,8,3,19", "4,cutter B,ball,6,2,9")
    draft = drafted(tmp_path, tools=file)
    tool = tool_of(draft)
    assert (tool["name"], tool["teeth"], tool["flute_length_mm"]) == ("cutter A", 3, 19.0)
    assert "helix 30 deg (T3: the library does not state it)" in draft.assumed
    assert tool["origin"] == 'tools.csv:2, T3 "cutter A"'
    assert not draft.warnings
    other = drafted(tmp_path, tools=library(tmp_path, "3,cutter A,flat,10,3,19"))
    assert "the library has D10 mm" in other.warnings[0] and "comment D8 mm" in other.warnings[0]


def test_a_number_that_is_in_no_library(tmp_path: Path) -> None:
    draft = drafted(tmp_path, tools=library(tmp_path, "1,x,flat,8,3,19"))
    assert "no tool has the number 3; expected one of 1" in draft.warnings[0]
    assert draft.warnings[0].endswith("the program's comment is used")
    assert tool_of(draft)["diameter_mm"] == 8.0


def test_two_tools_of_one_number(tmp_path: Path) -> None:
    draft = drafted(tmp_path, tools=library(tmp_path, "3,x,flat,8,3,19", "3,y,flat,6,3,19"))
    assert tool_of(draft)["name"] == "x"
    with pytest.raises(ToolLibraryError, match='2 tools have the number 3: "x", "y"'):
        drafted(tmp_path, tools=library(tmp_path, "3,x,flat,7,3,19", "3,y,flat,6,3,19"))


@pytest.mark.parametrize(
    ("pairs", "warning"),
    [
        ([("ZMIN=-2.", "ZMIN=-50.8")], "T3: its comment states a lowest Z of -50.8 mm, the program goes to -2 mm"),
        ([("T3 D=8. CR=0. - ZMIN=-2. -", "T3 D=203.2")], "T3: D203.2 mm is large for a path of 40 mm"),
        ([("F640.", "F640000.")], "T3: line 14: a feed per tooth of 80 mm"),
        (
            [("G54\n", "G54\n(T3 D=6. CR=0. - flat end mill)\n")],
            "T3: line 3 states D8 mm (T3 D=8. CR=0. - ZMIN=-2. - flat end mill), line 9 D6 mm",
        ),
        ([("flat end mill", "drill")], "T3: its comment names a drill, and line 14 moves it sideways"),
        (
            [("X40. F640.", "".join(f"X{40 * (k % 2 == 0)}. F640.\nY{10 * k + 10}.\n" for k in range(6)))],
            "T3: passes at Z-2 are 10 mm apart, more than D8 mm: ridges remain",
        ),
        ([("X40. F640.", "X40. F640.\nG84 X9. Z-3. R2. F1000.\nG80")], "names a flat, and line 15 taps a thread"),
    ],
)
def test_a_comment_that_the_motions_contradict(tmp_path: Path, pairs: list[tuple[str, str]], warning: str) -> None:
    draft = drafted(tmp_path, changed(*pairs))
    assert any(warning in text for text in draft.warnings), draft.warnings
    draft.job()


def test_a_margin_around_a_stock_that_is_known(tmp_path: Path) -> None:
    (warning,) = drafted(tmp_path, margin_mm=5.0, stock="box 90 90 9").warnings
    assert warning == "a margin of 5 mm has no effect: the stock is given"
    (warning,) = drafted(tmp_path, changed(("(SLOT)", "(STOCK 80 X 30 X 10)")), margin_mm=5.0).warnings
    assert warning.endswith("the program states its stock in line 2")


def test_a_sound_program_has_no_warnings(tmp_path: Path) -> None:
    rows = "".join(f"X{40 * (k % 2 == 0)}. F640.\nY{4 * k + 4}.\n" for k in range(6))
    assert not drafted(tmp_path, changed(("X40. F640.", rows))).warnings


def test_the_door_has_the_draft(tmp_path: Path) -> None:
    assert twin.draft_job is draft_job
    assert json.dumps(drafted(tmp_path).estimate.as_dict())


def test_the_size_of_the_archive_is_estimated_within_half(tmp_path: Path) -> None:
    draft = drafted(tmp_path, material="Al7075-T6", pitch_mm=0.5, angle_step_deg=2.0)
    run = twin.replay(draft.job(), mcap=tmp_path / "part.mcap")
    assert draft.estimate.samples == pytest.approx(run.summary.samples, rel=0.05)
    assert draft.estimate.machine_time_s == pytest.approx(run.summary.machine_time_s, rel=0.1)
    assert 1.0 / 1.5 < draft.estimate.archive_bytes / run.path.stat().st_size < 1.5


def test_a_run_without_forces_has_no_samples(tmp_path: Path) -> None:
    estimate = drafted(tmp_path).estimate
    assert estimate.samples == 0
    assert estimate.archive_bytes < drafted(tmp_path, material="Al7075-T6").estimate.archive_bytes


def test_the_example_of_the_readme(tmp_path: Path) -> None:
    draft = draft_job(Path(__file__).parents[3] / "examples" / "from_nc" / "plate.nc", material="Al7075-T6")
    assert [(t.number, t.kind, t.diameter_mm, t.teeth) for t in draft.job().tools] == [
        (1, "flat", 10.0, 4),
        (2, "ball", 6.0, 2),
    ]
    assert draft.job().stock.box_mm.max == (58.0, 48.0, 0.0)  # type: ignore[union-attr]
    assert not draft.warnings
