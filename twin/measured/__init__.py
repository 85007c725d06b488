"""Measured force logs: files in, axes mapped, corrections made one by one, each on record (docs/measured-logs.md)."""
