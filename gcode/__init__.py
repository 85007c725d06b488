"""NC programs to typed events and back. Knows nothing of `twin`."""
