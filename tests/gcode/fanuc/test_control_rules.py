"""Rules of FANUC and Haas: two codes of a group, G53 with G91, still axes, missing D, builder's codes, repeats."""

from __future__ import annotations

import pytest

from gcode.events import LinearMotion, Notice
from gcode.flow.interpreter import check, interpret
from gcode.settings import Limits, MachineSettings


def ends(events) -> list[tuple[float, float, float]]:
    return [event.end_mm for event in events if isinstance(event, LinearMotion)]


def warnings(events) -> list[str]:
    return [event.text for event in events if isinstance(event, Notice) and event.is_warning]


@pytest.mark.parametrize(
    ("text", "last"),
    [
        ("G0 G1 X5 F100", (5.0, 0.0, 0.0)),
        ("G90 G91 X5\nX5", (10.0, 0.0, 0.0)),
        ("G20 G21 X5", (5.0, 0.0, 0.0)),
        ("G54 G55 X5", (15.0, 0.0, 0.0)),
        ("G91 G28 Z0. G90\nX5", (5.0, 0.0, 0.0)),
        ("G1 G1 X5 F1", (5.0, 0.0, 0.0)),
    ],
)
def test_the_last_code_of_a_group_counts_on_fanuc(text: str, last: tuple[float, ...], run) -> None:
    offsets = {"G54": (0.0, 0.0, 0.0), "G55": (10.0, 0.0, 0.0)}
    events = run(f"{text}\nM30", "fanuc", offsets=offsets)
    assert ends(events)[-1] == last
    assert len(warnings(events)) == 1
    assert [error.code for error in check(f"{text}\nM30", dialect="haas")][:1] == ["group-conflict"]


def test_the_words_of_a_code_that_does_not_count_are_not_skipped() -> None:
    assert [error.code for error in check("G4 P100 G28 Z0\nM30")] == ["unused-word"]


def test_g53_with_g91(run) -> None:
    text = "G0 X1 Y2 Z3\nG91\nG53 X9 Z8\nX1\nM30"
    fanuc, haas = run(text, "fanuc"), run(text, "haas")
    assert ends(fanuc) == [(1.0, 2.0, 3.0), (2.0, 2.0, 3.0)]
    assert warnings(fanuc) == ["G53 while G91 is active: the control ignores it, and the block does not move"]
    assert ends(haas) == [(1.0, 2.0, 3.0), (9.0, 2.0, 8.0), (10.0, 2.0, 8.0)]
    assert len(warnings(haas)) == 1


@pytest.mark.parametrize("dialect", ["fanuc", "haas"])
def test_axes_that_stay_where_they_are(dialect: str, run) -> None:
    events = run("G0 X1. A0.\nG91 G28 B0\nG90 G0 C0\nG1 Y2 W0 F100\nM30", dialect, start_mm=(0, 0, 9))
    assert ends(events) == [(1.0, 0.0, 9.0), (1.0, 0.0, 9.0), (1.0, 0.0, 9.0), (1.0, 2.0, 9.0)]
    assert [event.code for event in events if isinstance(event, Notice)] == ["still-axis"] * 4
    assert [error.code for error in check("G0 X1 A90.\nM30", dialect=dialect)] == ["unsupported-word"]


@pytest.mark.parametrize("dialect", ["fanuc", "haas"])
def test_compensation_without_an_offset_number(dialect: str, run) -> None:
    events = run("G41\nG1 X5 Y5 F100\nX20\nG40 X30\nM30", dialect)
    assert ends(events) == [(5.0, 5.0, 0.0), (20.0, 5.0, 0.0), (30.0, 5.0, 0.0)]
    assert warnings(events) == ["G41 without D, and none before: D0 is active, so the radius is 0"]
    events = run("D1\nG41\nG1 X0 Y5 F100\nX20\nG40 Y9\nM30", dialect)
    assert warnings(events) == []


