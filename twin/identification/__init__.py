"""Cutting coefficients out of test cuts (docs/identify.md)."""
