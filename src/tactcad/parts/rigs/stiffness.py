"""The rigs' lines of the stiffness table (parts/array/stiffness_table.py), and the load on every element at
the end of the calibration's travel.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from math import pi, radians

from tactcad.design.fields import present
from tactcad.design.materials import ALLOYS
from tactcad.design.tree import Design
from tactcad.mechanics.statics import Beam, rod, round_plate

from ..array.layout import LEAST_GAP, ElementPlace, Layout
from ..array.seating import FLAT, carrier_beam
from ..array.stiffness_table import TENTH, Deflection, pads_plane
from ..array.stop_give import STEEL_MODULUS, STEEL_POISSON
from ..bought.standard_parts import dowel_diameter
from .bonding_fixture import bonding_rigs, kind_suffix
from .cart import CartLayout
from .force_gauge import GAUGE_SCREW_X, GAUGE_THREADS
from .frame import BAR_WIDTH, BASE, FOOT, GAUGE_SIZE, PIN, PLATE, PLATFORM, POST, POST_Y, STAGE_HOLE
from .linear_guide import guide_layout
from .moving_weight import pin
from .stand import StandLayout

ATMOSPHERE = 0.1  # MPa: no vacuum presses more
LEVER = POST_Y + POST[1] / 2  # from the force gauge's axis to the post's middle, mm
THREAD_COLUMN = 4.0  # mm of the post's width that a column of M4 threads takes
BACK = 35.0  # mm, half the height of gauge plate and axis plate
SEAT = 10.0  # mm, the roller's seat (roller_tip.py)
LID = "holder.lid_thickness"
# Scene, load (N) and its origin, allowance (um) and its reason, fields that change the load or the allowance.
Load = tuple[str, float, str, float, str, tuple[str, ...]]


def calibration_lines(design: Design) -> Iterator[Deflection]:
    """Parts in series with the gauge, each by itself and all together: their deflection is read as the
    element's.
    """
    lines = tuple(_in_series(design))
    yield from lines
    one, own = lines[0], 1e3 * lines[0].load / present(design.calibration).load_cell_stiffness
    yield Deflection(
        one.scene,
        "all of these",
        "in series with the gauge",
        one.load,
        one.origin,
        1e3 * one.load * series_give(design),
        TENTH * own,
        "a tenth of what the gauge gives way, which is measured with them",
        ("calibration.load_cell_stiffness",),
        "flag",
    )


def series_give(design: Design) -> float:
    """Compliance of the calibration's stand and mount, in series with the gauge's, mm/N."""
    return sum(1e-3 * line.gives / line.load for line in _in_series(design))


def _in_series(design: Design) -> Iterator[Deflection]:
    rig, c = StandLayout(design), present(design.calibration)
    load = (
        "calibration",
        min(c.load_cell_range, c.travel * c.load_cell_stiffness),
        "the gauge's range, or its stiffness times the travel",
        TENTH * c.step * 1e3,
        "a tenth of calibration.step",
        ("calibration.step", "calibration.travel", "calibration.load_cell_range"),
    )
    yield from _stand_lines(rig, rig.pads_up, load)
    d = dowel_diameter(c.roller)
    yield _line(
        load, "roller", "on the ends of its seat", rod(SEAT, d, STEEL_MODULUS, STEEL_POISSON).supported()
    )
    mount = _plate(design, 2 * rig.stage.hole, 2 * rig.stage.hole, PLATE)
    yield _line(load, "array mount", "between its screws, load in the middle", mount.supported())
    end = carrier_beam(rig.array, rig.array.end_plate_y).cantilever()
    yield _line(load, "carrier", "from its middle to an end plate", end, "clamp.carrier_thickness")


def sample_lines(design: Design) -> Iterator[Deflection]:
    rig, s = StandLayout(design), present(design.sample)
    cart = present(rig.cart)
    load = (
        "sample-stiffness",
        min(present(design.calibration).load_cell_range, s.stiffness * s.travel),
        "sample.stiffness times sample.travel",
        TENTH * s.step * 1e3,
        "a tenth of sample.step",
        ("sample.step", "sample.travel"),
    )
    yield from _stand_lines(rig, cart.sample_top, load)
    yield from _cart_lines(cart, load)


def grasping_lines(design: Design) -> Iterator[Deflection]:
    """Array and weights on their guide, and the cart under them; the guide itself is bought."""
    rig, stand, layout = present(guide_layout(design)), StandLayout(design), Layout(design)
    g = rig.grasping
    weight, origin = g.moving_weight + g.weights * g.weight, "moving weight and all added weights"
    lighter = ("grasping.weights", "grasping.moving_weight")
    down = ("grasping", weight, origin, *pads_plane(design), ("tolerance.pad_height", *lighter))
    yield from _cart_lines(rig.cart, down)
    flat = TENTH * FLAT * 1e3, "a tenth of the 0.02 mm within which it is made flat"
    base = _plate(design, stand.base_length, stand.base_back - stand.base_front, BASE[1])
    base_load = ("grasping", weight, origin, *flat, lighter)
    yield _line(base_load, "base plate", "bridging its whole length, load in the middle", base.supported())
    radius = rig.cart.plenum_reach
    air = "0.1 MPa, more than any vacuum, on the plenum"
    vacuum = ("grasping", ATMOSPHERE * pi * radius**2, air, *flat, ())
    pressed = _lid(rig.cart)[1] / (pi * radius**2)
    yield _line(vacuum, "holder's lid", "round plate on its rim, pierced, evenly pressed", pressed, LID)

    # What turns foot or bar tilts the array: stated as the difference between the ends of a row.
    row = max(layout.positions - 1, 1) * design.array.pitch
    tilt = (
        "grasping",
        weight,
        origin,
        1e3 * TENTH * radians(design.tolerance.tilt) * row,
        "a tenth of tolerance.tilt over a row",
        (*lighter, "tolerance.tilt"),
    )
    bar = _plate(design, rig.carriage_on_bar, BAR_WIDTH, rig.bar)
    yield _line(
        tilt, "bar", "turned at its foot, held at the carriage", rig.bar_middle * bar.turned_by_moment() * row
    )
    foot = _plate(design, rig.bar_middle, 2 * rig.array.mount_x, FOOT)
    yield _line(tilt, "foot", "turned at the array's middle, held at the bar", foot.cantilever_tilt() * row)
    platform = _plate(design, rig.bar_middle, 2 * BAR_WIDTH, PLATFORM)
    model = "turned at the weights' pin, held at the bar"
    yield _line(tilt, "platform", model, platform.cantilever_tilt() * row)
    alloy = ALLOYS[design.clamp.plate_alloy]
    slender = rod(pin(rig).extrusion.thickness, PIN, alloy.youngs_modulus, alloy.poisson)
    play = (
        "grasping",
        g.weight,
        "one weight, leant on its end",
        TENTH * 0.5 * 1e3,
        "a tenth of the discs' play on it",
        ("grasping.weight", "grasping.weights"),
    )
    yield _line(play, "weight pin", "held in the platform", slender.cantilever())


def _stand_lines(rig: StandLayout, touch: float, load: Load) -> Iterator[Deflection]:
    """Base plate, post and the gauge's plates: a C-frame that the force on the gauge's axis opens."""
    design = rig.design
    base = _plate(design, LEVER, POST[0], BASE[1])
    yield _line(load, "base plate", "held under the post, as wide as it", base.cantilever())
    post = _plate(design, rig.stage_middle(touch), POST[0] - 2 * THREAD_COLUMN, POST[1])
    model = "held in the base plate, turned by the force's lever"
    yield _line(load, "post", model, LEVER**2 * post.turned_by_moment())
    # The gauge's two screws push and pull on the plate's upper and lower half, which its sides hold.
    half = _plate(design, 2 * GAUGE_SCREW_X, BACK, PLATE)
    apart, out = GAUGE_THREADS[1] - GAUGE_THREADS[0], GAUGE_SIZE[1] / 2 + PLATE / 2
    turned = 2 * half.supported() * (out / apart) ** 2
    yield _line(load, "gauge plate", "halves between its sides, a pair of screws in the middle", turned)
    out += PLATE
    turned = 2 * _plate(design, 2 * STAGE_HOLE, BACK, PLATE).supported() * (out / apart) ** 2
    yield _line(load, "axis plate", "halves between the stage's screws, as the gauge plate", turned)


def bonding_lines(design: Design) -> Iterator[Deflection]:
    """The bonding fixture's tongue of every kind of hinge, pushed along the element at its tip."""
    for rig in bonding_rigs(design):
        high = rig.front_floor - rig.floor
        tongue = Beam(high, rig.width, max(rig.tongue, LEAST_GAP), STEEL_MODULUS, STEEL_POISSON)
        yield Deflection(
            "bonding",
            f"tongue of the nest{kind_suffix(rig)}",
            "held in the nest, pushed at its tip",
            PUSH,
            "a finger against the element",
            1e3 * PUSH * tongue.cantilever(),
            1e3 * TENTH * rig.table.sight,
            "a tenth of bonding.sight",
            ("element.hinge_length", "bonding.sight"),
        )


