"""Engagement and forces."""
