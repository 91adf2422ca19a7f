"""Bonding of foot plates, posts and magnets to the foil."""

from ..cell_bonding import RIG as RIG
