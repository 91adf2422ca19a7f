"""The stand of calibration and sample stiffness: places of base plate, post and the force gauge's vertical
axis, derived once from the design; its plates, and the smallest stages sold that suit the array.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from math import ceil, floor

from tactcad.contour import chain, rectangle
from tactcad.design.fields import present
from tactcad.design.tree import Design

from ..array.layout import Layout
from ..array.leads import Bench, on_bench
from ..bought.standard_parts import STAGES, Stage
from ..language.description import Extrusion, Feature, Part, Purchase, Revolution
from ..language.limits import FACES, Geometric
from ..language.metric import METRIC, SUNK, corners, counterbore_diameter, sunk, tapped, tapped_blind
from ..language.stock import ALUMINIUM, BREAK_EDGES, CARBON_STEEL, plate
from .cart import LOOSE_WHEEL, CartLayout, cart_layout
from .frame import (
    BASE,
    PLATE,
    PLATE_SCREW,
    POST,
    POST_Y,
    RISER_PITCH,
    ROW_PITCH,
    STAGE,
    STAGE_HOLE,
    TIP,
    TIP_GAP,
    carrier_pattern,
    pad_middles,
    under_carrier_screw,
)
from .linear_guide import guide_layout


@dataclass(frozen=True)
class StandLayout:
    """Derived dimensions (mm) of the stand, sized for the design's set-ups."""

    design: Design

    @cached_property
    def array(self) -> Layout:
        return Layout(self.design)

    @cached_property
    def cart(self) -> CartLayout | None:
        return cart_layout(self.design)

    @cached_property
    def stage(self) -> Stage:
        """The horizontal stages of the calibration."""
        return calibration_stage(self.array)

    @property
    def base_front(self) -> float:
        """y of the base plate's front edge."""
        reach = [STAGE / 2 + 45.0]  # micrometer of the lower stage
        if self.design.calibration is not None:
            reach.append(self.stage.size / 2 + 45.0)
        if self.cart is not None:
            reach.append(self.cart.cart_half + 20.0)
        return -float(ceil(max(reach)))

    @property
    def base_back(self) -> float:
        return POST_Y + POST[1] + 15.0

    @property
    def base_length(self) -> float:
        """Along x: the cart's whole roll on it."""
        cart = self.cart.cart if self.cart is not None else None
        roll = 2 * (cart.length / 2 + cart.roll + 10.0) if cart is not None else 0.0
        return max(BASE[0], float(ceil(roll)))

    @property
    def pads_up(self) -> float:
        """z of the pads in the calibration set-up: two stages of two plates, mount, and the array on its
        back."""
        a = self.array
        carrier_top = a.carrier_bottom + self.design.clamp.carrier_thickness
        return round(2 * self.stage.height + PLATE + carrier_top + self.design.element.pad_height, 9)

    def gauge_bottom(self, touch: float) -> float:
        """z of the gauge's housing when its tip touches at z = touch."""
        return round(touch + TIP + TIP_GAP, 9)

    def axis_middle(self, touch: float) -> float:
        """z of the vertical stage's moving plate, and of the plates on it."""
        return round(self.gauge_bottom(touch) + 45.0, 9)

    def stage_middle(self, touch: float) -> float:
        """z of the vertical stage's fixed plate: the row of threads nearest to the height needed."""
        return ROW_PITCH * round(self.axis_middle(touch) / ROW_PITCH)

    @property
    def touches(self) -> tuple[float, ...]:
        """Heights at which force sensors touch, over the scenes that this design has."""
        heights = []
        if self.design.calibration is not None:
            heights.append(self.pads_up)
            if self.cart is not None:
                heights.append(self.cart.sample_top)
        return tuple(heights)

    @cached_property
    def post_rows(self) -> tuple[float, ...]:
        """Heights of the post's rows of threads."""
        needed = [self.stage_middle(t) + s * STAGE_HOLE for t in self.touches for s in (-1, 1)]
        guide = guide_layout(self.design)
        if guide is not None:
            needed += [guide.riser_middle - RISER_PITCH, guide.riser_middle + RISER_PITCH]
        low, high = min(needed), max(needed)
        return tuple(low + ROW_PITCH * i for i in range(round((high - low) / ROW_PITCH) + 1))

    @property
    def post_height(self) -> float:
        return self.post_rows[-1] + 15.0


def calibration_bench(layout: Layout) -> Bench:
    """Boards beside the base plate, while any pad stands under the roller."""
    rig, d = StandLayout(layout.design), layout.design
    high = BASE[1] + rig.pads_up - d.element.pad_height - d.element.recess_depth
    x, y = (max(abs(pad[i]) for pad in pad_middles(layout)) for i in (0, 1))
    return on_bench(layout, rig.base_length / 2, high, (x, y))


