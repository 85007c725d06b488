"""Exit codes of the program; `twin` has the same, and 3 and 4 besides for collisions and tolerances."""

#: Done; of a check: no errors.
OK = 0
#: An input has an error, or the work failed; the message on standard error says which and why.
ERROR = 1
#: Wrong use of the command line: an unknown option, a value out of range, a file that does not exist.
USAGE = 2
#: Ended by a signal: this plus its number, so 130 for Ctrl-C and 141 for a closed pipe.
SIGNAL = 128
