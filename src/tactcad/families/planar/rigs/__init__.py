"""Rigs of planar designs: the array, its bonding, and its calibration along z, x and y."""
