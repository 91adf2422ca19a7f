"""One file a part: contour and features, without a CAD kernel."""
