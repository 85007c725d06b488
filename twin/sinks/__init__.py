"""Outputs of a run: archive files, the rerun viewer and its recordings."""
