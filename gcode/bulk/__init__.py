"""Runs of plain G0/G1 lines, read and executed at once with array arithmetic."""
