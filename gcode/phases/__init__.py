"""What a block does, one module a phase: modes, offsets, targets, arcs, cycles, compensation."""
