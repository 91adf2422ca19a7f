"""Plane and solid finite elements on the mesh of the part's own contour."""
