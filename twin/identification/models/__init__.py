"""Models: forces of a test cut for unit coefficients."""
