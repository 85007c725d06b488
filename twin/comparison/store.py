"""A comparison into its MCAP file, next to the run."""

from __future__ import annotations

from pathlib import Path

from twin.archive.comparison_file import ComparedForces, write_comparison
from twin.archive.schemas import LIBRARY
from twin.comparison.as_json import comparison_object
from twin.comparison.comparison import Comparison


def archive_path(run: Path, measured: Path) -> Path:
    """File of a comparison: ``slot.ap1.compare.mcap`` next to ``slot.mcap``, for a log ``ap1.csv``."""
    return run.with_name(f"{run.stem}.{measured.stem}.compare.mcap")


def compared_forces(found: Comparison) -> ComparedForces:
    """Both forces at the log's samples inside the overlap."""
    return ComparedForces(
        t_s=found.t_s,
        spindle_angle_rad=found.run.angle_at(found.t_s),
        measured_n=found.measured_n,
        simulated_n=found.simulated_n,
    )


def archive(found: Comparison, path: Path | None = None) -> Path:
    """Write the file; an earlier comparison of that name is replaced.

    Raises:
        ArchiveError: it cannot be written.
    """
    target = path or archive_path(found.run.path, found.log.source)
    heads = {
        "run": found.run.path.name,
        "run_digest": found.run.digest,
        "measured": found.log.source.name,
        "lag_s": repr(found.lag_s),
        "correlation": f"{found.score:.6f}",
        "corrections": "\n".join(c.text for c in found.corrections),
    }
    library = f"{LIBRARY} {found.run.header.twin_version}"
    write_comparison(target, compared_forces(found), comparison_object(found), heads, library, force=True)
    return target
