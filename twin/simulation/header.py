"""The first record of a run: every setting and input file, so that the archive alone explains its numbers."""

from __future__ import annotations

import os
import platform
from collections.abc import Iterator, Mapping, Sequence
from importlib.metadata import version
from pathlib import Path
from typing import Any

from twin.archive.same_job import job_key
from twin.arrays import frozen
from twin.job import Job
from twin.record import Attachment, RunHeader, ToolRecord
from twin.settings.toml_text import toml_text
from twin.simulation.program import Plan
from twin.version import __version__
from twin.workpiece.trislice import TriSlices

_LIBRARIES = ("numpy", "numba", "pyclipper", "trimesh")


def run_header(
    job: Job, workpiece: TriSlices, tools: Sequence[ToolRecord], plan: Plan, stock_notes: Sequence[str] = ()
) -> RunHeader:
    """Describe a run: stock, tools, settings with their defaults, versions, and the files it was made from.

    Args:
        plan: time and extent of the program.
        stock_notes: what was assumed or mended in the file of the stock.
    """
    parameters = dict(_flat(job.model_dump(mode="json", exclude={"text", "path"}, by_alias=True)))
    parameters = {key: _in_folder(text, _folder(job)) for key, text in parameters.items()}
    parameters |= {f"version.{name}": version(name) for name in _LIBRARIES}
    parameters |= {"version.python": platform.python_version(), "version.twin": __version__}
    parameters |= {f"stock.note[{index}]": note for index, note in enumerate(stock_notes)}
    x, y, z = workpiece.pitch_mm
    return RunHeader(
        twin_version=__version__,
        program=Path(job.program.file).name,
        stock_bounds_mm=frozen([workpiece.low_mm, workpiece.high_mm], "stock_bounds_mm", (2, 3)),
        slice_pitch_mm=(float(x), float(y), float(z)),
        tools=tuple(tools),
        planned_time_s=plan.time_s,
        work_bounds_mm=None if plan.work_mm is None else frozen(plan.work_mm, "work_bounds_mm", (2, 3)),
        parameters=parameters,
        attachments=tuple(_attachments(job)),
        job=job_key(job.path) or job_key(Path(job.program.file)),
    )


def _flat(value: Any, path: str = "") -> Iterator[tuple[str, str]]:
    """Nested settings as (key path, text) pairs; settings that are not given are omitted."""
    if isinstance(value, Mapping):
        for key, inner in value.items():
            yield from _flat(inner, f"{path}.{key}" if path else str(key))
    elif isinstance(value, list | tuple) and any(isinstance(v, Mapping) for v in value):
        for index, inner in enumerate(value):
            yield from _flat(inner, f"{path}[{index}]")
    elif value is not None:
        yield path, str(value)


def _folder(job: Job) -> str:
    """Folder of the job file, or of the program of a job in no file, as the job has it, with a separator at its end."""
    file = job.path if job.path.is_file() else Path(job.program.file)
    return "" if file.parent == Path() else f"{file.parent}{os.sep}"


def _in_folder(text: str, folder: str) -> str:
    """A text with the paths in a folder relative to it: runs are the same wherever the folder is."""
    return text.replace(folder, "") if folder else text


def _attachments(job: Job) -> Iterator[Attachment]:
    yield Attachment(name=job.path.name, media_type="application/toml", data=job.text.encode())
    if any(tool.from_ is not None for tool in job.tools):
        tools = [tool.model_dump(mode="json", exclude_none=True, exclude={"from_"}) for tool in job.tools]
        yield Attachment(
            name="tools_with_sizes.toml", media_type="application/toml", data=toml_text({"tools": tools}).encode()
        )
    program = Path(job.program.file)
    yield Attachment(name=program.name, media_type="text/plain", data=program.read_bytes())
    if job.stock.stl is not None:
        stl = Path(job.stock.stl)
        yield Attachment(name=stl.name, media_type="model/stl", data=stl.read_bytes())
