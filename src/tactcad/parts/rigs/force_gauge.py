r"""The digital force gauge, bought: housing with an M6 shaft, shaft down, two M4 threads in its back.

+-----------+
|  o     o  |    threads in the back, toward +y
|           |  ^ z
+----+ +----+  |
     | | shaft
     +-+         z = 0
"""

from __future__ import annotations

from tactcad.contour import circle, rectangle
from tactcad.design.present import present

from ..description import Extrusion, Hole, Part, Pocket, Purchase
from ..library.screws import METRIC
from ..part_materials import ALUMINIUM
from .frame import GAUGE_SHAFT, GAUGE_SIZE
from .stand_layout import StandLayout

SHAFT = 6.0  # M6
GAUGE_THREADS = (-20.0, 20.0)  # of the gauge's back, from the middle of its plate, mm


def force_gauge(rig: StandLayout) -> Part:
    """Digital force gauge, shaft down: (x, y) the scene's, z = 0 the shaft's end, z = 10 the housing's lower
    face."""
    w, deep, high = GAUGE_SIZE
    c = present(rig.design.calibration)
    around = rectangle(-w / 2, -deep / 2, w / 2, deep / 2)
    shaft = Pocket(
        "around_shaft", (0, 0, 0), (0, 0, 1), (1, 0, 0), around, GAUGE_SHAFT, (circle((0, 0), SHAFT),)
    )
    threads = tuple(
        Hole(
            "mount",
            (0, deep / 2, GAUGE_SHAFT + 45.0 + z),
            (0, -1, 0),
            METRIC["M4"].tap_drill,
            9.0,
            False,
            thread="M4",
            thread_depth=8.0,
        )
        for z in GAUGE_THREADS
    )
    return Part(
        part_no=f"FORCE-GAUGE-{c.load_cell_range:g}N",
        name=f"Digital force gauge {c.load_cell_range:g} N",
        process="bought",
        material=ALUMINIUM,
        body=Extrusion(around, high + GAUGE_SHAFT),
        features=(shaft, *threads),
        colour="#d9b44a",
        purchase=Purchase(
            f"digital force gauge {c.load_cell_range:g} N, {c.load_cell_resolution:g} N, "
            f"{c.load_cell_stiffness:g} N/mm at its shaft, M6 shaft",
            manufacturer="Sauter",
            mpn="FH 5",
            alternates="any gauge of that range; enter its measured stiffness in "
            "calibration.load_cell_stiffness",
        ),
        mass_override=640.0,
    )
