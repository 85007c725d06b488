"""The command line: ``twin replay``, ``view``, ``info``, ``export``, ``mesh``, ``schema``.

Results go to standard output, everything else to standard error. What is heavy is imported inside the commands, so
that ``twin --help`` answers at once.
"""

from __future__ import annotations

from collections.abc import Sequence

from gcode.cli.signals import end_at_once

__all__ = ["main", "run"]


def main() -> None:
    """The console script."""
    end_at_once()
    from gcode.cli.entry import console_script

    console_script(run)


def run(arguments: Sequence[str]) -> int:
    """Carry out a command line; see `twin.cli.entry.run`."""
    from twin.cli.entry import run as carry_out

    return carry_out(arguments)
