"""Settings of paths, reach, verify and mold: options and schema are those of their models."""

from __future__ import annotations

import json
import re
from pathlib import Path
from typing import Any

import pytest
import typer
from pydantic import BaseModel

from twin.cli import run
from twin.cli.app import COMMANDS, app_for, whole_app
from twin.moldmaking.model import MoldFile
from twin.planning.settings import PathSettings, ReachSettings
from twin.settings.keys import bare, option_names
from twin.verification.settings import VerifySettings

DOCS = Path(__file__).parents[2] / "docs"
#: Options of `twin paths` and of the other commands before they were made from the settings.
FORMER = {
    "paths": "--tool --settings --pitch --tolerance --exact --slices --stepover --allowance --layers --axial-depth "
    "--radial-depth --direction --zigzag --one-way --climb --conventional --region --overhang --floor-z --stock "
    "--remaining --arcs --feed --plunge-feed --spindle --safe-z --clearance --entry --lead --tool-number --dialect "
    "--job-file --plot --rrd --force --json --quiet -q --out -o",
    "reach": "--tool --pitch --thin --above --largest --json --rrd --mesh --plot --force --threads",
    "machinable": "--tool --pitch --thin --above --largest --json --rrd --mesh --plot --force --threads",
    "verify": "--tolerance --excess --region --pitch --plot --rrd --force --json --quiet -q",
    "mold": "--stage --plot --rrd --force --json --quiet -q",
}


def options(command: str) -> set[str]:
    found = typer.main.get_command(whole_app()).commands[command]  # type: ignore[attr-defined]
    return {name for parameter in found.params for name in (*parameter.opts, *parameter.secondary_opts)}


def test_the_program_s_help_has_the_first_line_of_every_command() -> None:
    whole = typer.main.get_command(whole_app()).commands  # type: ignore[attr-defined]
    assert {name: c.help.split("\n\n")[0] for name, c in whole.items() if not c.hidden} == COMMANDS
    listed = typer.main.get_command(app_for(["--help"])).commands  # type: ignore[attr-defined]
    assert {name: c.help for name, c in listed.items()} == COMMANDS


@pytest.mark.parametrize(
    ("arguments", "names"), [(["info", "x.mcap"], ["info"]), (["machinable"], [*COMMANDS, "machinable"])]
)
def test_a_command_line_loads_its_own_command(arguments: list[str], names: list[str]) -> None:
    assert list(typer.main.get_command(app_for(arguments)).commands) == names  # type: ignore[attr-defined]


@pytest.mark.parametrize(
    ("command", "model", "omitted"),
    [("paths", PathSettings, {"strategy"}), ("reach", ReachSettings, set()), ("verify", VerifySettings, set())],
)
def test_every_key_has_its_option(command: str, model: type[BaseModel], omitted: set[str]) -> None:
    found = options(command)
    for key, field in model.model_fields.items():
        names = {n for name in option_names(key, field) for n in name.split("/")}
        assert names <= found or key in omitted, key


@pytest.mark.parametrize("command", FORMER)
def test_former_options_are_valid(command: str) -> None:
    assert set(FORMER[command].split()) <= options(command)


def test_the_page_of_the_mold_has_every_key() -> None:
    page = (DOCS / "mold.md").read_text()
    for name, field in MoldFile.model_fields.items():
        if name != "tools":
            keys = set(bare(field.annotation).model_fields)
            assert keys <= set(re.findall(r"^\| `(\w+)` \|", page, flags=re.M)) and f"`[{name}]`" in page, name


@pytest.mark.parametrize(
    ("file", "model"),
    [("mold", MoldFile), ("paths", PathSettings), ("reach", ReachSettings), ("verify", VerifySettings)],
)
def test_the_schema_has_every_key(file: str, model: type[BaseModel], capsys: pytest.CaptureFixture[str]) -> None:
    assert run(["schema", file]) == 0
    schema: dict[str, Any] = json.loads(capsys.readouterr().out)
    assert set(schema["properties"]) == set(model.model_fields)
    assert not schema["additionalProperties"]
