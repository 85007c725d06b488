"""The one error root of the package."""

from __future__ import annotations


class TwinError(Exception):
    """A mistake that the user can mend: one message that names file or key, place, value and what was expected."""


class SettingsError(TwinError):
    """Settings that cannot be used.

    Attributes:
        file: the file, or the name of what else holds the settings.
        problems: every mistake found, one line each.
    """

    def __init__(self, file: str, problems: list[str]) -> None:
        self.file = file
        self.problems = problems
        super().__init__("\n".join(f"{file}: {p}" for p in problems))


class JobError(SettingsError):
    """A job file that cannot be used."""


class StockError(TwinError):
    """A stock that has no extent, or cannot be sliced at the pitch asked for."""


class MeshError(TwinError):
    """A triangle mesh that is no solid, or a file that is no mesh."""


class ToolError(TwinError):
    """A tool whose shape or edge cannot be built."""


class ToolPathError(TwinError):
    """A tool path that cannot be made, or written: wrong parameters, an empty one, or a file."""


class ArchiveError(TwinError):
    """A run's file that cannot be written or read."""


class ReplayError(TwinError):
    """A program that cannot be replayed on this job: the message names the NC line."""


class CollisionError(ReplayError):
    """A collision in a strict replay."""


class MeasuredError(TwinError):
    """A measured log that cannot be read, or does not say what is asked of it."""


class CompareError(TwinError):
    """A run and a log that cannot be compared."""


class CutsError(JobError):
    """A file of test cuts that cannot be used."""


class IdentifyError(TwinError):
    """Test cuts that no coefficients can be found from."""
