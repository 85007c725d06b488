"""Phases of the execution of a block: modes, offsets, transforms, motions (straight, arcs, cycles), compensation."""
