"""Bought parts of the rigs as envelopes with their interfaces. No maker's drawing was read for them:
dimensions are of the usual kind of each, and `source_verified` stays false until one is.
"""

from __future__ import annotations

from tactcad.contour import chain, circle, rectangle

from ..description import Extrusion, Hole, Material, Part, Pocket, Purchase, Revolution
from ..library.screws import METRIC
from .holes import sunk, tapped
from .layout import (
    CARRIAGE_LENGTH,
    GAUGE_SHAFT,
    GAUGE_SIZE,
    PLATE_SCREW,
    RAIL_HEIGHT,
    STAGE,
    STAGE_HOLE,
    STAGE_PLATE,
    RigLayout,
)

ALUMINIUM = Material("aluminium", 2700)
STEEL = Material("steel", 7850)
PIN = 8.0  # of the weight platform, mm
SHAFT = 6.0  # M6
FITTING_RADIUS = 4.0  # the hose fitting's shoulder
BRASS = Material("brass, nickel plated", 8500)
GAUGE_THREADS = (-20.0, 20.0)  # of the gauge's back, from the middle of its plate, mm


def force_gauge(rig: RigLayout) -> Part:
    """Digital force gauge, shaft down: (x, y) the scene's, z = 0 the shaft's end, z = 10 the housing's lower face."""
    w, deep, high = GAUGE_SIZE
    c = rig.design.calibration
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
            alternates="any gauge of that range; enter its measured stiffness in calibration.load_cell_stiffness",
        ),
        mass_override=640.0,
    )


def stage_fixed(travel: float) -> Part:
    """Fixed half of a micro-stage: back at z = 0, slideway at the top; screws enter from the slideway's side."""
    half, t = STAGE / 2, STAGE_PLATE
    thread, _, under = PLATE_SCREW
    holes = tuple(
        sunk("mount", thread, (sx * STAGE_HOLE, sy * STAGE_HOLE, t), (0, 0, -1), t, under)
        for sx in (-1, 1)
        for sy in (-1, 1)
    )
    return Part(
        part_no=f"STAGE-{STAGE:g}-{2 * travel:g}-FIXED",
        name=f"Micro-stage {STAGE:g} x {STAGE:g}, fixed half",
        process="bought",
        material=ALUMINIUM,
        body=Extrusion(rectangle(-half, -half, half, half), t),
        features=holes,
        colour="#3f4650",
        purchase=Purchase(
            f"crossed roller stage {STAGE:g} x {STAGE:g} x {2 * t:g} mm, travel +-{travel:g} mm, M4 at {2 * STAGE_HOLE:g} x {2 * STAGE_HOLE:g}",
            alternates="any stage of that travel and hole pattern",
        ),
    )


def stage_moving(travel: float) -> Part:
    """Moving half: slideway at z = 0, threads from the face at the top."""
    half, t = STAGE / 2, STAGE_PLATE
    threads = tuple(
        tapped("mount", "M4", (sx * STAGE_HOLE, sy * STAGE_HOLE, t), (0, 0, -1), t)
        for sx in (-1, 1)
        for sy in (-1, 1)
    )
    return Part(
        part_no=f"STAGE-{STAGE:g}-{2 * travel:g}-MOVING",
        name=f"Micro-stage {STAGE:g} x {STAGE:g}, moving half",
        process="bought",
        material=ALUMINIUM,
        body=Extrusion(rectangle(-half, -half, half, half), t),
        features=threads,
        colour="#59626e",
        purchase=Purchase("moving half, comes with the fixed half", alternates="as the fixed half"),
    )


