"""Replay of a job (flow A): setup, spindle clock, material, engagement and forces of steps, records, totals."""
