"""What the program's exit code says."""

#: All went well.
OK = 0
#: A program has mistakes, which messages name.
MISTAKES = 1
#: Arguments that make no command, or a file that could not be used.
USAGE = 2
#: Ended by a signal: this plus its number, so 130 for Ctrl-C.
SIGNAL = 128
