"""How a part is described: contour, features, limits, materials, threads and fits; findings about it."""
