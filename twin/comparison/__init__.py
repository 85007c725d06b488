"""A run and a measured log laid over each other (docs/compare.md)."""
