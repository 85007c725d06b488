"""Polygons and lines on planes, by pyclipper and GEOS."""