PUSH = 5.0  # N; chosen: a finger that sets a gauge presses less


def _cart_lines(cart: CartLayout, load: Load) -> Iterator[Deflection]:
    c = cart.cart
    plate = _plate(cart.design, c.wheel_base, c.width, c.thickness)
    model = "between its axles, load in the middle"
    yield _line(load, "cart plate", model, plate.supported(), "cart.thickness")
    axle = rod(c.shim + cart.bearing.B / 2, cart.bearing.d, STEEL_MODULUS, STEEL_POISSON)
    yield _line(
        load, "cart's axles", "held in the plate, two of four carry", axle.cantilever() / 2, "cart.shim"
    )
    model = "round plate on its rim, pierced, load in the middle"
    yield _line(load, "holder's lid", model, _lid(cart)[0], LID)


def _lid(cart: CartLayout) -> tuple[float, float]:
    """Holder's lid on the plenum's rim: mm for each newton in its middle, and for each MPa under it.

    Its suction holes leave of every line through them, and so of the plate's stiffness, at least (pitch -
    d)/pitch.
    """
    h, alloy = cart.holder, ALLOYS[cart.design.clamp.plate_alloy]
    pitch = (h.vacuum_diameter - 2 * h.hole_diameter) / 2 / h.rings
    E = alloy.youngs_modulus * (1 - h.hole_diameter / pitch)
    return round_plate(cart.plenum_reach, h.lid_thickness, E, alloy.poisson)


