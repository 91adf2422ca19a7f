"""Checks of solids, made by the CAD kernel."""
