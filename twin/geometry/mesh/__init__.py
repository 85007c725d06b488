"""Triangle meshes: sections by planes, nearest points."""
