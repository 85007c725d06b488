"""Polygons on parallel planes as column cells: filling, cutting, queries."""
