"""A machining digital twin: replays NC programs, removes material, predicts cutting forces.

    import twin

    run = twin.replay("examples/ball_slot/job.toml")
    print(run.summary.peak_force_n, run.forces["fx_n"].max())

The names below are the public interface; every other module is private and may change. Importing the package loads
nothing else: a name is loaded when it is used for the first time.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from twin.api import compare, identify, open_run, read_log, records, replay, write_coefficients, write_report
    from twin.comparison.comparison import Comparison
    from twin.drafting.draft import JobDraft, draft_job
    from twin.drafting.settings import DraftSettings
    from twin.errors import (
        ArchiveError,
        CollisionError,
        CompareError,
        CutsError,
        IdentifyError,
        JobError,
        MaterialError,
        MeasuredError,
        MeshError,
        ReplayError,
        SettingsError,
        StockError,
        ToolError,
        ToolLibraryError,
        ToolPathError,
        TwinError,
    )
    from twin.identification.result import Identified
    from twin.job import Job, job_from_dict, load_job
    from twin.materials import Material, find_material, load_materials
    from twin.measured.log import ForceLog
    from twin.measured.settings import CompareSettings, LogReading
    from twin.moldmaking import Mold, MoldJob, load_mold, mold
    from twin.planning.part_reach import PartReach, reach
    from twin.planning.planned_path import PlannedPath, plan_paths, write_paths
    from twin.planning.settings import PathSettings, ReachSettings
    from twin.record import (
        Attachment,
        Collision,
        Engagement,
        ForceSamples,
        NcEvent,
        Record,
        RunHeader,
        RunSummary,
        Step,
        ToolRecord,
        ToolSummary,
        WorkpiecePatch,
    )
    from twin.report.page import write_run_report
    from twin.run.run import Run
    from twin.tool_library import LibraryTool, ToolCylinder, ToolLibrary, read_tool_library
    from twin.verification.settings import VerifySettings
    from twin.verification.verification import Verification, verify
    from twin.version import __version__
    from twin.workpiece.solids.mesh_file import write_mesh
    from twin.workpiece.to_mesh import SurfaceMesh

__all__ = [
    "ArchiveError",
    "Attachment",
    "Collision",
    "CollisionError",
    "CompareError",
    "CompareSettings",
    "Comparison",
    "CutsError",
    "DraftSettings",
    "Engagement",
    "ForceLog",
    "ForceSamples",
    "Identified",
    "IdentifyError",
    "Job",
    "JobDraft",
    "JobError",
    "LibraryTool",
    "LogReading",
    "Material",
    "MaterialError",
    "MeasuredError",
    "MeshError",
    "Mold",
    "MoldJob",
    "NcEvent",
    "PartReach",
    "PathSettings",
    "PlannedPath",
    "ReachSettings",
    "Record",
    "ReplayError",
    "Run",
    "RunHeader",
    "RunSummary",
    "SettingsError",
    "Step",
    "StockError",
    "SurfaceMesh",
    "ToolCylinder",
    "ToolError",
    "ToolLibrary",
    "ToolLibraryError",
    "ToolPathError",
    "ToolRecord",
    "ToolSummary",
    "TwinError",
    "Verification",
    "VerifySettings",
    "WorkpiecePatch",
    "__version__",
    "compare",
    "draft_job",
    "find_material",
    "identify",
    "job_from_dict",
    "load_job",
    "load_materials",
    "load_mold",
    "mold",
    "open_run",
    "plan_paths",
    "reach",
    "read_log",
    "read_tool_library",
    "records",
    "replay",
    "verify",
    "write_coefficients",
    "write_mesh",
    "write_paths",
    "write_report",
    "write_run_report",
]

#: Modules of the public names.
_HOMES = {
    "twin.api": (
        *("compare", "identify", "open_run", "read_log", "records", "replay", "write_coefficients", "write_report"),
    ),
    "twin.comparison.comparison": ("Comparison",),
    "twin.drafting.draft": ("JobDraft", "draft_job"),
    "twin.drafting.settings": ("DraftSettings",),
    "twin.errors": (
        *("ArchiveError", "CollisionError", "CompareError", "CutsError", "IdentifyError", "JobError", "MaterialError"),
        *("MeasuredError", "MeshError", "ReplayError", "SettingsError", "StockError", "ToolError", "ToolLibraryError"),
        *("ToolPathError", "TwinError"),
    ),
    "twin.identification.result": ("Identified",),
    "twin.job": ("Job", "job_from_dict", "load_job"),
    "twin.materials": ("Material", "find_material", "load_materials"),
    "twin.measured.log": ("ForceLog",),
    "twin.measured.settings": ("CompareSettings", "LogReading"),
    "twin.moldmaking": ("Mold", "MoldJob", "load_mold", "mold"),
    "twin.planning.part_reach": ("PartReach", "reach"),
    "twin.planning.planned_path": ("PlannedPath", "plan_paths", "write_paths"),
    "twin.planning.settings": ("PathSettings", "ReachSettings"),
    "twin.record": (
        *("Attachment", "Collision", "Engagement", "ForceSamples", "NcEvent", "Record", "RunHeader", "RunSummary"),
        *("Step", "ToolRecord", "ToolSummary", "WorkpiecePatch"),
    ),
    "twin.report.page": ("write_run_report",),
    "twin.run.run": ("Run",),
    "twin.tool_library": ("LibraryTool", "ToolCylinder", "ToolLibrary", "read_tool_library"),
    "twin.verification.settings": ("VerifySettings",),
    "twin.verification.verification": ("Verification", "verify"),
    "twin.version": ("__version__",),
    "twin.workpiece.solids.mesh_file": ("write_mesh",),
    "twin.workpiece.to_mesh": ("SurfaceMesh",),
}
_HOME = {name: module for module, names in _HOMES.items() for name in names}


def __getattr__(name: str) -> Any:
    if name not in _HOME:
        raise AttributeError(f"module 'twin' has no attribute {name!r}")
    value = getattr(import_module(_HOME[name]), name)
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    return sorted({*globals(), *__all__})