def grasping_bench(layout: Layout) -> Bench:
    """Boards beside the base plate, the array lifted."""
    guide = guide_layout(layout.design)
    assert guide is not None
    high = BASE[1] + guide.array_z + layout.design.element.recess_depth + guide.grasping.lift
    return on_bench(layout, StandLayout(layout.design).base_length / 2, high)


AIR = 0.5  # mm between things that pass each other; chosen, as under the cart


def calibration_stage(layout: Layout) -> Stage:
    """The smallest stage that reaches every pad, clears the post, and is not covered by the carrier; the
    smallest of all if none does, which a rule then reports."""
    return next((s for s in STAGES if not faults_of(s, layout)), STAGES[0])


def faults_of(stage: Stage, layout: Layout) -> list[str]:
    """Faults of a stage for that array, in words."""
    wanted = present(layout.design.calibration).stage_travel
    wrong = []
    if stage.travel < wanted:
        wrong.append(f"travels {stage.travel:g} mm each way")
    if stage.travel < far(layout):
        wrong.append(f"reaches {stage.travel:g} mm each way")
    if far(layout) > most_before_post(stage):
        wrong.append(f"meets the post beyond {most_before_post(stage):g} mm")
    if min(layout.carrier_size) / 2 > most_carrier(stage):
        wrong.append("has its screws under the carrier")
    return wrong


def far(layout: Layout) -> float:
    """Largest distance of a pad from the middle of the array, along or across, mm."""
    return max(max(abs(x), abs(y)) for x, y in pad_middles(layout))


def most_before_post(stage: Stage) -> float:
    """Largest travel of the stage towards the post, mm."""
    return POST_Y - AIR - stage.size / 2


def most_carrier(stage: Stage) -> float:
    """Half width, along or across, of the largest carrier that leaves the mount's screws free, mm."""
    return stage.hole - counterbore_diameter("M4") / 2 - AIR


def most_elements(layout: Layout) -> int:
    """The longest row that a stage sold takes at this pitch, by reach and post."""
    reach = max(min(s.travel, most_before_post(s)) for s in STAGES)
    return floor(2 * reach / layout.design.array.pitch + 1e-9) + 1


def base_plate(rig: StandLayout) -> Part:
    """Base plate under the post, one for all set-ups: with the threads of the horizontal stages if the design
    has a calibration. The cart's wheels roll clear of them.

    +---------------------------+
    |          O O              |   the post's four screws, from below
    |          O O              |   ^ y
    |       o       o           |   |
    |                           |   +-> x
    |       o       o           |   the stages' four threads
    +---------------------------+
    """
    t, x = BASE[1], rig.base_length / 2
    middle = POST_Y + POST[1] / 2
    features: list[Feature] = [
        sunk("post", "M5", (px, middle + py, 0.0), (0, 0, 1), t, BASE_UNDER_HEAD) for px, py in POST_SCREWS
    ]
    if rig.design.calibration is not None:
        features += [
            tapped_blind("stage", "M4", (px, py, t), (0, 0, -1))
            for px, py in corners(rig.stage.hole, rig.stage.hole)
        ]
    return plate(
        rig.design,
        "base",
        "Base plate",
        Extrusion(rectangle(-x, rig.base_front, x, rig.base_back), t),
        features,
        colour="#6f7a86",
        finish="upper face ground or fly-cut, Ra 0.8",
        notes=("break edges 0.5", "threads countersunk 0.3, no burr: wheels roll over this face"),
        geometric=(Geometric("flatness", "flatness", LOOSE_WHEEL, (FACES[1],)),),
    )


UPRIGHT = 0.03  # mm, post's front over its height against its foot; chosen: 0.02 of 100
POST_SCREWS = corners(20.0, 5.0)  # from the post's middle
BASE_SCREW = 16.0  # M5 through the base plate into the post, head sunk
BASE_UNDER_HEAD = BASE[1] - METRIC["M5"].head_height - SUNK
BASE_THREAD = BASE_SCREW - BASE_UNDER_HEAD + 1.0  # its end free at any limits


def post(rig: StandLayout) -> Part:
    """Post: contour in (x, z) of the scene, front face at local z = 0, two columns of M4 threads.

    +-------+
    | o   o |
    | o   o |   rows ROW_PITCH apart
    | o   o |   ^ z
    |       |   |
    +-------+   +-> x
    """
    w, t = POST
    features: list[Feature] = [
        tapped("row", "M4", (sx * STAGE_HOLE, z, 0.0), (0, 0, 1), t) for z in rig.post_rows for sx in (-1, 1)
    ]
    # the base plate's screws reach 9.2 mm in, more than the usual blind thread has
    features += [
        tapped_blind("base", "M5", (px, 0.0, t / 2 + py), (0, 1, 0), BASE_THREAD) for px, py in POST_SCREWS
    ]
    return plate(
        rig.design,
        "post",
        "Post",
        Extrusion(rectangle(-w / 2, 0, w / 2, rig.post_height), t),
        features,
        colour="#6f7a86",
        finish="Ra 1.6",
        geometric=(Geometric("front face's squareness", "perpendicularity", UPRIGHT, (FACES[0],), ("C",)),),
        notes=("break edges 0.5",),
    )


