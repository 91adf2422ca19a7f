"""The rigs' tables of the parameter tree; a design without one has no such rig. Units and frame as in
`tree`."""

from __future__ import annotations

from dataclasses import dataclass

from .fields import Number, OneOf, Whole, given

FOLLOWS = "follows the array (design/tree.py): the published set-up's up to the published array's length"


@dataclass(frozen=True)
class Calibration:
    """[calibration]: the set-up that measures each element's stiffness."""

    load_cell_stiffness: float = given(Number("N/mm", 0.01, 1e6, "force sensor's own stiffness"), 57.04)
    load_cell_accuracy: float = given(Number("", 0, 0.5, "half-width of that stiffness, relative"), 0.02)
    load_cell_range: float = given(Number("N", 0.001, 1e5, "force sensor's range"), 5.0)
    load_cell_resolution: float = given(Number("N", 0, 100, "force sensor's resolution"), 0.001)
    step: float = given(Number("mm", 1e-5, 1, "micrometer step"), 0.025)
    travel: float = given(Number("mm", 1e-4, 10, "whole displacement"), 0.150)
    micrometer_resolution: float = given(Number("mm", 0, 0.1, "micrometer's resolution"), 0.0005)
    friction: float = given(Number("", 0, 1, "friction between tip and pad"), 0.2)
    load_point: float = given(Number("mm", 0, 1, "uncertainty of the load point along the arm"), 0.02)
    stage_travel: float = given(
        Number("mm", 0.5, 100, "horizontal micro-stages reach at least this far each way"), 12.5
    )
    axis_travel: float = given(
        Number("mm", 0.5, 100, "vertical micrometer axis reaches this far each way"), 12.5
    )
    retract: float = given(Number("mm", 0.1, 50, "tip is lifted this far before the stages move"), 1.0)
    roller: str = given(
        OneOf(("2", "2.5", "3"), "diameter in mm of the roller that touches the pad, ISO 8734"), "2"
    )


@dataclass(frozen=True)
class Sample:
    """[sample]: the rubber sample."""

    thickness: float = given(Number("mm", 0.1, 100, "sample thickness"), 6.0)
    poisson: float = given(Number("", 0, 0.4999, "Poisson's ratio"), 0.49)
    stiffness: float = given(Number("N/mm", 1e-6, 1e6, "stiffness under one pad"), 3.85)
    side: float = given(Number("mm", 4, 300, "side of the square sample"), None, FOLLOWS)
    step: float = given(Number("mm", 1e-4, 5, "step of the force sensor into the sample"), 0.050)
    travel: float = given(Number("mm", 1e-3, 10, "whole way of the force sensor into the sample"), 0.300)


@dataclass(frozen=True)
class Grasping:
    """[grasping]: array on a vertical axis over the sample, loaded by weights."""

    moving_weight: float = given(Number("N", 0.001, 1e4, "carrier, bar and array"), None, FOLLOWS)
    weight: float = given(Number("N", 1e-4, 1e3, "one added weight"), 0.980665)
    weights: int = given(Whole(0, 1000, "how many weights are added"), 10)
    lift: float = given(Number("mm", 1, 200, "the array is lifted this far to change the sample"), 20.0)
    weight_diameter: float = given(Number("mm", 10, 120, "disc weights"), 50.0)
    rail_length: float = given(Number("mm", 40, 600, "vertical guide rail, a multiple of 20"), 100.0)


@dataclass(frozen=True)
class Cart:
    """[cart]: plate on four ball bearings that roll along the arms."""

    bearing: str = given(
        OneOf(("623-2Z", "624-2Z", "683-2Z"), "wheels: deep groove ball bearings, ISO 15"), "623-2Z"
    )
    length: float = given(Number("mm", 10, 400, "plate along the arms"), None, FOLLOWS)
    width: float = given(Number("mm", 10, 400, "plate across the arms"), None, FOLLOWS)
    thickness: float = given(Number("mm", 2, 40, "plate"), 10.0)
    wheel_base: float = given(Number("mm", 5, 400, "distance of the axles along the arms"), None, FOLLOWS)
    clearance: float = given(Number("mm", 0.1, 20, "plate over the base plate"), 2.0)
    shim: float = given(Number("mm", 0.05, 5, "shim each side of a wheel's inner ring: its side play"), 0.5)
    roll: float = given(Number("mm", 0.1, 50, "the cart may roll this far each way"), 5.0)


@dataclass(frozen=True)
class Holder:
    """[holder]: vacuum holder of the sample, on the cart."""

    vacuum_diameter: float = given(
        Number("mm", 4, 250, "holes and plenum lie inside this circle"), None, FOLLOWS
    )
    hole_diameter: float = given(Number("mm", 0.2, 5, "suction holes"), 1.0)
    rings: int = given(Whole(1, 12, "hexagonal rings of holes around the middle one"), None, FOLLOWS)
    lid_thickness: float = given(Number("mm", 1, 30, "lid under the sample"), None, FOLLOWS)
    plenum_depth: float = given(Number("mm", 4, 40, "plenum: room for the port in its wall"), 8.0)
    floor: float = given(Number("mm", 1, 30, "material under the plenum"), 4.0)
    margin: float = given(Number("mm", 2, 60, "lid beyond the sample, for its screws"), 8.0)
    vacuum: float = given(Number("kPa", 1, 100, "below the air's pressure"), 40.0)
    pull: float = given(Number("N", 0, 1000, "force that may pull the sample off: tack of the pads"), 0.6)


@dataclass(frozen=True)
class Bonding:
    """[bonding]: the fixture in which gauges are bonded, their adhesive and their terminals."""

    signal_share: float = given(
        Number("", 1e-4, 0.5, "largest loss of a gauge's signal by its place along the hinge, as a share"),
        0.03,
    )
    sight: float = given(
        Number("mm", 0.001, 0.5, "the gauge's middle set between the tongue's edges by eye, plus and minus"),
        0.03,
    )
    pressure: float = given(Number("MPa", 0.001, 2, "of the clamp on the gauge while it cures"), 0.1)
    glue_thickness: float = given(
        Number("mm", 0.0005, 0.2, "cured adhesive under the gauge, part of gauge.grid_height"), 0.01
    )
    glue_modulus: float = given(Number("MPa", 1, 2e4, "Young's modulus of the cured adhesive"), 2000.0)
    cure: float = given(Number("min", 0.5, 2880, "the clamp stays on"), 10.0)
    terminal_length: float = given(Number("mm", 0.5, 20, "solder terminals along the element"), 3.0)
    terminal_width: float | None = given(
        Number("mm", 0.5, 20, "solder terminals across the element"), None, "the sheet's thickness, at most 2"
    )