def micrometer(travel: float, resolution: float) -> Part:
    """Micrometer head on a stage's fixed half, as an envelope: axis z, from z = 0 outwards."""
    return Part(
        part_no=f"MICROMETER-{2 * travel:g}-{resolution:g}-head",
        name=f"Micrometer head {2 * travel:g} mm, {resolution:g} mm",
        process="bought",
        material=STEEL,
        body=Revolution(chain([(0, 0), (3.0, 0), (3.0, 18.0), (4.5, 18.0), (4.5, 45.0), (0, 45.0)])),
        colour="#8a8d91",
        purchase=Purchase(
            f"micrometer head, travel {2 * travel:g} mm, resolution {resolution:g} mm, for the stage",
            manufacturer="OptoSigma" if resolution < 0.005 else "",
            alternates="motorised actuator of the same travel",
        ),
    )


def rail(length: float) -> Part:
    """Miniature guide rail, width 9: local z out of its mounting face, y along it, holes 20 apart."""
    half = length / 2
    holes = tuple(
        Hole("mount", (0, y, 6.5), (0, 0, -1), 3.5, 6.5, True, counterbore=(6.0, 3.5))
        for y in rail_holes(length)
    )
    return Part(
        part_no=f"RAIL-9x{length:g}-guide",
        name=f"Guide rail 9, {length:g} long",
        process="bought",
        material=STEEL,
        body=Extrusion(rectangle(-4.5, -half, 4.5, half), 6.5),
        features=holes,
        colour="#6f7378",
        purchase=Purchase(
            f"miniature guide rail, width 9, length {length:g}, holes M3 at 20", alternates="MGN9R and alike"
        ),
    )


def rail_holes(length: float) -> tuple[float, ...]:
    """Along the rail from its middle, mm: 20 apart, half a pitch from the ends."""
    count = round(length / 20.0)
    return tuple(20.0 * (i - (count - 1) / 2) for i in range(count))


def carriage() -> Part:
    """The rail's carriage, ends without seals: section in (x, y) with y out of the rail's mounting face,
    extruded along the rail."""
    section = chain(
        [
            (-10, 2.2),
            (-4.5, 2.2),
            (-4.5, 6.5),
            (4.5, 6.5),
            (4.5, 2.2),
            (10, 2.2),
            (10, RAIL_HEIGHT),
            (-10, RAIL_HEIGHT),
        ]
    )
    threads = tuple(
        Hole(
            "mount",
            (sx * 7.5, RAIL_HEIGHT, CARRIAGE_LENGTH / 2 + sy * 5.0),
            (0, -1, 0),
            2.5,
            3.0,
            False,
            thread="M3",
            thread_depth=3.0,
        )
        for sx in (-1, 1)
        for sy in (-1, 1)
    )
    return Part(
        part_no="CARRIAGE-9-UNSEALED",
        name="Guide carriage 9, without seals",
        process="bought",
        material=STEEL,
        body=Extrusion(section, CARRIAGE_LENGTH),
        features=threads,
        colour="#50575f",
        notes=("seals taken off: they drag 0.1 to 0.5 N",),
        purchase=Purchase(
            "miniature guide carriage for rail width 9, no seals, light clearance (Z0), 4 x M3 at 15 x 10",
            alternates="MGN9C and alike",
        ),
        mass_override=16.0,
    )


def disc_weight(rig: RigLayout) -> Part:
    """One added weight: a steel disc on the platform's pin; its height follows from its mass."""
    diameter = rig.design.grasping.weight_diameter
    outer, bore = circle((0, 0), diameter), circle((0, 0), PIN + 0.5)
    height = round(rig.weight_mass / ((outer.area - bore.area) * STEEL.density * 1e-6), 3)
    return Part(
        part_no=f"WEIGHT-{rig.weight_mass:.4g}g-{diameter:g}-disc",
        name=f"Disc weight {rig.weight_mass:.4g} g",
        process="bought",
        material=STEEL,
        body=Extrusion(outer, height, (bore,)),
        colour="#c9a227",
        purchase=Purchase(
            f"disc weight {rig.weight_mass:.4g} g, bore {PIN + 0.5:g}, diameter {diameter:g}, checked on a balance to 0.1 g",
            alternates="slotted weights of the same mass",
        ),
        mass_override=rig.weight_mass,
    )


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
