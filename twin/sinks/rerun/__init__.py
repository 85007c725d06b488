"""The timeline in rerun: scene, blueprint, batches, recordings."""
