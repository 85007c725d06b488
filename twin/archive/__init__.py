"""Runs in MCAP files; the only door to the mcap and protobuf libraries."""
