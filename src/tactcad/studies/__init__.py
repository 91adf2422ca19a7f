"""Published data, validation, fits, speed against accuracy."""
