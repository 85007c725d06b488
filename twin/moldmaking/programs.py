"""One NC program per stage, one for all stages, and the job file that replays it."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

from twin.cam.path.to_nc import NcOptions, Operation, write_nc
from twin.errors import ToolPathError
from twin.job.job_file import Tool
from twin.moldmaking.model import MoldJob
from twin.moldmaking.stages import MoldPlan, Stage, StageResult
from twin.planning.output_files import refuse_existing
from twin.planning.replay_job import write_replay_job

_NUMBERS: dict[Stage, int] = {"rough": 1001, "semi": 1002, "finish": 1003}
_ALL = 1000


def program_paths(job: MoldJob, stages: Sequence[Stage]) -> dict[str, Path]:
    """Files to be written: a program per stage and, where all stages are planned, ``all`` and ``job``."""
    output = job.output
    suffix = "ngc" if job.machine.dialect == "linuxcnc" else "nc"
    names = {stage: output.folder / f"{output.name}_{stage}.{suffix}" for stage in stages}
    paths: dict[str, Path] = {str(k): v for k, v in names.items()}
    if len(stages) == len(_NUMBERS) and job.machine.dialect != "grbl":
        paths["all"] = output.folder / f"{output.name}.{suffix}"
        paths["job"] = output.folder / f"{output.name}.toml"
    return paths


def write_programs(plan: MoldPlan, stages: Sequence[Stage], *, force: bool = False) -> dict[str, Path]:
    """Write the programs and, where all stages are planned, the job file that replays them.

    Raises:
        ToolPathError: a file exists already, or cannot be written.
    """
    paths = program_paths(plan.job, stages)
    refuse_existing(paths.values(), force=force)
    try:
        plan.job.output.folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise ToolPathError(f"{plan.job.output.folder}: cannot be created: {error.strerror}") from error
    operations = {stage: _operation(plan, plan.stage(stage)) for stage in stages}
    for stage in stages:
        write_nc(paths[stage], [operations[stage]], _options(plan, stage.upper(), _NUMBERS[stage]))
    if "all" in paths:
        write_nc(paths["all"], list(operations.values()), _options(plan, "ALL STAGES", _ALL))
        write_replay_job(paths["job"], replay_tables(plan, paths["all"]), "Replays all stages of the mold.")
    return paths


def _operation(plan: MoldPlan, result: StageResult) -> Operation:
    table = getattr(plan.job, result.stage)
    tool = plan.job.tool_of(table)
    return Operation(
        path=result.path,
        number=tool.number,
        spindle_rpm=table.spindle_rpm,
        teeth=tool.teeth,
        length_mm=tool.length_mm,
    )


def _options(plan: MoldPlan, what: str, number: int) -> NcOptions:
    dialect = plan.job.machine.dialect
    return NcOptions(
        dialect=dialect,
        header=(f"{plan.job.output.name}: {what}",),
        program_number=number if dialect in ("fanuc", "haas") else None,
    )


def replay_tables(plan: MoldPlan, program: Path) -> dict[str, Any]:
    """Tables of the job file that replays a program."""
    job, space = plan.job, plan.space
    return {
        "program": {"file": program.name, "dialect": job.machine.dialect},
        "machine": {"rapid_mm_min": job.machine.rapid_mm_min, "tool_change_s": job.machine.tool_change_s},
        "stock": {"box_mm": {"min": space.low_mm.tolist(), "max": space.high_mm.tolist()}},
        "tools": [_tool_table(tool) for tool in job.tools],
        "simulation": {"slice_pitch_mm": 0.4, "step_mm": 0.5, "angle_step_deg": 5.0},
    }


def _tool_table(tool: Tool) -> dict[str, Any]:
    table = tool.model_dump(mode="python", exclude_none=True, exclude_defaults=True)
    return {key: value for key, value in table.items() if key not in ("cutting", "from_", "library_unit")}
