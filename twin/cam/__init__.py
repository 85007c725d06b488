"""Computer-aided manufacturing on slices: offsets, tool paths, what a tool cannot reach."""
