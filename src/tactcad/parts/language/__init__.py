"""The description of parts: contour, features, limits, materials, threads and fits; findings about it."""
