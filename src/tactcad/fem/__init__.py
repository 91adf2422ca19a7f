"""Plane and solid finite elements on the mesh of the part's own contour.

In: a contour cut at clamp edge and load line, or a `HingeSection`. Out: stiffness with its error, surface
strains.
"""
