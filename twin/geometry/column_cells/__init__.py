"""Polygons on parallel planes as column cells: cut, filled, asked."""
