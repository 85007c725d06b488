"""Commands about parts: reach, tool paths, verification, molds."""
