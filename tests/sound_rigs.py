"""The rigs of a sound design: cart, vacuum holder, sample, calibration and grasping set-ups that keep every
rule."""

from __future__ import annotations

from math import ceil, cos, pi

from sound_designs import DRILL_REACH, TAP_REACH, WALL, Draw, as_table, bends, least_tilt

from tactcad.design.load import from_table
from tactcad.parts.bought.screws import CAP_SCREW_LENGTHS
from tactcad.parts.bought.standard_parts import BEARINGS, GROOVE_DEPTH, GROOVE_WIDTH, INSIDE
from tactcad.parts.language.metric import METRIC
from tactcad.parts.rigs.linear_guide import guide_layout
from tactcad.scenes.rigs.grasping import ballast_range

M3, M5 = METRIC["M3"], METRIC["M5"]
# mm/N of the stand's softest part: a post of 52 x 20 mm, up to 250 mm high, turned by its load's lever of 68
# mm.
STAND = 1.1 * 68.0**2 * 250.0 / (69e3 * 52.0 * 20.0**3 / 12)
# The stand: the post's front behind the sensor's axis, and the guide's front before it (mm, docs/rigs.md).
POST_FRONT, GUIDE_FRONT = 58.0, 27.5
CARRIAGE = 28.9
# Heaviest that stands on the base plate: it bridges 200 mm, 168 wide and 12 thick, and bends by a tenth of
# 0.02 mm.
HEAVIEST = 0.9 * 0.002 / bends(200.0, 168.0, 12.0)


def sound_rigs(d: Draw) -> None:
    """Tables of the rigs for the array that `d` has drawn: all, or calibration and bonding alone."""
    both = not d.once_in(4)
    if both:
        _cart(d)
        _grasping(d)
    _calibration(d, d.table["sample.travel"] if both else 0.0)
    d.number("bonding.terminal_length", 0.5, d.recess - 0.51 - d.table["wiring.bonded"])
    d.number("bonding.terminal_width", high=d.table["sheet.thickness"])
    d.rest("bonding")


def _cart(d: Draw) -> None:
    """From the sample outwards: suction holes, plenum, seal, screws, cart, wheels."""
    bearing = BEARINGS[d.put("cart.bearing", d.choice(*BEARINGS))]
    axle = METRIC[f"M{bearing.d:g}"]
    lengths = CAP_SCREW_LENGTHS[f"M{bearing.d:g}"]
    plain = 2 * axle.d + 12  # the threaded part of ISO 4762
    shim = d.number("cart.shim", high=lengths[-1] - plain - bearing.B)
    shank = next(n for n in lengths if n - plain >= shim + bearing.B - 1e-9)
    widest = float(int(2 * (POST_FRONT - 0.5 - 2 * shim - bearing.B - axle.head_height)))

    # sample and holder; the port's thread wants a flat wall of the octagonal plenum
    covered = 2 * max(d.far_x, d.far_y)
    side = d.number("sample.side", max(20.0, covered), min(widest - 2 * 7.5 - 1, 75.0))
    across = d.number("holder.vacuum_diameter", 17.8, min(side - 2, 60.0))
    corner = min(5.0, across / 5)
    around = 2 * ((across / 2 - corner) / cos(pi / 8) + corner + 1.0)
    groove = min(v for v in INSIDE.values() if v >= around) + 2 * GROOVE_WIDTH
    beside = max(
        (groove / 2 + M3.clearance / 2 + 1) / 2**0.5 + 4, groove / 2 + 1, across / 2 + 5, side / 2 + 7
    )
    margin = d.number("holder.margin", beside - side / 2, min((widest - side) / 2, 40 + (across - side) / 2))
    holder = ceil(side + 2 * margin - 1e-9)  # whole millimetres, as the holder is

    # lid, body, and the screw through both into the cart plate
    hole = d.number("holder.hole_diameter", 0.5, min(5.0, (across - 1) / 4))
    rings = d.put(
        "holder.rings",
        float(
            d.choice(*range(1, 1 + max(1, min(d.most_rings, int((across - 2 * hole) / 2 / (hole + 0.51))))))
        ),
    )
    holes = 1 + 3 * rings * (rings + 1)
    pitch = (across - 2 * hole) / 2 / rings
    around_holes = pitch / (pitch - hole)
    vacuum = d.number("holder.vacuum")
    d.number("holder.pull", high=holes * pi * hole**2 / 4 * vacuum * 1e-3)
    plenum = d.number(
        "holder.plenum_depth", GROOVE_DEPTH + 1 + M5.d / 2 + M5.tap_drill / 2 + 0.9, min(16.0, 8 * corner)
    )
    floor = d.number("holder.floor", 1.5, 22 - plenum)
    lid = d.number(
        "holder.lid_thickness", M3.head_height + 2.2, min(DRILL_REACH * hole, 28.0 - plenum - floor)
    )
    body = plenum + floor + lid - M3.head_height - 0.2  # the head sunk with a margin
    fixing = min(n for n in CAP_SCREW_LENGTHS["M3"] if n - body >= 4.5)
    longer = max(0.0, fixing - body - TAP_REACH * 3)  # the next screw would reach deeper than a tap
    d.put("holder.lid_thickness", round(lid + longer, 6))
    body += longer

    # cart plate: axles inside it, holder's screws beside them
    z, around = bearing.D / 2, axle.clearance / 2 + WALL
    clearance = d.number("cart.clearance", high=z - around)
    d.number("cart.thickness", max(z + around - clearance, fixing - body), 25.0)
    deep = shank - 2 * shim - bearing.B + 1 + 2 * axle.pitch + axle.tap_drill
    d.number("cart.width", max(holder, 2 * deep), widest)
    screw = holder / 2 - 4
    apart = axle.clearance / 2 + M3.d / 2 + 0.51
    outside = side / 2 + 2
    inner = screw - apart
    longest = (0.04 / HEAVIEST * 4 * 69e3 * d.table["cart.width"] * d.table["cart.thickness"] ** 3) ** (1 / 3)
    if inner > outside and d.once_in(2):
        base = d.number("cart.wheel_base", 2 * outside, 2 * inner)
    else:
        base = d.number("cart.wheel_base", 2 * max(outside, screw + apart), min(longest, 160.0))
    length = d.number("cart.length", max(holder, base + 2 * around), 176.0)
    d.number("cart.roll", high=(180.0 - length) / 2)  # over a base plate of 200 mm
    travel = d.number("sample.travel", high=min(2.0, d.number("sample.thickness") / 2))

    # what bends, mm/N: plate between its axles, two axles in it, the lid on its plenum, less its holes
    plate = bends(base, d.table["cart.width"], d.table["cart.thickness"])
    axles = (shim + bearing.B / 2) ** 3 / (3 * 2e5 * pi / 64 * bearing.d**4) + shim / (8e4 * bearing.d**2)
    lid = (
        0.55 * (across / 2 / cos(pi / 8)) ** 2 / (69e3 * d.table["holder.lid_thickness"] ** 3) * around_holes
    )
    d.on_cart = 1.1 * max(plate, axles, lid)
    under_gauge = max(d.on_cart, STAND)
    d.number("sample.stiffness", high=0.45 / under_gauge / travel)
    d.number("sample.step", 10.5 * under_gauge * d.table["sample.stiffness"] * travel)
    for section in ("cart", "holder", "sample"):
        d.rest(section)


