"""Rigs of planar designs: the array of cells, its bonding, its calibration by weights along z, x and y."""

from __future__ import annotations

from . import cell_array, cell_bonding
from .cell_cradle_scene import rig

RIGS = (cell_array.RIG, cell_bonding.RIG, rig("z"), rig("x"), rig("y"))
