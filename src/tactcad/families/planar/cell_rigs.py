"""Rigs of planar designs: the array, its bonding, and its calibration by weights along z, x and y."""

from .cell_array import RIG as ARRAY
from .cell_bonding import RIG as BONDING
from .cell_cradle_scene import rig

RIGS = (ARRAY, BONDING, rig("z"), rig("x"), rig("y"))