def _grasping(d: Draw) -> None:
    lift = d.number("grasping.lift", high=40.0)
    d.put("grasping.rail_length", 20.0 * d.choice(*range(ceil((lift + CARRIAGE + 13) / 20), 13)))
    diameter = d.number("grasping.weight_diameter", 20.0, 2 * (GUIDE_FRONT - 0.5))
    steel = 7.85e-3 * pi * (diameter**2 - 8.5**2) / 4  # g for a mm of disc
    weights = d.put("grasping.weights", float(d.choice(0, 1, 2, 3, 5, 10)))
    d.number(
        "grasping.weight",
        steel * 1.0 * 9.81e-3,
        min(steel * 8 * 9.81e-3, (HEAVIEST - 6.0) / max(weights, 1.0)),
    )
    # the array's own weight takes the parts to tell
    d.put("grasping.moving_weight", 10.0)
    added = weights * d.table["grasping.weight"]
    if not d.once_in(10):
        low, high = ballast_range(guide_layout(from_table(as_table(d.table))))
        d.number("grasping.moving_weight", low, max(low, min(high, HEAVIEST - added)))
    heavy = added + d.table["grasping.moving_weight"]
    low = max(d.table["tolerance.pad_height"], 10.5 * d.on_cart * heavy)
    if low > d.most_pad:  # too heavy for the cart
        for path in [p for p in d.table if p.startswith("grasping.")]:
            del d.table[path]
        return
    d.number("tolerance.pad_height", low, d.most_pad)
    # bar, 30 mm between foot and carriage, 23 x 8, turned by its load's 20 mm; foot and platform are stiffer
    square = 10.5 * heavy * 20 * 30 / (69e3 * 23 * 8**3 / 12) * 180 / pi
    d.number("tolerance.tilt", max(least_tilt(d), square))


def _calibration(d: Draw, into_sample: float) -> None:
    # an arm of length A on a pad z below the hinge moves it by z d/A aside: less than half the pad
    half, below = d.table["element.pad_length"] / 2, d.table["element.pad_height"] + 1.5 + d.h
    aside = 0.9 * half * (min(map(min, d.arms)) - 2 * half) / below
    travel = d.number("calibration.travel", high=min(0.9, d.elastic, aside))
    retract = d.number("calibration.retract", high=40.0)
    d.number("calibration.axis_travel", max(max(retract, travel, into_sample) + 5.0, 9.0))
    d.number("calibration.stage_travel", max(d.far_x, d.far_y), 25.0)  # as the largest sold
    d.put("calibration.roller", d.choice("2", "2.5", "3"))
    # the carrier from its middle to an end plate, which stands at half the stack and its own half
    stack = 2 * d.far_y + 2 * d.table["array.spacer"]
    reach = (stack + d.table["clamp.end_plate_thickness"]) / 2
    width, thick = 2 * d.far_x, d.table["clamp.carrier_thickness"]
    give = max(STAND, 16 * bends(reach, width, thick))
    most = min(
        d.number("calibration.load_cell_range", high=0.09 / give),
        travel * d.number("calibration.load_cell_stiffness"),
    )
    d.number("calibration.step", 10.5 * give * most)
    d.rest("calibration")
