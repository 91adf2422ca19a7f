"""Checks of a design and of parts as they are described: no CAD kernel."""
