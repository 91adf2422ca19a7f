"""What is made and bought: from parameters to contour, features and limits, without a CAD kernel.

In: a design. Out: its layout (where everything of the array stands), the rules that it must keep, and parts.
"""
