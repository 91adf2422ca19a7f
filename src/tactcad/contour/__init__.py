"""Lines, arcs and closed contours in mm, from which every output is made.

In: exact points, radii, corners. Out: contours, their area and moments, cuts, distances, all in
closed form.
"""

from .contour import Contour, Corner, chain, circle, rectangle, rounded_polygon
from .segment import LEAST_EDGE, Arc, Line, Point, Segment, is_sliver

__all__ = [
    "LEAST_EDGE",
    "Arc",
    "Contour",
    "Corner",
    "Line",
    "Point",
    "Segment",
    "chain",
    "circle",
    "is_sliver",
    "rectangle",
    "rounded_polygon",
]
