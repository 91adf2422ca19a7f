"""Standard parts: sizes from their standards (CSV in data/), as part descriptions."""
