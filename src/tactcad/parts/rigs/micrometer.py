r"""Micrometer head of a stage, bought, as an envelope about its axis.

    +-------------+
+---+   thimble   |   z ->
+---+             |
    +-------------+
z = 0 on the stage's fixed half
"""

from __future__ import annotations

from tactcad.contour import chain

from ..description import Part, Purchase, Revolution
from ..part_materials import CARBON_STEEL


def micrometer(travel: float, resolution: float) -> Part:
    """Micrometer head on a stage's fixed half, as an envelope: axis z, from z = 0 outwards."""
    return Part(
        part_no=f"MICROMETER-{2 * travel:g}-{resolution:g}-head",
        name=f"Micrometer head {2 * travel:g} mm, {resolution:g} mm",
        process="bought",
        material=CARBON_STEEL,
        body=Revolution(chain([(0, 0), (3.0, 0), (3.0, 18.0), (4.5, 18.0), (4.5, 45.0), (0, 45.0)])),
        colour="#8a8d91",
        purchase=Purchase(
            f"micrometer head, travel {2 * travel:g} mm, resolution {resolution:g} mm, for the stage",
            manufacturer="OptoSigma" if resolution < 0.005 else "",
            alternates="motorised actuator of the same travel",
        ),
    )
