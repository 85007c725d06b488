"""The course of a program: its lines in order, jumps, loops, subprograms and macros, and the step of one block."""
