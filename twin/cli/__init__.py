"""The command line: ``twin replay``, ``view``, ``info``, ``export``, ``mesh``, ``schema``.

Results go to standard output, everything else to standard error. What is heavy is imported inside the commands, so
that ``twin --help`` answers at once.
"""

from twin.cli.run import main, run

__all__ = ["main", "run"]
