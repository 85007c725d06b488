"""What the program's exit code says."""

#: All went well; collisions may have been reported.
OK = 0
#: A mistake that the message on standard error names.
ERROR = 1
#: Arguments that make no command.
USAGE = 2
#: A strict replay ended at a collision.
COLLISION = 3
#: What was machined, or measured, is out of tolerance.
OUT_OF_TOLERANCE = 4
#: Ended by a signal: this plus its number, so 130 for Ctrl-C.
SIGNAL = 128
