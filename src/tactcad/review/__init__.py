"""Reviewing a design: what changed, and what it means."""
