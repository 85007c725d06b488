"""Tool paths: where a tool may go over a surface, and what it leaves."""
