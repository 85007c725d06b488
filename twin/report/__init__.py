"""The report of a run: one page with its forces, worst positions, collisions, warnings and assumptions."""
