"""The parts of a replay: what the job sets up, the spindle's clock, the totals of a run."""
