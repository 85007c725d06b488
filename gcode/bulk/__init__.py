"""Runs of plain G0/G1 lines as arrays, and all motions of a program as arrays."""
