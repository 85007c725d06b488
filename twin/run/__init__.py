"""A run as a result: forces as arrays, summary, events, the machined part, a picture for notebooks."""
