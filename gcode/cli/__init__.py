"""The command line: ``gcode check``, ``motions``, ``stats``, ``plot``, ``rewrite``.

Results go to standard output, everything else to standard error. Heavy modules are imported inside the commands, so
that ``gcode --help`` answers at once.
"""

from gcode.cli.entry import main, run

__all__ = ["main", "run"]