LONGER = 5.0  # mm that the mount is longer along x than the stage, each way: which way it lies is seen


def array_mount(rig: StandLayout) -> Part:
    """Plate on the upper stage that holds the array on its back. z = 0 is the stage's side.

    +-----------------+
    | O             O |   O stage, sunk from above
    |    (O)   (O)    |   (O) carrier, sunk from below
    |    (O)   (O)    |
    | O             O |
    +-----------------+
    """
    thread, _, under = PLATE_SCREW
    stage = rig.stage
    x = max(rig.array.carrier_size[0] / 2, stage.size / 2 + LONGER)
    features: list[Feature] = [
        sunk("stage", thread, (px, py, PLATE), (0, 0, -1), PLATE, under)
        for px, py in corners(stage.hole, stage.hole)
    ]
    mount = rig.design.clamp.mount_thread
    features += [
        sunk("carrier", mount, (px, py, 0.0), (0, 0, 1), PLATE, under_carrier_screw(rig.design))
        for px, py in carrier_pattern(rig.array)
    ]
    return plate(
        rig.design,
        "array-mount",
        "Array mount",
        Extrusion(rectangle(-x, -stage.size / 2, x, stage.size / 2), PLATE),
        features,
        finish="Ra 1.6",
        notes=(BREAK_EDGES, "mark x in the upper face at the end with positive x"),
        geometric=(Geometric("parallelism", "parallelism", 0.01, (FACES[1],), ("A",)),),
    )


def stage_fixed(stage: Stage) -> Part:
    """Fixed half of a micro-stage: back at z = 0, slideway at the top; screws enter from the slideway's
    side.

    O-----------O    z = thickness: slideway
    |           |
    |           |    four counterbored holes at its corners
    O-----------O    z = 0: back
    """
    half, t = stage.size / 2, stage.plate
    thread, _, under = PLATE_SCREW
    holes = tuple(
        sunk("mount", thread, (px, py, t), (0, 0, -1), t, under) for px, py in corners(stage.hole, stage.hole)
    )
    return Part(
        part_no=f"STAGE-{stage.size:g}-{2 * stage.travel:g}-FIXED",
        name=f"Micro-stage {stage.size:g} x {stage.size:g}, fixed half",
        process="bought",
        material=ALUMINIUM,
        body=Extrusion(rectangle(-half, -half, half, half), t),
        features=holes,
        colour="#3f4650",
        purchase=Purchase(
            f"crossed roller stage {stage.size:g} x {stage.size:g} x {stage.height:g} mm, "
            f"travel +-{stage.travel:g} mm, M4 at {2 * stage.hole:g} x {2 * stage.hole:g}, screwed down from "
            "its slideway, two screws at each end of its travel; no maker's drawing read: compare size, "
            "holes and travel",
            alternates="any stage of that size, travel and hole pattern",
        ),
    )


def stage_moving(stage: Stage) -> Part:
    """Moving half: slideway at z = 0, threads from the face at the top.

    o-----------o    z = thickness: four M4 threads at its corners
    |           |
    o-----------o    z = 0: slideway
    """
    half, t = stage.size / 2, stage.plate
    threads = tuple(
        tapped("mount", "M4", (px, py, t), (0, 0, -1), t) for px, py in corners(stage.hole, stage.hole)
    )
    return Part(
        part_no=f"STAGE-{stage.size:g}-{2 * stage.travel:g}-MOVING",
        name=f"Micro-stage {stage.size:g} x {stage.size:g}, moving half",
        process="included",
        material=ALUMINIUM,
        body=Extrusion(rectangle(-half, -half, half, half), t),
        features=threads,
        colour="#59626e",
        purchase=Purchase("moving half, comes with the fixed half", alternates="as the fixed half"),
    )


def micrometer(travel: float, resolution: float) -> Part:
    """Micrometer head on a stage's fixed half, as an envelope: axis z, from z = 0 outwards.

        +-------------+
    +---+   thimble   |   z ->
    +---+             |
        +-------------+
    z = 0 on the stage's fixed half
    """
    return Part(
        part_no=f"MICROMETER-{2 * travel:g}-{resolution:g}-head",
        name=f"Micrometer head {2 * travel:g} mm, {resolution:g} mm",
        process="bought",
        material=CARBON_STEEL,
        body=Revolution(chain([(0, 0), (3.0, 0), (3.0, 18.0), (4.5, 18.0), (4.5, 45.0), (0, 45.0)])),
        colour="#8a8d91",
        purchase=Purchase(
            f"micrometer head, travel {2 * travel:g} mm, resolution {resolution:g} mm, for the stage",
            alternates="motorised actuator of the same travel",
        ),
    )
