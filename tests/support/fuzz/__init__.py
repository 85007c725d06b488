"""Random mutations of every kind of input file, in a process of their own with bounded memory and time."""
