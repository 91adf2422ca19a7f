"""Calibration: weights straight down on a pad."""

from ..cell_cradle_scene import rig

RIG = rig("z")
