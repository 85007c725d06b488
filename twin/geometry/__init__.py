"""Polygons on planes and the stores of slices; the numba kernels."""