def _plate(design: Design, length: float, width: float, thickness: float) -> Beam:
    alloy = ALLOYS[design.clamp.plate_alloy]
    return Beam(length, width, thickness, alloy.youngs_modulus, alloy.poisson)


def _line(load: Load, part: str, model: str, give: float, own: str = "") -> Deflection:
    """`give` in mm/N; `own` is the path of the part's own field, to be looked at before the load's."""
    scene, force, origin, allowed, why, fields = load
    fields = (own, *fields) if own else fields
    return Deflection(scene, part, model, force, origin, 1e3 * force * give, allowed, why, fields)


@dataclass(frozen=True)
class CalibrationLoad:
    """One element at the end of calibration.travel.

    Gauge and element are springs in series: of the micrometer's travel D the element takes d = D K_g/(K_g +
    K).

    deflection        mm at the pad
    force             N
    rated_deflection  mm that the hinge may give way
    travel_at_rated   mm of the micrometer that reach it
    travel_at_yield   mm of the micrometer at which the fillet yields
    refused           why the estimator refuses the element; then the numbers are NaN
    """

    place: ElementPlace
    deflection: float
    force: float
    rated_deflection: float
    travel_at_rated: float
    travel_at_yield: float
    refused: str = ""


def calibration_loads(design: Design) -> tuple[CalibrationLoad, ...]:
    """Every element, by number."""
    from tactcad.mechanics import strength  # numpy, which only checks and guides need

    from ..array.hinge_section import hinges, in_design

    c, layout = present(design.calibration), Layout(design)
    known = hinges(layout)
    loads = []
    for place, K, why, at_yield in zip(layout.elements, known.stiffness, known.broken, known.yield_force):
        share = c.load_cell_stiffness / (c.load_cell_stiffness + K)
        rated = strength.rated_deflection(at_yield, K, design.rating)
        deflection = c.travel * share
        figures = (deflection, K * deflection, rated, rated / share, at_yield / K / share)
        gives, force, may_give, to_rated, to_yield = map(float, figures)
        loads.append(
            CalibrationLoad(place, gives, force, may_give, to_rated, to_yield, in_design(why, layout, place))
        )
    return tuple(loads)
