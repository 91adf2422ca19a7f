"""Rigs of planar designs: the array, and its calibration along z, x and y."""