def test_block_numbers_of_offset_data(run) -> None:
    assert ends(run("N20 G10 L2 P1 X1.\nN30 G10 L12 P1 R4.\nN40 G54 G0 X1\nM30", "fanuc")) == [(2.0, 0.0, 0.0)]


def test_codes_of_the_machine_builder(run) -> None:
    text = "G0 X1\nM72\nM117 P3\nX2\nM30"
    assert [error.code for error in check(text)] == ["unknown-code", "unknown-code"]
    events = run(text, "fanuc", m_codes={72: "none", 117: "none"})
    assert [event.text.partition(" ")[0] for event in events if isinstance(event, Notice)] == ["M72", "M117"]
    settings = MachineSettings(m_codes={3: "none"})
    assert [error.code for error in check("M3\nM30", settings=settings)] == ["builder-code"]
    with pytest.raises(ValueError, match=r"m_codes\[72\] must be one of none, got 'stop'"):
        MachineSettings(m_codes={72: "stop"})  # type: ignore[dict-item]


@pytest.mark.parametrize("code", ["M21", "M28", "M51", "M58", "M59 P1", "M61", "M69 P1", "M130", "M138 P10 E50"])
def test_the_codes_of_haas_are_known(code: str, run) -> None:
    assert [e.code for e in run(f"{code}\nM30", "haas") if isinstance(e, Notice)] == ["no-motion"]
    assert check(f"{code}\nM30")[0].code == "unknown-code"


def test_variables_of_haas_with_two_numbers(motions) -> None:
    text = "#10100=5.\n#10549=6.\n#699=7.\n#10800=8.\n#10250=9.\nG0 X#100 Y#549 Z#10699\nX#800 Y#10250\nM30"
    assert [m.end_mm for m in motions(text, "haas")] == [(5.0, 6.0, 7.0), (8.0, 9.0, 7.0)]


def test_counters_of_haas_are_zero_and_reported_once(run) -> None:
    text = "IF [#5405 GE 6000] THEN #3000=15 (TOOL LIFE)\n#1=#5405\nG0 X#1 Y#5501\n#5405=0\nM30"
    notices = [event for event in run(text, "haas") if isinstance(event, Notice)]
    assert [(notice.code, notice.text.partition(" ")[0]) for notice in notices] == [
        ("assumed-zero", "#5405"),
        ("assumed-zero", "#5501"),
        ("no-motion", "#5405"),
    ]


@pytest.mark.parametrize(
    "text",
    [
        "#1=2\nWH[#1GT0]DO1\nG0 X#1\n#1=#1-1\nEND1",
        "#1=2\nWHIL[#1GT0]DO1\nG0 X#1\n#1=#1-1\nEN1",
        "#1=2\nN1 G0 X#1\n#1=#1-1\nIF[#1GT0]GO1",
        "#1=2\nN1 G0 X#1\n#1=#1-1\nIF[#1LE0]GOT2\nGO1\nN2",
        "G0 X2\nIF[[1AN1]EQ1]TH#1=1\nG0 X[#1XO0]\nPO\nDP[X1]\nPC",
    ],
)
def test_abbreviations(text: str, motions) -> None:
    assert [m.end_mm[0] for m in motions(f"{text}\nM30", "fanuc")] == [2.0, 1.0]


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("#1=#1-#11:", "t.nc:1:10: unexpected ':' after the value"),
        ("#1=[#1-#11:]", "t.nc:1:11: unexpected ':' inside brackets"),
        ("#1=[#1-#11", "t.nc:1:4: [ is not closed before the end of the block"),
        ("#1=SIN[#2;", "t.nc:1:7: [ is not closed before the end of the block"),
        ("G1 X#1-#11:", "t.nc:1:11: unexpected ':'"),
        ("G1 X#1-#11 Y2", "t.nc:1:5: X#1-#11 is a computed number without brackets; expected X[#1-#11]"),
    ],
)
def test_what_does_not_belong_into_an_expression_is_named(text: str, message: str) -> None:
    assert str(check(f"{text}\nM30", file="t.nc")[0]).startswith(message)


