"""The load of the guide's carriage: the bar, the foot that holds the array, and the platform with its
weights.
"""

from __future__ import annotations

from math import ceil

from tactcad.contour import Contour, circle, rectangle

from ..language.description import Extrusion, Feature, Hole, Part, Purchase
from ..language.limits import FACES, DatumFeature, Geometric
from ..language.metric import METRIC, corners, sunk, tapped_blind, tapped_depth
from ..language.stock import CARBON_STEEL, FRAME, FRAME_DATUMS, PLACE, PLAIN_STEEL, bar_material, plate
from .frame import BAR_FRONT, BAR_WIDTH, BEHIND_BAR, FOOT, PIN, PLATFORM, carrier_pattern, under_carrier_screw
from .linear_guide import LATCH, LATCH_AIR, STOP_PIN, GuideLayout, latch_on_bar

BAR_SCREW_X = 7.0
BAR_UNDER_HEAD = 3.6  # of the carriage's screws, M3x6: 2.4 mm in its 3 mm of thread, heads sunk


def bar(rig: GuideLayout) -> Part:
    """Vertical bar on the carriage. Contour in (x, z), front face at local z = 0, lower end at y = 0.

    +--o---o--+   M4 threads into the ends
    |         |
    |  O   O  |   ^ z
    |  O   O  |   |     sunk M3 into the carriage
    |      O  |   |     the latch's hole
    +--o---o--+   +-> x
    """
    t, z, top = rig.bar, rig.carriage_on_bar, rig.bar_height
    features: list[Feature] = [
        sunk("carriage", "M3", (px, z + py, 0.0), (0, 0, 1), t, BAR_UNDER_HEAD)
        for px, py in corners(7.5, 5.0)
    ]
    passed = float(STOP_PIN) + 2 * LATCH_AIR
    features.append(Hole("latch", (LATCH, latch_on_bar(rig), 0.0), (0, 0, 1), passed, t, True))
    for sx in (-1, 1):
        features.append(tapped_blind("foot", "M4", (sx * BAR_SCREW_X, 0.0, t / 2), (0, 1, 0)))
        features.append(tapped_blind("platform", "M4", (sx * BAR_SCREW_X, top, t / 2), (0, -1, 0)))
    return plate(
        rig.design,
        "bar",
        "Bar",
        Extrusion(rectangle(-BAR_WIDTH / 2, 0, BAR_WIDTH / 2, top), t),
        features,
        colour="#7c8794",
        finish="Ra 1.6",
        geometric=(
            Geometric("ends' squareness", "perpendicularity", 0.02, ("lower edge", "upper edge"), ("A",)),
            Geometric("flatness", "flatness", 0.02, (FACES[1],)),
            Geometric("latch hole", "position", PLACE, ("latch",), FRAME, True),
        ),
        datums=(DatumFeature("A", FACES[1]), *FRAME_DATUMS[1:]),
    )


FOOT_UNDER_HEAD = 3.6  # of the bar's screws, heads sunk by 0.4


def foot(rig: GuideLayout) -> Part:
    """Plate on the array's carrier, with the bar at its back edge. z = 0 is the carrier's side.

    +---------------+
    |    (o) (o)    |   bar, sunk from below
    |  O         O  |   ^ y
    |  O         O  |   |   carrier, sunk from above
    +---------------+   +-> x
    """
    x = round(max(rig.array.mount_x + METRIC[rig.design.clamp.mount_thread].head / 2, BAR_WIDTH / 2) + 2.0, 3)
    y = round(rig.design.clamp.mount_pitch_y / 2 + METRIC[rig.design.clamp.mount_thread].head / 2 + 2.0, 3)
    mount = rig.design.clamp.mount_thread
    features: list[Feature] = [
        sunk("carrier", mount, (px, py, FOOT), (0, 0, -1), FOOT, under_carrier_screw(rig.design))
        for px, py in carrier_pattern(rig.array)
    ]
    features += [
        sunk("bar", "M4", (sx * BAR_SCREW_X, rig.bar_middle, 0.0), (0, 0, 1), FOOT, FOOT_UNDER_HEAD)
        for sx in (-1, 1)
    ]
    return plate(
        rig.design,
        "foot",
        "Foot of the bar",
        Extrusion(rectangle(-x, -y, x, max(y, BAR_FRONT + rig.bar + BEHIND_BAR)), FOOT),
        features,
    )


PLATFORM_UNDER_HEAD = 3.5  # heads sunk by 0.5: the weights lie flat


