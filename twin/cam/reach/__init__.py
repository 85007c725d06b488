"""What tools can reach, and what they leave: volume, thickness, location."""
