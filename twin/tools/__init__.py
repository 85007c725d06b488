"""Tool shapes by their meridian, and the points of their cutting edges."""
