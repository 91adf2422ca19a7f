"""What the studies take from a design: hinge sections, gauge, read-out, tolerances, rig."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from tactcad.mechanics.gauge_signal import Gauge
from tactcad.mechanics.readout import ReadOut
from tactcad.mechanics.section import HingeSection
from tactcad.mechanics.self_heating import Power


@dataclass(frozen=True)
class Tolerance:
    """Half-widths, taken as two standard deviations; mm, tilt in degrees."""

    hinge_thickness: float
    hinge_length: float
    load_arm: float
    sheet_thickness: float
    arm_height: float
    pad_height: float
    tilt: float


@dataclass(frozen=True)
class Rig:
    """Calibration and grasping; N, N/mm, mm. load_point: half-width of the roller's place."""

    load_cell_stiffness: float
    load_cell_resolution: float
    micrometer_resolution: float
    load_point: float
    friction: float
    sample_thickness: float
    sample_poisson: float
    moving_weight: float
    weight: float
    weights: int


@dataclass(frozen=True)
class ArrayModel:
    """A design as the studies see it; section arrays and pad places (mm) have one entry an element."""

    name: str
    number: np.ndarray
    arm: np.ndarray
    section: HingeSection
    pad_length: float
    pad_height: float
    pad_x: np.ndarray
    pad_y: np.ndarray
    gauge: Gauge
    readout: ReadOut
    power: Power
    tolerance: Tolerance
    rig: Rig

    def rows(self, number: np.ndarray) -> np.ndarray:
        """Index of each element number; -1 where the design has no such element."""
        place = {int(n): i for i, n in enumerate(self.number)}
        return np.array([place.get(int(n), -1) for n in number])


def from_design(design) -> ArrayModel:
    """The array of a loaded design (tactcad.parts.designs.load)."""
    from tactcad.parts.layout import Layout

    places = Layout(design).elements
    e, m = design.element, design.material
    column = lambda pick: np.array([float(pick(p)) for p in places])  # noqa: E731
    section = HingeSection(
        hinge_thickness=column(lambda p: p.hinge.t), hinge_length=column(lambda p: p.hinge.l),
        fillet_radius=column(lambda p: p.hinge.r), load_arm=column(lambda p: p.load_arm),
        arm_height=column(lambda p: p.hinge.h), body_height=e.body_height,
        body_length=column(lambda p: p.body_length), poisson=m.poisson, youngs_modulus=m.youngs_modulus,
        width=design.sheet.thickness, two_sided=e.sides == "two",
    )
    side = column(lambda p: 1.0 if p.row == 1 else -1.0)
    return ArrayModel(
        design.name, np.array([p.number for p in places]), column(lambda p: p.arm), section, e.pad_length,
        e.pad_height, side * design.array.row_pitch / 2, side * column(lambda p: p.y),
        _pick(Gauge, design.gauge),
        _pick(ReadOut, design.readout),
        Power(design.gauge.resistance, design.gauge.carrier_conductivity, design.gauge.resistance_per_kelvin,
              design.readout.reference_mismatch, design.readout.on_time, design.readout.period),
        _pick(Tolerance, design.tolerance),
        Rig(design.calibration.load_cell_stiffness, design.calibration.load_cell_resolution,
            design.calibration.micrometer_resolution, design.calibration.load_point, design.calibration.friction,
            design.sample.thickness, design.sample.poisson, design.grasping.moving_weight, design.grasping.weight,
            design.grasping.weights),
    )


def _pick(kind, table):
    return kind(**{name: getattr(table, name) for name in kind.__dataclass_fields__})
