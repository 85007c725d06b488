"""The measured log of a run's job: its ``[measured]`` table and its file."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from twin.archive import run_info
from twin.settings.toml_file import parse_toml


def job_measured(run: Path) -> tuple[dict[str, Any], Path | None]:
    """The ``[measured]`` table of the job file that a run's archive holds, less its file; and the file.

    The file is the one that the job names, else one of that name next to the run or in the folder above.

    Raises:
        ArchiveError: see `twin.archive.run_info`.
        SettingsError: the job file in the archive is not TOML.
    """
    header = run_info(run).header
    job = next((a for a in header.attachments if a.media_type == "application/toml"), None)
    table = {} if job is None else parse_toml(job.data.decode("utf-8-sig"), f"{run}, {job.name}").get("measured", {})
    keys = {key: value for key, value in table.items() if key != "file"}
    if "file" not in table:
        return keys, None
    stated = Path(header.parameters.get("measured.file", table["file"]))
    candidates = (stated, run.parent / stated.name, run.parent.parent / stated.name)
    return keys, next((path for path in candidates if path.is_file()), stated)
