"""Passes over a part: contours, scans, roughing, semi-finishing, finishing."""
