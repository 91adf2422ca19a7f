"""Drawing sheets: paper, primitives, dimensions, views and their checks; written as SVG and PDF."""
