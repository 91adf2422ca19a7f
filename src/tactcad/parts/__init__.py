"""Parts made and bought: from parameters to contour, features and limits, without a CAD kernel.

In: a design. Out: its layout (the places of all parts), the rules that it must keep, and parts.
"""
