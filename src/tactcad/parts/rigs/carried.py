"""What moves with the array: calibration mount; foot, bar, weight platform, pin and ballast of the grasping axis."""

from __future__ import annotations

from math import ceil

from tactcad.contour import Contour, circle, rectangle

from ..description import Extrusion, Feature, Part
from ..library.screws import METRIC, tapped_depth
from .bought import PIN, disc_weight
from .bought import STEEL as WEIGHT_STEEL
from .cart import COLOUR, plate_alloy
from .holes import sunk, tapped_blind
from .layout import (
    BAR,
    BAR_FRONT,
    BAR_HEIGHT,
    BAR_WIDTH,
    BEHIND_BAR,
    CARRIAGE_ON_BAR,
    FOOT,
    PLATE,
    PLATE_SCREW,
    PLATFORM,
    STAGE,
    STAGE_HOLE,
    RigLayout,
)

# Screws into the carrier's threads end this far inside its far face, where the end plates lie.
SHORT_OF_CARRIER = 0.3
CARRIER_SCREW = 10.0
BAR_SCREW_X = 7.0
FOOT_UNDER_HEAD = 3.6  # of the bar's screws, heads sunk by 0.4
BAR_UNDER_HEAD = 5.3  # of the carriage's screws: 2.7 mm in its 3 mm of thread
PLATFORM_UNDER_HEAD = 3.5  # heads sunk by 0.5: the weights lie flat
BAR_MIDDLE = BAR_FRONT + BAR / 2


def under_carrier_screw(rig: RigLayout) -> float:
    """Plate left under the head of the 10 mm screw into the carrier's thread, mm."""
    return round(CARRIER_SCREW - (rig.design.clamp.carrier_thickness - SHORT_OF_CARRIER), 9)


def carrier_pattern(rig: RigLayout) -> tuple[tuple[float, float], ...]:
    """(x, y) of the carrier's threads for an axis."""
    x, y = rig.array.mount_x, rig.design.clamp.mount_pitch_y / 2
    return tuple((sx * x, sy * y) for sx in (-1, 1) for sy in (-1, 1))


def array_mount(rig: RigLayout) -> Part:
    """Plate on the upper stage that holds the array on its back. z = 0 is the stage's side."""
    thread, _, under = PLATE_SCREW
    x = max(rig.array.carrier_size[0] / 2, STAGE / 2)
    features: list[Feature] = [
        sunk("stage", thread, (sx * STAGE_HOLE, sy * STAGE_HOLE, PLATE), (0, 0, -1), PLATE, under)
        for sx in (-1, 1)
        for sy in (-1, 1)
    ]
    mount = rig.design.clamp.mount_thread
    features += [
        sunk("carrier", mount, (px, py, 0.0), (0, 0, 1), PLATE, under_carrier_screw(rig))
        for px, py in carrier_pattern(rig)
    ]
    return Part(
        part_no=f"{rig.design.name}-array-mount",
        name="Array mount",
        process="milled",
        material=plate_alloy(rig),
        body=Extrusion(rectangle(-x, -STAGE / 2, x, STAGE / 2), PLATE),
        features=tuple(features),
        colour=COLOUR,
        finish="Ra 1.6, faces parallel within 0.01",
        notes=("break edges 0.2",),
    )


def foot(rig: RigLayout) -> Part:
    """Plate on the array's carrier, with the bar at its back edge. z = 0 is the carrier's side."""
    x = round(max(rig.array.mount_x + METRIC[rig.design.clamp.mount_thread].head / 2, BAR_WIDTH / 2) + 2.0, 3)
    y = round(rig.design.clamp.mount_pitch_y / 2 + METRIC[rig.design.clamp.mount_thread].head / 2 + 2.0, 3)
    mount = rig.design.clamp.mount_thread
    features: list[Feature] = [
        sunk("carrier", mount, (px, py, FOOT), (0, 0, -1), FOOT, under_carrier_screw(rig))
        for px, py in carrier_pattern(rig)
    ]
    features += [
        sunk("bar", "M4", (sx * BAR_SCREW_X, BAR_MIDDLE, 0.0), (0, 0, 1), FOOT, FOOT_UNDER_HEAD)
        for sx in (-1, 1)
    ]
    return Part(
        part_no=f"{rig.design.name}-foot",
        name="Foot of the bar",
        process="milled",
        material=plate_alloy(rig),
        body=Extrusion(rectangle(-x, -y, x, max(y, BAR_FRONT + BAR + BEHIND_BAR)), FOOT),
        features=tuple(features),
        colour=COLOUR,
        finish="Ra 1.6, clear anodised after machining",
        notes=("break edges 0.2",),
    )


