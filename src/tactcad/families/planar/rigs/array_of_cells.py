"""The array of cells: the sensor itself."""

from ..cell_array import RIG as RIG
