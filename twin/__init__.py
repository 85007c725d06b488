"""A machining digital twin: replays NC programs, removes material, predicts cutting forces."""
