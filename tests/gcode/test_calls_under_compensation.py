"""Calls while cutter compensation or a corner holds a motion back: the path is as without a call."""

from __future__ import annotations

import pytest

from gcode import ArcMotion, LinearMotion, MachineSettings, ToolOffset, interpret

TOOLS = MachineSettings(tools={1: ToolOffset(length_mm=0.0, radius_mm=1.0)})
BEFORE = "G21 G90 G17 G54\nT1 M6\nG0 X-20 Y-20\n"
AFTER = "G1 Y40\nG40 G1 X-20 Y60\nM30\n"
ONCE = "G1 Y20\nG1 X4 Y30\n"
START = "G41 D1 G1 X0 Y-10 F100\nG1 Y10\n"
CORNER = "G1 X0 Y-10 F100\nG1 X10 ,C2\n"


def path(text: str, dialect: str) -> list[tuple[float, ...]]:
    """Ends of all motions, centres of arcs with them."""
    events = interpret(text, dialect=dialect, settings=TOOLS)
    motions = [e for e in events if isinstance(e, LinearMotion | ArcMotion)]
    return [(*(round(v, 9) for v in m.end_mm), *(m.centre_mm if isinstance(m, ArcMotion) else ())) for m in motions]


@pytest.mark.parametrize("dialect", ["fanuc", "haas"])
@pytest.mark.parametrize("start", [START, CORNER], ids=["compensation", "corner"])
@pytest.mark.parametrize("repeats", [1, 2])
def test_subprograms(dialect: str, start: str, repeats: int) -> None:
    call = "M98 P2\n" if repeats == 1 else "M98 P2 L2\n"
    written = path(f"%\nO1\n{BEFORE}{start}{ONCE * repeats}{AFTER}%\n", dialect)
    assert path(f"%\nO1\n{BEFORE}{start}{call}{AFTER}O2\n{ONCE}M99\n%\n", dialect) == written
    assert len(written) >= 6


@pytest.mark.parametrize("dialect", ["fanuc", "haas"])
def test_macros(dialect: str) -> None:
    written = path(f"%\nO1\n{BEFORE}{START}{ONCE}{AFTER}%\n", dialect)
    assert path(f"%\nO1\n{BEFORE}{START}G65 P2\n{AFTER}O2\n{ONCE}M99\n%\n", dialect) == written


def test_haas_local_subprograms() -> None:
    written = path(f"%\nO1\n{BEFORE}{START}{ONCE}{AFTER}%\n", "haas")
    assert path(f"%\nO1\n{BEFORE}{START}M97 P50\n{AFTER}N50 {ONCE}M99\n%\n", "haas") == written


@pytest.mark.parametrize("dialect", ["fanuc", "haas"])
def test_a_modal_macro_is_called_once_for_each_block_that_moves(dialect: str) -> None:
    """Also for the first blocks, whose motions wait, and not for the block without motion that cancels compensation."""
    text = (
        f"%\nO1\n{BEFORE}G66 P2\nG41 D1 G1 X0 Y-10 F100\nG1 Y10\nG1 Y40\nG1 X40\nG67\nG40 G1 X60 Y60\n"
        "#101=#100\nG0 Z-[#101]\nM30\nO2\n#100=#100+1\nM99\n%\n"
    )
    assert path(text, dialect)[-1][2] == -4.0


def test_subroutines_of_linuxcnc() -> None:
    written = path(f"{BEFORE}{START}{ONCE}{AFTER}", "linuxcnc")
    routine = f"o<side> sub\n{ONCE}o<side> endsub\n"
    assert path(f"{routine}{BEFORE}{START}o<side> call\n{AFTER}", "linuxcnc") == written


@pytest.mark.parametrize("save", ["M70", "M73"])
def test_saved_modes_of_linuxcnc(save: str) -> None:
    """M70 in its block saves the modes before the next one changes them; M72 restores them there."""
    start = "G41 D1 G1 X0 Y-10 F100\nG1 Y10\n"
    changed = f"{save}\nG91 G1 Y10\n" + ("M72\n" if save == "M70" else "")
    body = f"o<side> sub\n{changed}o<side> endsub\n"
    written = path(f"{BEFORE}{start}G91 G1 Y10\nG90\n{AFTER}", "linuxcnc")
    assert path(f"{body}{BEFORE}{start}o<side> call\n{AFTER}", "linuxcnc") == written
