"""How results are shown: tables, progress, JSON, pictures."""
