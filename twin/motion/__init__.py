"""Tool motion in the workpiece frame, and what it sweeps."""
