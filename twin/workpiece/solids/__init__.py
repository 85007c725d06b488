"""Closed triangle meshes: STL files, their units, defects and seams, and the check that they are solids."""
