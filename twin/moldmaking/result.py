"""A planned mold: its stages, machining times, rest material and warnings, with everything needed to write programs."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from types import MappingProxyType

from twin.moldmaking.figures import Rest, Times, rest_table, saved, times_table
from twin.moldmaking.load import load_mold
from twin.moldmaking.model import MoldJob
from twin.moldmaking.programs import write_programs
from twin.moldmaking.stages import STAGES, MoldPlan, Stage, StageResult
from twin.planning.paths import Progress, silent


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Mold:
    """A planned mold.

    Attributes:
        plan: part, stock and tools that the stages were planned with.
        stages: tool path, machining time and stock of each requested stage.
        times: machining times by search method, and of the raster baseline where it is requested; of all stages only.
        rest: rest material after each stage; of all stages only.
        warnings: undercuts, shank or holder that would touch the part, depths of cut beyond the flute length.
    """

    plan: MoldPlan
    stages: Mapping[Stage, StageResult]
    times: tuple[Times, ...]
    rest: Mapping[str, Rest]
    warnings: tuple[str, ...]

    @property
    def saved(self) -> float | None:
        """Share of the raster baseline's time that the best order saves; None without the baseline."""
        return saved(self.times)

    def write(self, *, force: bool = False) -> dict[str, Path]:
        """Write an NC program per stage and, of all stages, one program and the job file that replays it.

        They go to the folder of the job, ``output.folder``, which is created if it is missing.

        Args:
            force: replace files that exist.

        Returns:
            The files, by stage, and ``all`` and ``job``.

        Raises:
            ToolPathError: a file exists already, or cannot be written.
        """
        return write_programs(self.plan, tuple(self.stages), force=force)


def mold(job: MoldJob | Path | str, *, stage: Stage | None = None, progress: Progress = silent) -> Mold:
    """Plan roughing, semi-finishing and finishing of a mold from its STL file.

    Args:
        job: a mold job, or the path of its file (TOML).
        stage: the only stage to return; those before it are planned as well.
        progress: called with the current task and the share of the work that is done, 0 to 1.

    Returns:
        The stages; `Mold.write` writes the programs.

    Raises:
        JobError: the job file cannot be read or has mistakes; the message has every one.
        MeshError, StockError: the part is not a closed solid, or the stock does not contain it.

    Example:
        >>> mold("examples/mold/job.toml").write()
    """
    plan = MoldPlan(job if isinstance(job, MoldJob) else load_mold(job), progress)
    names: tuple[Stage, ...] = STAGES if stage is None else (stage,)
    stages = MappingProxyType({name: plan.stage(name) for name in names})
    whole = stage is None
    return Mold(
        plan=plan,
        stages=stages,
        times=tuple(times_table(plan)) if whole else (),
        rest=MappingProxyType(rest_table(plan) if whole else {}),
        warnings=tuple(plan.warnings(names)),
    )
