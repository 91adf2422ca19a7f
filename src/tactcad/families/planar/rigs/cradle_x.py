"""Calibration: weights along x."""

from ..cell_cradle_scene import rig

RIG = rig("x")
