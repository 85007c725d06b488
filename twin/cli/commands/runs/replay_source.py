"""The job that a command replays: that of a job file, or one drafted from an NC program."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from twin.cli.console import note, warn
from twin.cli.options import settings_from
from twin.cli.show.draft_notes import assumption_objects, print_notes, print_written
from twin.drafting.draft import draft_job
from twin.drafting.settings import DraftSettings
from twin.drafting.update import write_draft
from twin.errors import SettingsError
from twin.job import Job, load_job
from twin.settings.file_kinds import is_nc_program

#: Options that a job file has keys for.
_DRAFT_ONLY = {"tools": "--tools", "stock": "--stock", "margin_mm": "--margin"}


@dataclass(frozen=True, slots=True, kw_only=True)
class Source:
    """Source of a replay: a job file or an NC program, and the job.

    Attributes:
        file: the file that was named on the command line.
        job: the job.
        key: the file by which outputs of this job are recognised.
        assumed: keys for the command's JSON object.
    """

    file: Path
    job: Job
    key: Path
    assumed: dict[str, Any] = field(default_factory=dict)


def source_of(file: Path, given: Mapping[str, Any], save_job: Path | None, *, quiet: bool) -> Source:
    """The job of a job file or an NC program, with the options in place of its values.

    Args:
        given: values of `DraftSettings` by key.
        save_job: where the job of an NC program is to be written; a file that exists keeps its values.
        quiet: print warnings only.

    Raises:
        TwinError, GcodeError: a file or option that cannot be used.
    """
    if is_nc_program(file):
        return _drafted(file, given, save_job, quiet=quiet)
    wrong = [option for key, option in _DRAFT_ONLY.items() if key in given]
    wrong += ["--save-job"] if save_job is not None else []
    if wrong:
        named = " and ".join(wrong)
        raise SettingsError("twin replay", [f"{named}: expected only with an NC program; {file} is a job file"])
    return Source(file=file, job=_with_options(load_job(file), given, quiet=quiet), key=file)


def _with_options(job: Job, given: Mapping[str, Any], *, quiet: bool) -> Job:
    """A job with options in place of its values."""
    names = {"pitch_mm": "slice_pitch_mm", "angle_step_deg": "angle_step_deg"}
    fineness = {names[key]: given[key] for key in names if key in given}
    job = job.with_simulation(**fineness) if fineness else job
    job = _with_material(job, given["material"], quiet=quiet) if "material" in given else job
    values = {key: given[key] for key in ("dialect", "tool") if key in given}
    if "m_codes" in given:
        values["m_codes"] = {**job.program.m_codes, **dict.fromkeys(given["m_codes"], "none")}
    return job.with_program(**values)


def _with_material(job: Job, name: str, *, quiet: bool) -> Job:
    """The job with a material's coefficients, and a note where they replace others."""
    changed = job.with_material(name)
    if job.forces and not quiet:
        material = changed.cutting.material if changed.cutting is not None else name
        note(f"--material: the coefficients of {material} replace those of the job")
    return changed


def _drafted(file: Path, given: Mapping[str, Any], save_job: Path | None, *, quiet: bool) -> Source:
    settings = settings_from(DraftSettings, given, {}, "twin replay", "twin replay")
    draft = draft_job(file, settings, path=save_job)
    job = draft.job()
    written = None
    if save_job is not None:
        written = write_draft(draft)
        job = load_job(save_job)
    elif draft.path.is_file():
        warn(f"{draft.path} exists and is not used; replay it with: twin replay {draft.path}")
    print_notes(draft, quiet=quiet)
    if written is not None:
        print_written(written, quiet=quiet)
    assumed = {
        "stated": list(draft.stated),
        "assumptions": assumption_objects(draft),
        "open": list(draft.open),
        "doubts": list(draft.warnings),
    }
    return Source(file=file, job=job, key=job.path if job.path.is_file() else file, assumed=assumed)
