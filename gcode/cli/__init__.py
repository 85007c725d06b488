"""The command line: ``gcode check``, ``motions``, ``stats``, ``plot``, ``rewrite``.

Results go to standard output, everything else to standard error. Heavy modules are imported inside the commands, so
that ``gcode --help`` answers at once.
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
    """Carries out a command line; see `gcode.cli.entry.run`."""
    from gcode.cli.entry import run as carry_out

    return carry_out(arguments)
