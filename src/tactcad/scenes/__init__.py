"""Placements: which parts stand where, under which designator, with which meant contacts."""
