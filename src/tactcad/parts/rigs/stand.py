"""The stand of all set-ups: base plate, post with rows of threads, and the plates that carry the force gauge."""

from __future__ import annotations

from math import ceil, hypot

from tactcad.contour import Corner, circle, rectangle, rounded_polygon

from ..description import Characteristic, Extrusion, Feature, Hole, Part, Pocket
from ..library.dowels import dowel_diameter
from ..library.screws import METRIC
from .bought import GAUGE_THREADS, rail_holes
from .cart import COLOUR, STEEL, plate_alloy
from .holes import sunk, tapped, tapped_blind
from .layout import BASE, PLATE, PLATE_SCREW, POST, RISER_PITCH, STAGE_HOLE, TIP, TIP_LAND, RigLayout

POST_SCREWS = tuple((sx * 20.0, sy * 5.0) for sx in (-1, 1) for sy in (-1, 1))  # from the post's middle
BASE_SCREW = 16.0  # M5 through the base plate into the post, head sunk
BASE_THREAD = BASE_SCREW - (BASE[1] - METRIC["M5"].head_height) + 0.5
RISER_SCREW, RISER_UNDER_HEAD = 16.0, 9.0  # M4 into the post: 7 mm engaged, head deep in the riser
GAUGE_SCREW_X, GAUGE_SCREW_Z = 40.0, 20.0  # gauge plate on axis plate: outside the gauge's width


def base_plate(rig: RigLayout, stages: bool) -> Part:
    """Base plate under the post; with the threads of the horizontal stages where `stages` stand on it."""
    t, x = BASE[1], rig.base_length / 2
    middle = rig.post_y + POST[1] / 2
    m5 = METRIC["M5"]
    features: list[Feature] = [
        sunk("post", "M5", (px, middle + py, 0.0), (0, 0, 1), t, t - m5.head_height) for px, py in POST_SCREWS
    ]
    if stages:
        features += [
            tapped_blind("stage", "M4", (sx * STAGE_HOLE, sy * STAGE_HOLE, t), (0, 0, -1))
            for sx in (-1, 1)
            for sy in (-1, 1)
        ]
    kind = "stages" if stages else "cart"
    return Part(
        part_no=f"{rig.design.name}-base-{kind}",
        name=f"Base plate, for {kind}",
        process="milled",
        material=plate_alloy(rig),
        body=Extrusion(rectangle(-x, rig.base_front, x, rig.base_back), t),
        features=tuple(features),
        colour="#6f7a86",
        finish="upper face ground or fly-cut, Ra 0.8, flat within 0.02",
        notes=("break edges 0.5",),
    )


def post(rig: RigLayout) -> Part:
    """Post: contour in (x, z) of the scene, front face at local z = 0, two columns of M4 threads."""
    w, t = POST
    features: list[Feature] = [
        tapped("row", "M4", (sx * STAGE_HOLE, z, 0.0), (0, 0, 1), t) for z in rig.post_rows for sx in (-1, 1)
    ]
    # the base plate's screws reach 9 mm in, more than the usual blind thread has
    features += [
        tapped_blind("base", "M5", (px, 0.0, t / 2 + py), (0, 1, 0), BASE_THREAD) for px, py in POST_SCREWS
    ]
    return Part(
        part_no=f"{rig.design.name}-post",
        name="Post",
        process="milled",
        material=plate_alloy(rig),
        body=Extrusion(rectangle(-w / 2, 0, w / 2, rig.post_height), t),
        features=tuple(features),
        colour="#6f7a86",
        finish="Ra 1.6, front face square to the foot within 0.02/100",
        notes=("break edges 0.5",),
    )


def axis_plate(rig: RigLayout) -> Part:
    """On the vertical stage; takes the gauge plate outside the gauge's width. Front face at local z = 0."""
    thread, _, under = PLATE_SCREW
    features = [
        sunk("stage", thread, (sx * STAGE_HOLE, sy * STAGE_HOLE, 0.0), (0, 0, 1), PLATE, under)
        for sx in (-1, 1)
        for sy in (-1, 1)
    ]
    features += [
        tapped("gauge_plate", thread, (sx * GAUGE_SCREW_X, sy * GAUGE_SCREW_Z, 0.0), (0, 0, 1), PLATE)
        for sx in (-1, 1)
        for sy in (-1, 1)
    ]
    return _upright(rig, "axis-plate", "Axis plate", features)


def gauge_plate(rig: RigLayout) -> Part:
    """Holds the force gauge by two screws from behind. Front face at local z = 0."""
    thread, _, under = PLATE_SCREW
    features = [
        sunk("axis_plate", thread, (sx * GAUGE_SCREW_X, sy * GAUGE_SCREW_Z, 0.0), (0, 0, 1), PLATE, under)
        for sx in (-1, 1)
        for sy in (-1, 1)
    ]
    features += [sunk("gauge", thread, (0.0, y, PLATE), (0, 0, -1), PLATE, under) for y in GAUGE_THREADS]
    return _upright(rig, "gauge-plate", "Gauge plate", features)


