"""Sheets of parts: a plan of views and dimensions, composed on paper, read back and compared."""
