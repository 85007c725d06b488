"""The machined part against the design: gouges, excess, where and how much."""
