"""Tri-slice geometry of planning: sections of a part, 3D offsets, cutter-location lines."""
