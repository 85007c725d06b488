"""Runs of plain lines of motions, read and executed at once with array arithmetic."""
