"""Calibration: weights along y."""

from ..cell_cradle_scene import rig

RIG = rig("y")
