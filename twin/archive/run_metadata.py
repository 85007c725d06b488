"""Header and summary of a run as MCAP attachments and metadata: text that any MCAP tool shows."""

from __future__ import annotations

import json
import zlib
from collections.abc import Mapping, Sequence
from typing import Any

from twin.archive.container.unpack import ChunkError
from twin.arrays import frozen
from twin.record import Attachment, RunHeader, RunSummary, ToolRecord, ToolSummary

#: Attachment that holds the tool table; the names of the run's own attachments must differ.
TOOL_TABLE = "twin.tools.json"
JSON_TYPE = "application/json"
#: Names in files: they stay as they are when modules are renamed, so that earlier archives can be read.
PARAMETERS = "twin.parameters"
#: Last entry of the head of a file; everything else of the `RunHeader` is written before it.
HEADER = "twin.run"
SUMMARY = "twin.summary"
_CHECKSUM = "crc32"
#: Setting that states which force samples the file keeps.
_SAMPLES = "output.samples"

_HEADER_TEXT = ("twin_version", "program", "force_on")
_HEADER_JSON = ("slice_pitch_mm", "planned_time_s")
_SUMMARY_JSON = (
    *("complete", "machine_time_s", "cutting_time_s", "removed_volume_mm3", "steps", "samples"),
    *("peak_force_n", "mean_force_n", "collisions", "top_lines"),
)
_TOOL_SUMMARY = (
    *("number", "description", "cutting_time_s", "air_time_s", "rapid_time_s", "removed_volume_mm3", "peak_force_n"),
    *("mean_force_n", "peak_torque_nm", "mean_torque_nm", "peak_power_w", "peak_line"),
)


def sealed(data: Mapping[str, str]) -> dict[str, str]:
    """Values with a checksum of them: the format itself has none for metadata."""
    return {**data, _CHECKSUM: _checksum(data)}


def unsealed(data: Mapping[str, str], *, required: bool) -> dict[str, str]:
    """Values without their checksum.

    Args:
        required: whether there must be one; files of version 0.1.0 have none.

    Raises:
        ChunkError: the checksum is wrong or missing.
    """
    values = {key: value for key, value in data.items() if key != _CHECKSUM}
    right = _checksum(values)
    if data.get(_CHECKSUM, "" if required else right) != right:
        raise ChunkError("metadata whose checksum is wrong")
    return values


def _checksum(data: Mapping[str, str]) -> str:
    return f"{zlib.crc32(json.dumps(data, sort_keys=True).encode()):08x}"


def kept_samples(header: RunHeader) -> str:
    """Force samples that an archive keeps: ``all``, ``revolution`` (none), ``cutting`` (those of cutting steps)."""
    return header.parameters.get(_SAMPLES, "all")


def without_samples(header: RunHeader) -> str:
    """Why the archive of a run has no force samples, empty if it has them."""
    if kept_samples(header) != "revolution":
        return ""
    return f'holds no force samples ({_SAMPLES} = "revolution"); replay its job with {_SAMPLES} = "all"'


def tool_table(tools: Sequence[ToolRecord]) -> bytes:
    """The tools as JSON: number, description, profile_mm (radius and height above the tip)."""
    rows = [{"number": t.number, "description": t.description, "profile_mm": t.profile_mm.tolist()} for t in tools]
    return _json(rows).encode()


def header_metadata(header: RunHeader) -> dict[str, str]:
    """The values of a header without parameters, tools and attachments."""
    data = {name: str(getattr(header, name)) for name in _HEADER_TEXT}
    data |= {name: _json(getattr(header, name)) for name in _HEADER_JSON}
    data |= {"job": header.job} if header.job else {}
    work = header.work_bounds_mm
    data |= {} if work is None else {"work_bounds_mm": _json(work.tolist())}
    return data | {"stock_bounds_mm": _json(header.stock_bounds_mm.tolist())}


def to_header(data: Mapping[str, str], parameters: Mapping[str, str], files: Sequence[Attachment]) -> RunHeader:
    """The header from metadata and attachments, the tool table among them.

    Raises:
        KeyError, ValueError, TypeError: a value is missing or of a wrong kind.
    """
    table = {f.name: f for f in files}[TOOL_TABLE]
    tools = [
        ToolRecord(
            number=row["number"],
            description=row["description"],
            profile_mm=frozen(row["profile_mm"], "profile_mm", (None, 2)),
        )
        for row in json.loads(table.data)
    ]
    values: dict[str, Any] = {name: data[name] for name in _HEADER_TEXT}
    work = data.get("work_bounds_mm")
    return RunHeader(
        **values,
        stock_bounds_mm=frozen(json.loads(data["stock_bounds_mm"]), "stock_bounds_mm", (2, 3)),
        slice_pitch_mm=_tuple(json.loads(data["slice_pitch_mm"])),
        planned_time_s=json.loads(data["planned_time_s"]),
        work_bounds_mm=frozen(json.loads(work), "work_bounds_mm", (2, 3)) if work else None,
        tools=tuple(tools),
        parameters=dict(parameters),
        attachments=tuple(f for f in files if f is not table),
        job=data.get("job", ""),
    )


def summary_metadata(summary: RunSummary) -> dict[str, str]:
    """A summary; every value but the digest is JSON."""
    tools = [{name: getattr(tool, name) for name in _TOOL_SUMMARY} for tool in summary.tools]
    data = {name: _json(getattr(summary, name)) for name in _SUMMARY_JSON}
    return data | {"tools": _json(tools), "digest": summary.digest}


def to_summary(data: Mapping[str, str]) -> RunSummary:
    """The summary from metadata.

    Raises:
        KeyError, ValueError, TypeError: a value is missing or of a wrong kind.
    """
    values = {name: _tuple(json.loads(data[name])) for name in _SUMMARY_JSON}
    tools = tuple(ToolSummary(**{n: _tuple(row[n]) for n in _TOOL_SUMMARY}) for row in json.loads(data["tools"]))
    return RunSummary(**values, tools=tools, digest=data["digest"])


def _json(value: Any) -> str:
    """JSON text; numpy's numbers are numbers too."""
    return json.dumps(value, ensure_ascii=False, default=lambda number: number.item())


def _tuple(value: Any) -> Any:
    """Lists of JSON as the tuples of the records."""
    return tuple(_tuple(v) for v in value) if isinstance(value, list) else value