def bar(rig: RigLayout) -> Part:
    """Vertical bar on the carriage. Contour in (x, z), front face at local z = 0, lower end at y = 0."""
    features: list[Feature] = [
        sunk("carriage", "M3", (sx * 7.5, CARRIAGE_ON_BAR + sy * 5.0, 0.0), (0, 0, 1), BAR, BAR_UNDER_HEAD)
        for sx in (-1, 1)
        for sy in (-1, 1)
    ]
    for sx in (-1, 1):
        features.append(tapped_blind("foot", "M4", (sx * BAR_SCREW_X, 0.0, BAR / 2), (0, 1, 0)))
        features.append(tapped_blind("platform", "M4", (sx * BAR_SCREW_X, BAR_HEIGHT, BAR / 2), (0, -1, 0)))
    return Part(
        part_no=f"{rig.design.name}-bar",
        name="Bar",
        process="milled",
        material=plate_alloy(rig),
        body=Extrusion(rectangle(-BAR_WIDTH / 2, 0, BAR_WIDTH / 2, BAR_HEIGHT), BAR),
        features=tuple(features),
        colour="#7c8794",
        finish="Ra 1.6, back face and ends square within 0.02",
        notes=("break edges 0.2",),
    )


def platform(rig: RigLayout) -> Part:
    """Plate on the bar's upper end; the weights' pin stands over the array's middle. z = 0 is the underside."""
    half = rig.design.grasping.weight_diameter / 2
    features: list[Feature] = [
        sunk("bar", "M4", (sx * BAR_SCREW_X, BAR_MIDDLE, PLATFORM), (0, 0, -1), PLATFORM, PLATFORM_UNDER_HEAD)
        for sx in (-1, 1)
    ]
    features.append(sunk("pin", "M4", (0.0, 0.0, 0.0), (0, 0, 1), PLATFORM, PLATFORM_UNDER_HEAD))
    return Part(
        part_no=f"{rig.design.name}-platform",
        name="Weight platform",
        process="milled",
        material=plate_alloy(rig),
        body=Extrusion(
            rectangle(-BAR_WIDTH, -min(half, 20.0), BAR_WIDTH, BAR_FRONT + BAR + BEHIND_BAR), PLATFORM
        ),
        features=tuple(features),
        colour=COLOUR,
        finish="Ra 1.6, clear anodised after machining",
        notes=("break edges 0.2",),
    )


def pin(rig: RigLayout, under: float = 0.0) -> Part:
    """Pin that centres the weights, as high as their stack on `under` mm of ballast; M4 thread in its foot."""
    stack = round(rig.design.grasping.weights) * disc_weight(rig).body.thickness
    thread = tapped_depth("M4") + 1.0  # in its foot, and the floor over it
    height = 5.0 * ceil(max(stack + max(9.0, under + 1.0), thread) / 5.0)
    return Part(
        part_no=f"{rig.design.name}-weight-pin",
        name="Weight pin",
        process="turned",
        material=plate_alloy(rig),
        body=Extrusion(circle((0, 0), PIN), height),
        features=(tapped_blind("foot", "M4", (0, 0, 0), (0, 0, 1)),),
        colour="#9aa4ae",
        finish="Ra 1.6, top edge chamfered 0.5 by hand",
    )


def ballast(rig: RigLayout, mass: float) -> Part:
    """Disc under the weights that brings the moving mass to the paper's; `mass` in g, thickness to 0.01 mm."""
    outer, bore = _disc(rig)
    thickness = round(ballast_thickness(rig, mass), 2)
    return Part(
        part_no=f"{rig.design.name}-ballast",
        name=f"Trim ballast, disc {rig.design.grasping.weight_diameter:g} x {thickness:g} mm",
        process="turned",
        material=WEIGHT_STEEL,
        body=Extrusion(outer, thickness, (bore,)),
        colour="#50575f",
        finish="as turned; weighed with all that moves, and thinned until that is right",
        notes=("break edges 0.5",),
    )


def ballast_thickness(rig: RigLayout, mass: float) -> float:
    """Thickness (mm) of a ballast of that mass (g)."""
    outer, bore = _disc(rig)
    return mass / ((outer.area - bore.area) * WEIGHT_STEEL.density * 1e-6)


def _disc(rig: RigLayout) -> tuple[Contour, Contour]:
    """Outline and bore of the ballast: the weights'."""
    return circle((0, 0), rig.design.grasping.weight_diameter), circle((0, 0), PIN + 0.5)
