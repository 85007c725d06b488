"""Tool paths from slices: passes, links, arcs, and the way to an NC program."""
