"""The control's state as frozen values: modes, frames, variables, the table of modal groups."""
