"""Lines, arcs and closed contours in mm: the truth that every output is made from."""

from .contour import Contour, chain, circle, rectangle
from .rounded import Corner, rounded_polygon
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
