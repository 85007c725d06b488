"""Exit codes of the program; the first three and those of signals are `gcode`'s."""

from gcode.cli.exit_codes import ERROR, OK, SIGNAL, USAGE

#: A strict replay ended at a collision.
COLLISION = 3
#: The machined part, or a measurement, is out of tolerance.
OUT_OF_TOLERANCE = 4

__all__ = ["COLLISION", "ERROR", "OK", "OUT_OF_TOLERANCE", "SIGNAL", "USAGE"]
