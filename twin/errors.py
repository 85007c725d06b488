"""The one error root of the package."""

from __future__ import annotations


class TwinError(Exception):
    """An error that the user can correct: one message that names file or key, line, value and what was expected."""


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
    """A stock that has no extent, or cannot be sliced at the requested pitch."""


class MeshError(TwinError):
    """A triangle mesh that is not a closed solid, or a file that is not a mesh."""


class ToolError(TwinError):
    """A tool whose shape or edge cannot be built."""


class ToolLibraryError(TwinError):
    """A tool library that cannot be read, or a tool that is not in it or cannot be simulated."""


class ToolPathError(TwinError):
    """A tool path that cannot be planned or written: wrong parameters, an empty path, or a file."""


class ArchiveError(TwinError):
    """An archive or recording of a run that cannot be read or written."""


class ReplayError(TwinError):
    """An NC program that cannot be replayed with this job; the message names the NC line."""


class CollisionError(ReplayError):
    """A collision in a strict replay; the message names NC line, tool and position."""


class MeasuredError(TwinError):
    """A measured log that cannot be read, or lacks what is requested of it."""


class CompareError(TwinError):
    """A run and a log that cannot be compared."""


class CutsError(JobError):
    """A file of test cuts that cannot be used."""


class IdentifyError(TwinError):
    """Test cuts from which no coefficients can be identified."""


class MaterialError(TwinError):
    """A material that the table of cutting coefficients does not have; the message has the nearest names."""
