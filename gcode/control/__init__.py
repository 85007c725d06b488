"""The state of the control: modes, coordinate frames, offsets, variables, waiting motions; and a block as a command."""
