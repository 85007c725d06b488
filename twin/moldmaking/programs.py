"""NC programs of the stages, one of all stages, and the job file that replays it."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

from twin.cam.path.to_nc import NcOptions, Operation, write_nc
from twin.errors import ToolPathError
from twin.job.model import Tool
from twin.moldmaking.chain import MoldChain, Stage, StageResult
from twin.planning.replay_job import write_replay_job

_NUMBERS: dict[Stage, int] = {"rough": 1001, "semi": 1002, "finish": 1003}
_ALL = 1000


def program_paths(chain: MoldChain, stages: Sequence[Stage]) -> dict[str, Path]:
    """Names of what will be written: a program a stage, and with all stages ``all`` and ``job``."""
    output = chain.job.output
    suffix = "ngc" if chain.job.machine.dialect == "linuxcnc" else "nc"
    names = {stage: output.folder / f"{output.name}_{stage}.{suffix}" for stage in stages}
    paths: dict[str, Path] = {str(k): v for k, v in names.items()}
    if len(stages) == len(_NUMBERS) and chain.job.machine.dialect != "grbl":
        paths["all"] = output.folder / f"{output.name}.{suffix}"
        paths["job"] = output.folder / f"{output.name}.toml"
    return paths


def check_paths(paths: Sequence[Path], *, force: bool) -> None:
    """Whether the files may be written; to be asked before long work.

    Raises:
        ToolPathError: one is there already.
    """
    for path in paths:
        if path.exists() and not force:
            raise ToolPathError(f"{path}: is there already; expected a new folder, or leave to replace it (--force)")


def write_programs(chain: MoldChain, stages: Sequence[Stage], *, force: bool = False) -> dict[str, Path]:
    """Write programs and, where all stages are asked for, the job file that replays them.

    Raises:
        ToolPathError: a file is there already, or cannot be written.
    """
    paths = program_paths(chain, stages)
    check_paths(list(paths.values()), force=force)
    try:
        chain.job.output.folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise ToolPathError(f"{chain.job.output.folder}: cannot be made: {error.strerror}") from error
    operations = {stage: _operation(chain, chain.stage(stage)) for stage in stages}
    for stage in stages:
        write_nc(paths[stage], [operations[stage]], _options(chain, stage.upper(), _NUMBERS[stage]))
    if "all" in paths:
        write_nc(paths["all"], list(operations.values()), _options(chain, "ALL STAGES", _ALL))
        write_replay_job(paths["job"], replay_tables(chain, paths["all"]), "Replays all stages of the mold.")
    return paths


def _operation(chain: MoldChain, result: StageResult) -> Operation:
    table = getattr(chain.job, result.stage)
    tool = chain.job.tool_of(table)
    return Operation(
        path=result.path,
        number=tool.number,
        spindle_rpm=table.spindle_rpm,
        teeth=tool.teeth,
        length_mm=tool.length_mm,
    )


def _options(chain: MoldChain, what: str, number: int) -> NcOptions:
    dialect = chain.job.machine.dialect
    return NcOptions(
        dialect=dialect,
        header=(f"{chain.job.output.name}: {what}",),
        program_number=number if dialect in ("fanuc", "haas") else None,
    )


def replay_tables(chain: MoldChain, program: Path) -> dict[str, Any]:
    """The tables of a replay's job file for a program."""
    job, space = chain.job, chain.space
    return {
        "program": {"file": program.name, "dialect": job.machine.dialect},
        "machine": {"rapid_mm_min": job.machine.rapid_mm_min, "tool_change_s": job.machine.tool_change_s},
        "stock": {"box_mm": {"min": space.low_mm.tolist(), "max": space.high_mm.tolist()}},
        "tools": [_tool_table(tool) for tool in job.tools],
        "simulation": {"slice_pitch_mm": 0.4, "step_mm": 0.5, "angle_step_deg": 5.0},
    }


def _tool_table(tool: Tool) -> dict[str, Any]:
    table = tool.model_dump(mode="python", exclude_none=True, exclude_defaults=True)
    return {key: value for key, value in table.items() if key != "cutting"}
