"""Reviewing a design: all its facts as a page and in FreeCAD; what changed, and what that means."""
