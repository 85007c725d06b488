"""Which block comes next: subprograms, macros, jumps, loops, and the step of one block."""