@pytest.mark.parametrize(
    ("text", "dialect"),
    [
        ("M98 P2 L999999999\nM30\nO2\nG91 G0 X1\nG90\nM99", "fanuc"),
        ("M98 P9990002\nM30\nO2\nG91 G0 X1\nM99", "fanuc"),
        ("G65 P2 L999999999\nM30\nO2\nG91 G0 X1\nM99", "fanuc"),
        ("G66 P2 L999999999\nX1\nM30\nO2\nG91 G0 X1\nM99", "fanuc"),
        ("M97 P2 L999999999\nM30\nN2\nG91 G0 X1\nM99", "haas"),
        ("M98 P2 L200\nM30\nO2\nM98 P3 L9\nM99\nO3\nG91 G0 X1\nM99", "fanuc"),
        ("WHILE[1]DO1\nEND1\nM30", "fanuc"),
        ("N1\nGOTO1\nM30", "fanuc"),
        ("o1 while [1]\no1 endwhile\nM2", "linuxcnc"),
    ],
)
def test_repeats_and_idle_loops_run_into_a_limit(text: str, dialect: str) -> None:
    settings = MachineSettings(limits=Limits(jumps=900, idle_jumps=300))
    assert [error.code for error in check(text, dialect=dialect, settings=settings)] == ["runaway"]


def test_a_loop_that_moves_is_not_idle() -> None:
    settings = MachineSettings(limits=Limits(idle_jumps=5))
    assert check("#1=0\nWHILE[#1LT50]DO1\nG91 G0 X1\n#1=#1+1\nEND1\nM30", settings=settings) == []


def test_blocks_run_again_and_again_have_a_limit() -> None:
    settings = MachineSettings(limits=Limits(repeated=500))
    for text in ("M98 P2 L999\nM30\nO2\nG91 G0 X1\nM99", "#1=0\nN1 G91 G0 X1\nGOTO1\nM30"):
        assert [error.code for error in check(text, settings=settings)] == ["runaway"]
    holes = "G91\nWHILE[1]DO1\nG81 X1 Z-1 R0 L99 F100\nEND1\nM30"
    assert [error.code for error in check(holes, settings=settings)] == ["runaway"]
    assert check("".join(f"G2 X{n} Y0 R900 F100\n" for n in range(1, 900)) + "M30", settings=settings) == []


def test_offsets_that_a_program_makes_are_bounded() -> None:
    text = "#1=1\nWHILE[#1LT2100]DO1\nG10 L12 P#1 R1\n#1=#1+1\nEND1\nM30"
    errors = check(text, settings=MachineSettings(limits=Limits(errors=1)))
    assert [(error.code, error.problem) for error in errors] == [
        ("bad-value", "P#1 is one tool offset too many"),
    ]


def test_codes_of_units_of_other_controls(run) -> None:
    """Mach3 and posts of NX: G70 and G71 for G20 and G21, where the settings state it."""
    assert ends(run("G70 G1 F100 X1\nG71 X1", "fanuc", g70_units=True)) == [(25.4, 0, 0), (1, 0, 0)]
    settings = MachineSettings(g70_units=True, decimal_point="increment")
    (motion,) = (event for event in interpret("G70 G1 F9. X1", settings=settings) if isinstance(event, LinearMotion))
    assert motion.end_mm[0] == pytest.approx(0.00254)
    for dialect in ("fanuc", "haas", "linuxcnc", "grbl"):
        (error,) = check("G70 G90", dialect=dialect)
        assert error.problem.startswith("G70")
    (error,) = check("G70 I5. J0. L6.", dialect="haas", settings=settings)
    assert error.problem.startswith("I5")


def test_p_of_a_call_is_not_that_of_a_work_offset(run) -> None:
    events = run("G55 M98 P1\nM30\nO1\nG0 X1.\nM99", "fanuc", offsets={"G54": (0, 0, 0), "G55": (9, 0, 0)})
    assert ends(events) == [(10, 0, 0)]
