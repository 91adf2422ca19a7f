"""The cells' pads on an object: round pads, taken as squares of their area."""

from __future__ import annotations

from math import pi

import numpy as np

from tactcad.contact.press import Pads

from .cell_layout import PlanarLayout
from .cell_tables import PlanarDesign
from .parts import POST_TOLERANCE
from .sensor import chip_matrix, closing_force, pad_compliance


def side(design: PlanarDesign) -> float:
    """Side of a square with a pad's area, mm: K_obj is up to 1.5 % above a disc's (tests), of all pads
    alike."""
    return design.post.pad * pi**0.5 / 2.0


def places(design: PlanarDesign) -> tuple[np.ndarray, np.ndarray, np.ndarray, float, float]:
    """x, y and number of every pad, and all pads' length and width, mm."""
    at = PlanarLayout(design).elements
    x, y = (np.array([getattr(e, axis) for e in at]) for axis in "xy")
    return x, y, np.array([e.number for e in at]), side(design), side(design)


def springs(design: PlanarDesign) -> tuple[Pads, np.ndarray]:
    """The pads on their cells, and the field of each over its pad's sink, mT/mm.

    A force at a pad's middle sinks it straight: only moments tip it, which are small on a flat face and are
    neglected. The stop closes at the end of the island's travel.
    """
    layout = PlanarLayout(design)
    x, y, _, length, width = places(design)
    compliance, stop, signal = np.zeros((len(x), 3, 3)), np.empty(len(x)), np.empty(len(x))
    for kind in layout.used:
        own = np.array([e.kind.name == kind.name for e in layout.elements])
        sink = pad_compliance(kind, layout.pad_height)[2, 2]
        compliance[own, 0, 0] = sink
        stop[own] = closing_force(layout, kind) * sink
        signal[own] = abs(chip_matrix(layout, kind)[2, 2]) / sink
    return Pads(x, y, length, width, compliance, np.zeros(len(x)), stop), signal


def limit(_design: PlanarDesign) -> float:
    """Largest height of the pads above or below their plane, mm: by their posts' lengths."""
    return POST_TOLERANCE
