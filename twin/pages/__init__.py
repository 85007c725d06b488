"""Pages of results: HTML in one file with its pictures inside, and the style of the pictures."""
