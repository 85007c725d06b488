"""Axis maps: text in, factors and columns out."""

from __future__ import annotations

import pytest

from twin.errors import MeasuredError
from twin.measured.axes import AxisMap, aliases, guess_map, mirrored

NAMES = ["Fx_N", "Fy [N]", "Dyn-Fz", "Fx1+2", "Fx3+4", "Trigger"]


@pytest.mark.parametrize(
    ("text", "axis", "terms"),
    [
        ("x=-Fy,y=-Fx,z=Dyn-Fz", "x", ((-1.0, "Fy [N]"),)),
        ("x=-Fy,y=-Fx,z=Dyn-Fz", "z", ((1.0, "Dyn-Fz"),)),
        ("X = -fx_n", "x", ((-1.0, "Fx_N"),)),
        ("Fx=+Fx", "x", ((1.0, "Fx_N"),)),
        ("x=Fx1+2+Fx3+4", "x", ((1.0, "Fx1+2"), (1.0, "Fx3+4"))),
        ("x=-Fx1+2-Fx3+4", "x", ((-1.0, "Fx1+2"), (-1.0, "Fx3+4"))),
        ("y=-2.5*Fy [N]", "y", ((-2.5, "Fy [N]"),)),
        ("z=#3; y=#2", "z", ((1.0, "Dyn-Fz"),)),
    ],
)
def test_terms(text: str, axis: str, terms: object) -> None:
    assert AxisMap.parse(text).terms(aliases(NAMES))[axis] == terms


@pytest.mark.parametrize("text", ["", "x", "w=Fx", "x=", "x=-", "x=Fx,x=Fy", "x=Fx,y"])
def test_what_is_no_map(text: str) -> None:
    with pytest.raises(MeasuredError, match=r"expected e.g. x=-Fy,y=-Fx,z=Fz|no column"):
        AxisMap.parse(text).terms(aliases(NAMES))


@pytest.mark.parametrize(
    ("text", "left_handed"),
    [
        ("x=Fx,y=Fy,z=Fz", False),
        ("x=-Fy,y=Fx,z=Fz", False),
        ("x=Fy,y=Fx,z=-Fz", False),
        ("x=Fx,y=Fy,z=-Fz", True),
        ("x=-2.5*Fy [N],y=-Fx_N,z=Dyn-Fz", True),
        ("x=#3,y=#2,z=#4", True),
        ("x=#4,y=#2,z=#3", False),
        ("x=-Fx,y=Fy", False),
        ("x=-A,y=B,z=C", False),
    ],
)
def test_maps_that_mirror_the_axes(text: str, left_handed: bool) -> None:
    assert AxisMap.parse(text).left_handed is left_handed
    found = [*mirrored(AxisMap.parse(text), "workpiece")]
    assert [f"the axis map {AxisMap.parse(text)} mirrors the log's axes" in line for line in found] == [
        True
    ] * left_handed
    assert not [*mirrored(AxisMap.parse(text), "tool")]


def test_an_unknown_column_is_named_with_those_that_are_there() -> None:
    with pytest.raises(MeasuredError, match=r"no column 'Fq'; columns are Fx_N, Fy \[N\], Dyn-Fz"):
        AxisMap.parse("x=-Fq").terms(aliases(NAMES))


def test_text_of_a_map() -> None:
    assert str(AxisMap.parse("z=Fz, x=-Fy ,y=-Fx")) == "x=-Fy,y=-Fx,z=Fz"


@pytest.mark.parametrize(
    ("names", "found"),
    [
        (["Fx", "Fy", "Fz"], "x=Fx,y=Fy,z=Fz"),
        (["fx_n", "fy_n", "fz_n", "mx"], "x=fx_n,y=fy_n,z=fz_n"),
        (["Force Z", "Force X", "Force Y"], "x=Force X,y=Force Y,z=Force Z"),
        (["dyno.Fx", "dyno.Fy", "dyno.Fz"], "x=dyno.Fx,y=dyno.Fy,z=dyno.Fz"),
        (["Fx_raw", "Fx_filtered", "Fy", "Fz"], None),
        (["Fx_exp", "Fx_sim", "Fy_exp", "Fy_sim", "Fz_exp", "Fz_sim"], "x=Fx_exp,y=Fy_exp,z=Fz_exp"),
        (["Fx (filtered)", "Fy (filtered)", "Fz (filtered)"], "x=Fx (filtered),y=Fy (filtered),z=Fz (filtered)"),
        (
            ["Cutting Force X-axis [N]", "Y axis force", "force_z_n"],
            "x=Cutting Force X-axis [N],y=Y axis force,z=force_z_n",
        ),
        (["FX1", "FY1", "FZ1"], "x=FX1,y=FY1,z=FZ1"),
        (["a", "b", "c"], None),
        (["Fx", "Fy"], None),
    ],
)
def test_maps_that_names_tell(names: list[str], found: str | None) -> None:
    guessed = guess_map(names)
    assert (None if guessed is None else str(guessed)) == found
