"""Comments of posts: the example of every form, and comments that only look like one."""

from __future__ import annotations

import pytest

from gcode.language.program import Program
from twin.drafting.comments.program_text import Comment, ProgramText, Unit
from twin.drafting.comments.stock_posts import stock_comment
from twin.drafting.comments.tool_posts import TOOL_POSTS, ToolPost, tool_comments
from twin.drafting.comments.tool_words import ToolStatement, described, kind_in, number_of


def comments(*texts: str) -> tuple[Comment, ...]:
    return tuple(Comment(line=line, text=text) for line, text in enumerate(texts, start=1))


@pytest.mark.parametrize("post", TOOL_POSTS, ids=lambda post: post.post)
def test_the_example_of_each_post_is_read(post: ToolPost) -> None:
    (found,) = tool_comments(comments(post.example), post.unit)
    assert found.post is post
    assert found.states == ToolStatement(**post.states)


@pytest.mark.parametrize(
    ("text", "unit", "states"),
    [
        ("1/2 FLAT ENDMILL", "inch", {"kind": "flat", "diameter_mm": 12.7}),
        ("1-1/4 INDEXABLE FACE MILL", "mm", {"kind": "face mill", "diameter_mm": 31.75}),
        (".25 SPOT", "inch", {"kind": "spot drill", "diameter_mm": 6.35}),
        ("FREZA D5", "mm", {"kind": "flat", "diameter_mm": 5.0}),
        ("FRAESER D10", "mm", {"kind": "flat", "diameter_mm": 10.0}),
        ("SCHAFTFRAESER DM 6", "mm", {"kind": "flat"}),
        ("KUGELFRAESER Ø8", "mm", {"kind": "ball", "diameter_mm": 8.0}),
        ("END MILL DIA 8.0MM", "inch", {"kind": "flat", "diameter_mm": 8.0}),
        ("D8 ENDMILL R4", "mm", {"kind": "ball", "diameter_mm": 8.0, "corner_radius_mm": 4.0}),
        ("BULL NOSE 12 MM R2 4FL", "mm", {"kind": "bull", "diameter_mm": 12.0, "corner_radius_mm": 2.0, "teeth": 4}),
        ("10 mm ball nose, helix 45", "mm", {"kind": "ball", "diameter_mm": 10.0, "helix_deg": 45.0}),
        ("V-Bit {60 deg 12.7 mm}", "mm", {"kind": "chamfer mill", "diameter_mm": 12.7, "angle_deg": 30.0}),
        ("3FL 6mm LOC 13", "mm", {"kind": None, "diameter_mm": 6.0, "teeth": 3, "flute_length_mm": 13.0}),
        ('O Flute 1/4"', "mm", {"kind": "flat", "diameter_mm": 6.35, "teeth": 1}),
        ("End Mill - Diameter 0.25 inches - Collet .25", "mm", {"kind": "flat", "diameter_mm": 6.35}),
        ("FRAISE 2 TAILLES D16 Z4", "mm", {"kind": "flat", "diameter_mm": 16.0, "teeth": 4}),
        ("FRAISE A SURFACER D50 Z5", "mm", {"kind": "face mill", "diameter_mm": 50.0, "teeth": 5}),
        ("FRAISE HEMISPHERIQUE D8", "mm", {"kind": "ball", "diameter_mm": 8.0}),
        ("SCHAFTFRAESER D10 R0 Z3", "mm", {"kind": "flat", "diameter_mm": 10.0, "teeth": 3}),
        ("VHM FRÄSER DM 12 ECKENRADIUS 1 Z=4", "mm", {"kind": "bull", "diameter_mm": 12.0, "corner_radius_mm": 1.0}),
        ("SPIRALBOHRER D8,5", "mm", {"kind": "drill", "diameter_mm": 8.5}),
        ("GEWINDEBOHRER M10", "mm", {"kind": "tap", "diameter_mm": 10.0}),
        ("3/8 SPOTDRILL", "inch", {"kind": "spot drill", "diameter_mm": 9.525}),
        ("TIPRAD DIAMETER 16. TIP RAD 2. LENGTH 80.", "mm", {"kind": "bull", "corner_radius_mm": 2.0}),
        ("4Z 8MM ENDMILL", "mm", {"kind": "flat", "diameter_mm": 8.0, "teeth": 4}),
        ("POCKET 3", "mm", {"kind": None, "diameter_mm": None}),
    ],
)
def test_a_tool_in_words(text: str, unit: Unit, states: dict[str, object]) -> None:
    found = described(text, unit)
    assert {name: getattr(found, name) for name in states} == pytest.approx(states)