def _upright(rig: RigLayout, number: str, name: str, features: list[Feature]) -> Part:
    return Part(
        part_no=f"{rig.design.name}-{number}",
        name=name,
        process="milled",
        material=plate_alloy(rig),
        body=Extrusion(rectangle(-46.0, -35.0, 46.0, 35.0), PLATE),
        features=tuple(features),
        colour=COLOUR,
        finish="Ra 1.6, clear anodised after machining",
        notes=("break edges 0.2",),
    )


def flat_tip(rig: RigLayout) -> Part:
    """Tip for the sample: a land of one pad's size under a round body. z = 0 is the land, the thread from the top."""
    d = rig.design
    a, b = d.element.pad_length / 2, d.sheet.thickness / 2
    body = max(10.0, float(ceil(2 * hypot(a, b) + 1.0)))  # 0.5 mm around the land's corners
    around = circle((0, 0), body)
    return Part(
        part_no=f"{d.name}-tip-flat",
        name=f"Tip, flat {d.element.pad_length:g} x {d.sheet.thickness:g}",
        process="milled",
        material=STEEL,
        body=Extrusion(around, TIP),
        features=(
            Pocket(
                "around_land", (0, 0, 0), (0, 0, 1), (1, 0, 0), around, TIP_LAND, (rectangle(-a, -b, a, b),)
            ),
            _shaft_thread(),
        ),
        colour="#565d66",
        finish="land Ra 0.4, edges sharp, burr-free",
        characteristics=(
            Characteristic("land along x", 2 * a, 2 * a + 0.01, 2 * a - 0.01),
            Characteristic("land along y", 2 * b, 2 * b + 0.01, 2 * b - 0.01),
        ),
    )


def roller_tip(rig: RigLayout) -> Part:
    """Tip for the pads: a nose with a half-round seat for the roller, which stands out by its radius.

    Contour in (x, z), z = 0 the roller's lowest line, extruded along y by 10.
    """
    r = dowel_diameter(rig.design.calibration.roller) / 2
    nose, half = r + 1.0, 6.0
    corners = [
        Corner((-nose, r)),
        Corner((-r, r), edge="seat"),
        Corner((-r, 2 * r), r),
        Corner((r, 2 * r), r),
        Corner((r, r)),
        Corner((nose, r)),
        Corner((half, r + half - nose)),
        Corner((half, TIP)),
        Corner((-half, TIP)),
        Corner((-half, r + half - nose)),
    ]
    return Part(
        part_no=f"{rig.design.name}-tip-roller",
        name="Tip, roller holder",
        process="wire-cut",
        material=STEEL,
        body=Extrusion(rounded_polygon(corners), 10.0),
        features=(_shaft_thread((0.0, TIP, 5.0), (0, -1, 0)),),
        colour="#565d66",
        notes=("roller bonded in its seat; it may not turn while an element is loaded",),
    )


def _shaft_thread(
    at: tuple[float, float, float] = (0.0, 0.0, TIP), axis: tuple[float, float, float] = (0, 0, -1)
) -> Hole:
    """M6 for the gauge's shaft: 9 of its 10 mm engaged."""
    return Hole("shaft", at, axis, 5.0, 12.0, False, thread="M6", thread_depth=10.0, drill_point=True)


def riser(rig: RigLayout) -> Part:
    """Block between post and guide rail. Front face (the rail's) at local z = 0, contour in (x, z) about its middle."""
    length, depth = rig.design.grasping.rail_length, rig.riser_depth
    half = max(length / 2, RISER_PITCH + 8.0)
    features: list[Feature] = [
        sunk(
            "post",
            "M4",
            (sx * STAGE_HOLE, sy * RISER_PITCH, 0.0),
            (0, 0, 1),
            depth,
            min(RISER_UNDER_HEAD, depth),
        )
        for sx in (-1, 1)
        for sy in (-1, 1)
    ]
    features += [tapped_blind("rail", "M3", (0.0, y, 0.0), (0, 0, 1)) for y in rail_holes(length)]
    return Part(
        part_no=f"{rig.design.name}-riser",
        name="Riser",
        process="milled",
        material=plate_alloy(rig),
        body=Extrusion(rectangle(-POST[0] / 2, -half, POST[0] / 2, half), depth),
        features=tuple(features),
        colour=COLOUR,
        finish="rail face Ra 0.8, parallel to the back within 0.01",
        notes=("break edges 0.2",),
    )
