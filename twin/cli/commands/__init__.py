"""One module a command of `twin`."""
