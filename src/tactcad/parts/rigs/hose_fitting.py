r"""Barbed hose fitting, bought: thread below z = 0, shoulder and barb above.

       /\
      |  |  barb
   +--+  +--+
   +--+  +--+  z = 0: shoulder
      |  |  M5
"""

from __future__ import annotations

from tactcad.contour import chain

from ..description import Part, Purchase, Revolution
from ..part_materials import BRASS

FITTING_RADIUS = 4.0  # the hose fitting's shoulder


def hose_fitting() -> Part:
    """Barbed fitting M5 for soft hose of 4 mm bore: axis z, thread below z = 0, shoulder at z = 0."""
    profile = chain(
        [
            (1.2, -4.0),
            (2.5, -4.0),
            (2.5, 0),
            (FITTING_RADIUS, 0),
            (FITTING_RADIUS, 5.0),
            (2.0, 5.0),
            (2.5, 9.0),
            (2.0, 13.0),
            (1.2, 13.0),
        ]
    )
    return Part(
        part_no="FITTING-M5-HOSE4-barb",
        name="Hose fitting M5, barb for 4 mm",
        process="bought",
        material=BRASS,
        body=Revolution(profile),
        colour="#c2b280",
        purchase=Purchase(
            "barbed hose fitting M5, hose bore 4 mm, with sealing washer",
            alternates="push-in fitting M5 for tube 4 mm",
        ),
    )
