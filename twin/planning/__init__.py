"""Flow B: from a part and a tool to a tool path, an NC program, and a job file that replays it."""
