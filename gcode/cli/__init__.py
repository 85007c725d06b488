"""The command line: ``gcode check``, ``motions``, ``stats``, ``plot``, ``rewrite``.

Results go to standard output, everything else to standard error. Heavy modules are imported inside the commands, so
that ``gcode --help`` answers at once.
"""

from __future__ import annotations

import os
from collections.abc import Sequence

from gcode.cli.signals import end_at_once

__all__ = ["main", "run"]


def main() -> None:
    """The console script."""
    end_at_once()
    # No command does linear algebra, and starting the threads for it is a fifth of the start of a short command.
    os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
    from gcode.cli.entry import console_script

    console_script(run)


def run(arguments: Sequence[str]) -> int:
    """Carries out a command line; see `gcode.cli.entry.run`."""
    from gcode.cli.entry import run as carry_out

    return carry_out(arguments)