def platform(rig: GuideLayout) -> Part:
    """Plate on the bar's upper end; the weights' pin is above the array's middle. z = 0 is the underside.

    +-----------+
    |   O   O   |   bar, sunk from above
    |           |   ^ y
    |    (o)    |   |   pin, sunk from below
    +-----------+   +-> x
    """
    half = rig.grasping.weight_diameter / 2
    features: list[Feature] = [
        sunk(
            "bar",
            "M4",
            (sx * BAR_SCREW_X, rig.bar_middle, PLATFORM),
            (0, 0, -1),
            PLATFORM,
            PLATFORM_UNDER_HEAD,
        )
        for sx in (-1, 1)
    ]
    features.append(sunk("pin", "M4", (0.0, 0.0, 0.0), (0, 0, 1), PLATFORM, PLATFORM_UNDER_HEAD))
    return plate(
        rig.design,
        "platform",
        "Weight platform",
        Extrusion(
            rectangle(-BAR_WIDTH, -min(half, 20.0), BAR_WIDTH, BAR_FRONT + rig.bar + BEHIND_BAR), PLATFORM
        ),
        features,
    )


def pin(rig: GuideLayout, under: float = 0.0) -> Part:
    """Pin that centres the weights, as high as their stack on `under` mm of ballast; M4 thread in its
    foot.

    +---+
    |   |
    |   |   z up
    | o |   M4 thread in its foot
    +---+   z = 0
    """
    stack = round(rig.grasping.weights) * disc_weight(rig).extrusion.thickness
    thread = tapped_depth("M4") + 1.0  # in its foot, and the floor over it
    height = 5.0 * ceil(max(stack + max(9.0, under + 1.0), thread) / 5.0)
    return Part(
        part_no=f"{rig.design.name}-weight-pin",
        name="Weight pin",
        process="turned",
        material=bar_material(rig.design),
        body=Extrusion(circle((0, 0), PIN), height),
        features=(tapped_blind("foot", "M4", (0, 0, 0), (0, 0, 1)),),
        colour="#9aa4ae",
        finish="Ra 1.6",
        notes=("top edge chamfered 0.5 by hand",),
    )


def disc_weight(rig: GuideLayout) -> Part:
    """One added weight: a steel disc on the platform's pin; its height follows from its mass.

    +------+ +------+
    |      | |      |   z up
    +------+ +------+
    """
    diameter = rig.grasping.weight_diameter
    outer, bore = circle((0, 0), diameter), circle((0, 0), PIN + 0.5)
    height = round(rig.weight_mass / ((outer.area - bore.area) * CARBON_STEEL.density * 1e-6), 3)
    return Part(
        part_no=f"WEIGHT-{rig.weight_mass:.4g}g-{diameter:g}-disc",
        name=f"Disc weight {rig.weight_mass:.4g} g",
        process="bought",
        material=CARBON_STEEL,
        body=Extrusion(outer, height, (bore,)),
        colour="#c9a227",
        purchase=Purchase(
            f"disc weight {rig.weight_mass:.4g} g, bore {PIN + 0.5:g}, diameter {diameter:g}, checked on "
            "a balance to 0.1 g",
            alternates="slotted weights of the same mass",
        ),
        mass_override=rig.weight_mass,
    )


def ballast(rig: GuideLayout, mass: float) -> Part:
    """Disc under the weights that brings the moving mass to the design's; `mass` in g, thickness to 0.01
    mm.

    +------+ +------+
    +------+ +------+   thickness from the missing mass
    """
    outer, bore = _disc(rig)
    thickness = round(ballast_thickness(rig, mass), 2)
    return Part(
        part_no=f"{rig.design.name}-ballast",
        name=f"Trim ballast, disc {rig.grasping.weight_diameter:g} x {thickness:g} mm",
        process="turned",
        material=PLAIN_STEEL,
        body=Extrusion(outer, thickness, (bore,)),
        colour="#50575f",
        finish="as turned; weighed with all that moves, and thinned until that is right",
        notes=("break edges 0.5",),
    )


def ballast_thickness(rig: GuideLayout, mass: float) -> float:
    """Thickness (mm) of a ballast of that mass (g)."""
    outer, bore = _disc(rig)
    return mass / ((outer.area - bore.area) * PLAIN_STEEL.density * 1e-6)


def _disc(rig: GuideLayout) -> tuple[Contour, Contour]:
    """Outline and bore of the ballast: the weights'."""
    return circle((0, 0), rig.grasping.weight_diameter), circle((0, 0), PIN + 0.5)
