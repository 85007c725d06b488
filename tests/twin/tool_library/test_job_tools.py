"""``[[tools]] from``: a job's tools from a library, own keys, mistakes, and what the archive keeps."""

from __future__ import annotations

import tomllib
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import jsonschema
import numpy as np
import pytest
from support.job_files import PROGRAM, job_data
from support.tool_libraries import fusion_library, fusion_tool

from twin.errors import JobError
from twin.job import Job, job_from_dict, job_schema
from twin.record import RunHeader
from twin.run.watch import Watch
from twin.simulation.header import run_header
from twin.simulation.program import Plan


def job(tmp_path: Path, *tools: dict[str, Any]) -> Job:
    (tmp_path / "slot.nc").write_text(PROGRAM)
    flat = fusion_tool(type="flat end mill", RE=0, description="6 mm flat", **{"post-process": {"number": 4}})
    drill = fusion_tool(type="drill", description="6 mm drill", expressions={"tool_number": "5"})
    twice = [fusion_tool(description=name, expressions={"tool_number": "8"}, NOF=n) for n, name in ((2, "a"), (3, "b"))]
    (tmp_path / "shop.json").write_bytes(fusion_library(fusion_tool(), flat, drill, *twice))
    return job_from_dict(job_data(tools=[*tools]), tmp_path)


def test_a_tool_by_number_takes_all_sizes_of_the_library(tmp_path: Path) -> None:
    (tool,) = job(tmp_path, {"from": "shop.json", "number": 3}).tools
    assert (tool.number, tool.name, tool.kind, tool.diameter_mm, tool.teeth) == (3, "6 mm ball", "ball", 6.0, 2)
    assert tool.shank is not None and tool.shank.diameter_mm == 5.8 and len(tool.holder) == 3
    assert tool.origin == 'shop.json: data[0], T3 "6 mm ball"'
    assert tool.caution == "helix_deg is not in the library, 0 is used"


def test_a_tool_by_name_takes_its_number_and_own_keys_win(tmp_path: Path) -> None:
    own = {"from": "shop.json", "name": "6 MM FLAT", "helix_deg": 38.0, "teeth": 4}
    first, second = job(tmp_path, own, {**own, "number": 77}).tools
    assert (first.number, first.name, first.teeth, first.helix_deg) == (4, "6 MM FLAT", 4, 38.0)
    assert (first.caution, second.number) == (None, 77)


def test_a_name_decides_between_tools_of_one_number(tmp_path: Path) -> None:
    assert [job(tmp_path, {"from": "shop.json", "number": 8, "name": n}).tools[0].teeth for n in "ab"] == [2, 3]


def test_a_drill_can_be_used_as_another_kind_if_the_job_states_it(tmp_path: Path) -> None:
    (tool,) = job(tmp_path, {"from": "shop.json", "number": 5, "kind": "flat"}).tools
    assert (tool.kind, tool.diameter_mm) == ("flat", 6.0)


@pytest.mark.parametrize(
    ("tool", "message"),
    [
        ({"number": 9}, '.from = "shop.json": {lib}: no tool has the number 9; expected one of 3, 4, 5, 8'),
        ({"number": 8}, '.from = "shop.json": {lib}: 2 tools have the number 8: "a", "b"; expected the name of one'),
        ({"name": "6 mm bal"}, '.from = "shop.json": {lib}: no tool has the name "6 mm bal"; did you mean "6 mm ball"'),
        ({}, '.from = "shop.json": {lib}: neither number nor name of a tool is given; expected one of them'),
        ({"number": 5}, '.from = "shop.json": {lib}: data[2]: T5 "6 mm drill" cannot be simulated: its point is not'),
        ({"from": "none.json", "number": 1}, '.from = "none.json": {none}: cannot be read: no such file or directory'),
        ({"from": "slot.nc", "number": 1}, '.from = "slot.nc": {nc}: is not a tool library but an NC program'),
        ({"number": "3"}, '.number = "3": expected a whole number'),
        ({"number": 3, "library_unit": "cm"}, '.library_unit = "cm": expected one of "mm", "inch"'),
        ({"number": 3, "from": 5}, ".from = 5: expected a file name"),
    ],
)
def test_mistakes_are_named_once(tmp_path: Path, tool: dict[str, Any], message: str) -> None:
    with pytest.raises(JobError) as caught:
        job(tmp_path, {"from": "shop.json", **tool})
    places = {"lib": tmp_path / "shop.json", "none": tmp_path / "none.json", "nc": tmp_path / "slot.nc"}
    (problem, *more) = caught.value.problems
    assert f"tools[0]{message.format(**places)}" in problem.replace(" (tool 3)", "")
    assert not more or tool.get("from") == 5


def test_a_key_that_the_library_lacks_is_missing(tmp_path: Path) -> None:
    (tmp_path / "tool.tbl").write_text("T2 D6 ;flat\n")
    with pytest.raises(JobError) as caught:
        job(tmp_path, {"from": "tool.tbl", "number": 2})
    assert [p.partition(";")[0] for p in caught.value.problems] == [
        "tools[0].teeth (tool 2): missing",
        "tools[0].flute_length_mm (tool 2): missing",
    ]
    own = {"teeth": 2, "flute_length_mm": 0.5}
    (tool,) = job(tmp_path, {"from": "tool.tbl", "number": 2, "library_unit": "inch", **own}).tools
    assert tool.diameter_mm == pytest.approx(152.4)


def test_the_schema_takes_a_tool_from_a_library_and_not_one_without_sizes() -> None:
    jsonschema.validate(job_data(tools=[{"from": "shop.json", "number": 3}]), job_schema())
    with pytest.raises(jsonschema.ValidationError):
        jsonschema.validate(job_data(tools=[{"number": 3}]), job_schema())
    with pytest.raises(jsonschema.ValidationError):
        jsonschema.validate(job_data(tools=[{"from": "shop.json"}]), job_schema())


def test_the_header_has_the_sizes_their_origin_and_a_caution(tmp_path: Path) -> None:
    loaded = job(tmp_path, {"from": "shop.json", "number": 3})
    stock = SimpleNamespace(pitch_mm=np.ones(3), low_mm=np.zeros(3), high_mm=np.ones(3))
    header: RunHeader = run_header(loaded, stock, [], Plan(1.0, None))  # type: ignore[arg-type]
    assert header.parameters["tools[0].from"] == "shop.json"
    assert header.parameters["tools[0].diameter_mm"] == "6.0"
    assert header.parameters["tools[0].origin"].endswith('data[0], T3 "6 mm ball"')
    kept = {a.name: a.data.decode() for a in header.attachments}
    again = job_from_dict({**job_data(), **tomllib.loads(kept["tools_with_sizes.toml"])}, tmp_path)
    assert again.tools[0].model_dump(exclude={"from_"}) == loaded.tools[0].model_dump(exclude={"from_"})
    watch = Watch()
    watch.take(header)
    assert "tool 3: helix_deg is not in the library, 0 is used" in [*watch._on_tools()]