@pytest.mark.parametrize(
    ("text", "number", "diameter_mm", "kind"),
    [
        ("WERKZEUG T07 KUGEL D8 R4 L40", 7, 8.0, "ball"),
        ("OUTIL 3 : FRAISE D6", 3, 6.0, "flat"),
        ("T3 BOHRER 6,8", 3, 6.8, "drill"),
        ("T7 NO. 7 DRILL", 7, None, "drill"),
        ("TOOL NO:3 NAME:D10R0.5 DIA:10.00 R:0.50 LEN:75.00", 3, 10.0, "bull"),
        ("OP 1:  CONTOUR, TOOL 1: .5 ROUGH ENDMILL", 1, 0.5, "flat"),
        ("EM10R0", None, 10.0, "flat"),
    ],
)
def test_numbers_in_comments(text: str, number: int | None, diameter_mm: float | None, kind: str) -> None:
    (found,) = tool_comments(comments(text), "mm")
    assert (found.states.number, found.states.diameter_mm, found.states.kind) == (number, diameter_mm, kind)


@pytest.mark.parametrize(
    "text",
    [
        "POCKET 50 X 34 WITH CORNER RADII, 6 DEEP",
        "HELICAL ENTRY TO 3 DEEP",
        "DRILL 4 HOLES",
        "DATE=DD-MM-YY - 12-03-24 TIME=HH:MM - 10:41",
        "MATERIAL - ALUMINUM MM - 6061",
        "Toolpath:- Pocket 1",
        "FINISH WALL TOL 0.01 MM",
        "TOOL LIST",
    ],
)
def test_other_comments_are_not_about_a_tool(text: str) -> None:
    assert not list(tool_comments(comments(text), "mm"))


@pytest.mark.parametrize(
    ("text", "number"),
    [(".5", 0.5), ("10.", 10.0), ("3/8", 0.375), ("1 1/4", 1.25), ("1-1/4", 1.25), ("-0.54", -0.54), ("6,35", 6.35)],
)
def test_numbers_of_labels(text: str, number: float) -> None:
    assert number_of(text) == number


def test_special_tools_come_before_general_words() -> None:
    names = ("SLOT DRILL", "THREAD MILL", "CHAMFER MILL", "BALL END MILL", "T-SLOT CUTTER", "TAP 1/4-20", "1/2 EM")
    kinds = ["flat", "thread mill", "chamfer mill", "ball", "slot mill", "tap", "flat"]
    assert [kind_in(name) for name in names] == kinds
    assert kind_in("WORKPIECE") is None


def test_comments_belong_to_the_tool_change_they_are_at() -> None:
    text = "(6 mm ball nose)\nT1 M6\nG0 X0\n(D10 END MILL)\nT2\nM6\n(CARBIDE)\nG1 X5 ; last\n"
    program = ProgramText(Program(text.encode(), "part.nc"))
    words = [(c.text, w.number) for c in program.comments if (w := program.tool_at(c.line)) is not None]
    assert words == [("6 mm ball nose", 1), ("D10 END MILL", 2), ("CARBIDE", 2), ("last", 2)]
    assert (program.unit, program.states_unit) == ("mm", False)
    assert ProgramText(Program(b"(G21)\nN1G70\n", "part.nc")).unit == "inch"


@pytest.mark.parametrize(
    ("texts", "unit", "size_mm", "low_mm"),
    [
        (["STOCK/BLOCK,100.00, 60.00, 10.00,50.00, 30.00, 10.00"], "mm", (100, 60, 10), (-50, -30, -10)),
        (
            ["stockMin:0.00mm, 0.00mm, -1.00mm", "stockMax:100.00mm, 80.00mm, 0.00mm"],
            *("inch", (100, 80, 1), (0, 0, -1)),
        ),
        (
            ["Material Size", "X= 4.000, Y= 3.000, Z= 0.500", "Z Origin for Material  = Material Surface"],
            *("inch", (101.6, 76.2, 12.7), (None, None, -12.7)),
        ),
        (
            [
                *("Material Size", "X= 120.000, Y= 80.000 ,Z= 12.000", "Z Origin for Material = Table Surface"),
                "XY Origin for Material = Bottom Left Corner",
            ],
            *("mm", (120, 80, 12), (0, 0, 0)),
        ),
        (
            ["the part is cut from a 100x90x50mm", "block with the zero point at the center top of the block"],
            *("inch", (100, 90, 50), (-50, -45, -50)),
        ),
        (
            ["Material Setup", "X Min = 0.000   Y Min = 0.000  Z Min = -38", "X Max = 80  Y Max = 300  Z Max = 0.000"],
            *("mm", (80, 300, 38), (0, 0, -38)),
        ),
        (["STOCK: 4.0 X 3.0 X 1.0 INCH"], "mm", (101.6, 76.2, 25.4), (None, None, None)),
    ],
)
def test_stock_in_comments(
    texts: list[str], unit: Unit, size_mm: tuple[float, ...], low_mm: tuple[float | None, ...]
) -> None:
    found = stock_comment(comments(*texts), unit)
    assert found is not None
    assert found.size_mm == pytest.approx(size_mm)
    assert found.low_mm == tuple(None if value is None else pytest.approx(value) for value in low_mm)


@pytest.mark.parametrize("text", ["X= 1, Y= 2, Z= 3", "POCKET 50 X 34 X 6", "STOCK TO LEAVE 0.3", "STOCK 0 X 3 X 1"])
def test_other_comments_are_not_about_the_stock(text: str) -> None:
    assert stock_comment(comments(text), "mm") is None
