"""Standard parts: sizes from their standards, as part descriptions."""
