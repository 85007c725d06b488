"""Stock in planning: dexels, strokes of tools over them, rest material."""
