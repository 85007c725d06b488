"""Commands about measured logs: comparison, identification."""
