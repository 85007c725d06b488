"""Options made from a settings table: names, types, help and defaults are the fields'."""

from __future__ import annotations

import re
from collections.abc import Mapping
from pathlib import Path
from typing import Annotated, Any, Literal

import pytest
import typer
from pydantic import Field
from typer.testing import CliRunner

from twin.cli.help import HelpCommand
from twin.cli.options import option_of, options_from, options_table
from twin.settings.keys import keys_table
from twin.settings.table import FilePath, Key, Table


class Milling(Table):
    """A table with every type that an option can give."""

    feed_mm_min: float = Field(default=600.0, gt=0.0, description="feed of cuts")
    spindle_rpm: float | None = Field(default=None, description="spindle speed")
    lead_mm: Annotated[float | None, Key(unset="0.4 of the diameter")] = Field(default=None, description="lead radius")
    teeth: int = Field(default=2, description="number of flutes")
    entry: Literal["ramp", "helix"] = Field(default="ramp", description="entry into material")
    climb: Annotated[bool, Key(options=("--climb/--conventional",))] = Field(default=True, description="climb milling")
    exact: bool = Field(default=False, description="from triangles [exact]")
    quick: Annotated[bool, Key(options=("--quick",))] = Field(default=False, description="quickly")
    region_mm: Annotated[tuple[float, float] | None, Key(metavar="X0 X1")] = Field(default=None, description="region")
    window: tuple[str, ...] = Field(default=(), description="window")
    names: Annotated[tuple[str, ...] | None, Key(as_text=True)] = Field(default=None, description="names")
    picture: FilePath | None = Field(default=None, description="picture")
    tables: dict[str, float] = Field(default_factory=dict, description="not for the command line")


def call(*arguments: str) -> tuple[int, str, dict[str, Any]]:
    app = typer.Typer(add_completion=False)
    found: dict[str, Any] = {}

    @app.command(cls=HelpCommand)
    @options_from(Milling, "given", panel="Milling")
    def mill(
        part: Path,
        given: Mapping[str, Any],
        force: Annotated[bool, typer.Option("--force", help="Replace files.")] = False,
    ) -> None:
        found.update(given, part=part, force=force)

    done = CliRunner().invoke(app, list(arguments), env={"COLUMNS": "200", "TERMINAL_WIDTH": "200"})
    return done.exit_code, done.output, found


def test_options_that_are_not_given_stay_unset() -> None:
    assert call("a.stl") == (0, "", {"part": Path("a.stl"), "force": False})


def test_options_take_the_types_of_the_fields() -> None:
    code, _, found = call(
        *("a.stl", "--feed", "200", "--teeth", "3", "--entry", "helix", "--conventional", "--no-exact", "--quick"),
        *("--region", "1", "2", "--window", "1:2", "--window", "3:4", "--names", "a,b", "--picture", "p.png"),
    )
    assert code == 0
    assert found == {
        "part": Path("a.stl"),
        "force": False,
        "feed_mm_min": 200.0,
        "teeth": 3,
        "entry": "helix",
        "climb": False,
        "exact": False,
        "quick": True,
        "region_mm": (1.0, 2.0),
        "window": ["1:2", "3:4"],
        "names": "a,b",
        "picture": Path("p.png"),
    }


@pytest.mark.parametrize("arguments", [("--entry", "drill"), ("--teeth", "2.5"), ("--tables", "1")])
def test_what_no_field_takes_is_a_usage_error(arguments: tuple[str, ...]) -> None:
    assert call("a.stl", *arguments)[0] == 2


def test_help_shows_units_defaults_and_choices_of_the_fields() -> None:
    text = re.sub(r"[│ ]+", " ", call("--help")[1])
    assert "Milling" in text
    assert "<bool>" not in text
    for line in (
        *("--feed MM/MIN Feed of cuts. [default: 600]", "--spindle RPM Spindle speed. \n"),
        *("--lead MM Lead radius. [default: 0.4 of the diameter]", "--teeth N Number of flutes. [default: 2]"),
        *("--entry <ramp|helix> Entry into material. [default: ramp]", "--quick Quickly. \n", "--force Replace files."),
        *("--climb --conventional Climb milling. [default: climb]", "--region X0 X1 Region.", "--names TEXT Names."),
        *("--exact --no-exact From triangles [exact]. [default: no-exact]", "--picture FILE Picture."),
        *("--window TEXT Window; may be repeated.", "--help Show this message"),
    ):
        assert line in text


def test_an_option_is_named_by_its_key() -> None:
    assert [option_of(Milling, key) for key in ("feed_mm_min", "lead_mm", "climb")] == ["--feed", "--lead", "--climb"]


def test_two_keys_with_one_option_and_lists_of_tables_are_mistakes_of_the_program() -> None:
    class Twice(Table):
        lead_mm: float = 0.0
        lead_mm_min: float = 1.0

    with pytest.raises(ValueError, match="--lead is the option of lead_mm and of lead_mm_min"):
        options_from(Twice, "given")

    class Nested(Table):
        rows: tuple[dict[str, float], ...] = ()

    with pytest.raises(TypeError, match="no option can give"):
        options_from(Nested, "given")(lambda given: None)


def test_a_pages_table_has_every_key_with_its_default() -> None:
    assert keys_table(Milling).splitlines()[:8] == [
        "| key | default | meaning |",
        "| --- | --- | --- |",
        "| `feed_mm_min` | `600` | feed of cuts |",
        "| `spindle_rpm` | | spindle speed |",
        "| `lead_mm` | 0.4 of the diameter | lead radius |",
        "| `teeth` | `2` | number of flutes |",
        '| `entry` | `"ramp"` | entry into material: `ramp`, `helix` |',
        "| `climb` | `true` | climb milling |",
    ]


def test_a_pages_table_has_every_option() -> None:
    rows = options_table(Milling).splitlines()[2:]
    assert len(rows) == len(Milling.model_fields) - 1
    assert rows[0] == "| `--feed MM/MIN` | 600 | feed of cuts |"
    assert rows[4] == r"| `--entry ramp\|helix` | ramp | entry into material |"
    assert rows[5] == "| `--climb`, `--conventional` | `--climb` | climb milling |"
    assert rows[7] == "| `--quick` | | quickly |"
