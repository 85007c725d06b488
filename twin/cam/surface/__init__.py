"""A part's triangles seen from above: drop-cutter, surface normals."""
