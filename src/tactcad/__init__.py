"""From one text file to a tactile array that a shop can cut and numbers that say how stiff it is.

Units throughout: mm, N, MPa; stiffness in N/mm, strain as a plain ratio, angles in radians.
"""

__version__ = "0.1.0"
