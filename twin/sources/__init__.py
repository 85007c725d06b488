"""Where records and measured logs come from."""
