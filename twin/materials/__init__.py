"""Cutting coefficients of materials, each with its source: `load_materials`, `find_material`."""

from twin.materials.library import find_material, load_materials
from twin.materials.material import Material

__all__ = ["Material", "find_material", "load_materials"]
