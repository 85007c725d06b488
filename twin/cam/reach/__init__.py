"""Reach of tools: the material that they leave uncut, by volume, thickness and position."""
