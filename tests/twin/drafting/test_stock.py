"""The stock of a draft: the height at which cutting begins, boxes as requested and as stated."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from gcode.language.program import Program
from twin.drafting.comments.stock_posts import StockStatement
from twin.drafting.cuts import Feed, cuts_of
from twin.drafting.notes import Notes
from twin.drafting.stock import CutShape, StockBox, stock_of, top_of_cut
from twin.errors import StockError

HEAD = "G21 G90 G94 G17\nT1 M6\nS1000 M3\nG0 X0. Y0. Z30.\n"


def feed_of(text: str) -> Feed:
    return cuts_of(Program((HEAD + text).encode(), "part.nc"), "fanuc").feed


def levels(*heights: float) -> str:
    return "".join(f"G0 Z30. X0.\nG0 Z{heights[0] + 3}\nG1 Z{z} F100.\nX50. F300.\n" for z in heights)


@pytest.mark.parametrize(
    ("text", "top_mm"),
    [
        # zero on the stock: a plunge, a ramp and a helix begin above it
        ("G0 Z2.\nG1 Z-3. F100.\nX50. F300.\n", 0.0),
        ("G0 Z2.\nG1 Z1. F100.\nX5. Z-3.\nX90. F300.\n", 0.0),
        (
            "G0 Z2.\nG1 X2. Z0.5 F99.\n" + "".join(f"G3 X2. I-2. Z{0.5 - k / 2}\n" for k in range(1, 6)) + "G1 X99.\n",
            0.0,
        ),
        # a rapid down next to the stock, and a zero far above it
        ("G0 X-9. Z-3.\nG1 X50. F300.\n", 0.0),
        ("G0 Z-60.\nG1 Z-70. F300.\nX50.\n", -69.0),
        # rapids at a clearance height written as feed motions
        ("G0 Z5.\n" + "".join(f"G1 Z-2. F100.\nX{40 * (k + 1)}.\nZ5.\nY{9 * k}.\n" for k in range(4)), 0.0),
        # the same with an approach at the height of the reference point
        ("G28 G91 Z0.\nG90\nG1 X9. F999.\nZ5.\nZ-2. F100.\nX50.\nZ5.\n", 0.0),
        # facing at Z0: some material is above it
        ("G0 Z5.\nG1 Z0. F100.\nX50. F300.\n", 1.0),
        ("G0 Z0.4\nG1 Z0. F100.\nX50. F300.\n", 0.4),
        # zero at the bottom: a step-down above the highest level, at most where plunges begin
        (levels(12.0, 9.0, 6.0), 15.0),
        (levels(12.0, 6.0), 15.0),
        # a surface above zero: its highest point
        ("G0 Z30.\nG1 Z20. F100.\n" + "".join(f"X{5 * k} Z{20 - (k - 5) ** 2 / 5}\n" for k in range(1, 11)), 20.0),
        # holes only
        ("G0 Z2.\nG81 X5. Z-9. R2. F50.\nX9.\nG80\n", 0.0),
        ("G0 Z2.\nG83 X5. Z-9. R2. Q3. F50.\nX9.\nG80\n", 0.0),
        ("G0 Z22.\nG81 X5. Z9. R22. F50.\nX9.\nG80\n", 22.0),
    ],
)
def test_the_top_is_where_cutting_begins(text: str, top_mm: float) -> None:
    assert top_of_cut(feed_of(text)).z_mm == pytest.approx(top_mm)


def slot() -> CutShape:
    return CutShape.of(feed_of("G0 Z2.\nG1 Z-3. F100.\nX50. F300.\n"), {1: 4.0})


def made(requested: str | None, stated: StockStatement | None = None, margin_mm: float = 0.0) -> tuple[StockBox, Notes]:
    notes = Notes()
    return stock_of(slot(), stated, requested, margin_mm, notes, Path()), notes


def test_without_a_request_the_box_is_that_of_the_cutter_and_a_floor() -> None:
    box, notes = made(None)
    np.testing.assert_allclose([box.low_mm, box.high_mm], [[-4, -4, -5], [54, 4, 0]])
    assert [a.subject for a in notes.assumptions] == ["stock"]
    box, _ = made(None, margin_mm=3.0)
    np.testing.assert_allclose([box.low_mm, box.high_mm], [[-7, -7, -6], [57, 7, 0]])


def test_the_sides_of_an_arc_are_those_of_its_path() -> None:
    shape = CutShape.of(feed_of("G0 X10.\nG1 Z-3. F100.\nG3 X10. I-10. F300.\n"), {1: 4.0})
    np.testing.assert_allclose([shape.low_mm[:2], shape.high_mm[:2]], [[-14, -14], [14, 14]])


def test_face_mills_do_not_set_the_sides_where_another_tool_cuts() -> None:
    text = "G0 Z2.\nG1 Z-1. F100.\nX90. F300.\nG0 Z30.\nT2 M6\nG0 X20. Y0\nG1 Z-3. F100.\nX50. F300.\n"
    shape = CutShape.of(feed_of(text), {1: 25.0, 2: 5.0}, {1})
    np.testing.assert_allclose([shape.low_mm, shape.high_mm], [[15, -5, -3], [55, 5, 0]])
    alone = CutShape.of(feed_of(text), {1: 25.0, 2: 5.0}, {1, 2})
    np.testing.assert_allclose([alone.low_mm[:2], alone.high_mm[:2]], [[0, -25], [90, 25]])


@pytest.mark.parametrize(
    ("text", "low_mm", "high_mm"),
    [
        ("box 100 60 20", (-25, -30, -20), (75, 30, 0)),
        ("BOX 100x60x20 at 10 20 5", (-40, -10, -15), (60, 50, 5)),
        ("cylinder 80 30", (-15, -40, -30), (65, 40, 0)),
        ("cylinder 80 30 at 0 0 0", (-40, -40, -30), (40, 40, 0)),
    ],
)
def test_requested_stock(text: str, low_mm: tuple[float, ...], high_mm: tuple[float, ...]) -> None:
    box, notes = made(text)
    np.testing.assert_allclose([box.low_mm, box.high_mm], [low_mm, high_mm])
    assert box.table.get("cylinder_mm" if "cyl" in text else "box_mm") is not None
    assert bool(notes.assumptions) == ("at" not in text)


@pytest.mark.parametrize("text", ["box 100 60", "box 1 2 0", "sphere 3", "cylinder 80", "box 1 2 -3 at 0 0 0", ""])
def test_a_request_that_cannot_be_read_is_refused(text: str) -> None:
    with pytest.raises(StockError, match=r"^--stock .*: expected .*'box X Y Z', 'cylinder D H'"):
        made(text)


@pytest.mark.parametrize(
    ("size_mm", "low_mm", "where"),
    [
        ((30, 60, 20), (10.0, -30.0), "centred over the cutting motions"),
        ((100, 60, 20), (-50.0, -30.0), "zero at its centre, where the cutting motions fit"),
        ((60, 16, 20), (0.0, 0.0), "zero at its corner, where the cutting motions fit"),
    ],
)
def test_a_stated_size_without_a_position(
    size_mm: tuple[float, float, float], low_mm: tuple[float, float], where: str
) -> None:
    """Zero of a program is at a corner of the stock or at its centre where its motions fit in either."""
    stated = StockStatement(size_mm=size_mm, low_mm=(None, None, -18.0), line=2, post="x")
    box, notes = made(None, stated)
    np.testing.assert_allclose(box.low_mm, [*low_mm, -18.0])
    assert f"position X from {low_mm[0]:g}, Y from {low_mm[1]:g}" in notes.lines()[0] and where in notes.lines()[0]
    assert notes.stated == [f"stock {size_mm[0]} x {size_mm[1]} x 20 mm (line 2)"]
    assert made("box 9 9 9", stated)[0].size_mm.tolist() == [9, 9, 9]


def test_a_stock_that_the_motions_miss_gets_a_warning() -> None:
    _, notes = made("box 10 10 10 at 500 0 0")
    assert len(notes.warnings) == 1
    assert notes.warnings[0].startswith("the cutting motions miss the stock along X: stock X 495 to 505")
