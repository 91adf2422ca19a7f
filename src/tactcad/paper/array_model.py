"""A design's data for the studies of the paper: hinge sections, gauge, read-out, tolerances, rig."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from tactcad.design.materials import modulus_per_kelvin
from tactcad.design.messages import InputError
from tactcad.design.tree import Calibration, Design, Grasping, Sample, Tolerance
from tactcad.fem.bonded_leaf import Layer
from tactcad.lab import pads
from tactcad.mechanics.gauge_signal import Gauge, Power
from tactcad.mechanics.readout import ReadOut
from tactcad.mechanics.section import HingeSection
from tactcad.parts.array.bridge_figures import power_of, zero_drift
from tactcad.parts.array.hinge_section import design_gauge, design_readout, hinge_section
from tactcad.parts.array.layout import Layout


@dataclass(frozen=True)
class ArrayModel:
    """A design as those studies see it; section arrays and pad places (mm) have one entry an element."""

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
    stiffness_factor: float  # of the material's own modulus over the design's
    modulus_per_kelvin: float  # 1/K, by which the modulus falls
    calibration: Calibration
    sample: Sample
    grasping: Grasping
    layers: tuple[Layer, ...]  # on the leaf: the bond line first, if the design has one
    bond_line: bool

    def rows(self, number: np.ndarray) -> np.ndarray:
        """Index of each element number; -1 if the design has no such element."""
        place = {int(n): i for i, n in enumerate(self.number)}
        return np.array([place.get(int(n), -1) for n in number])


def from_design(design: Design) -> ArrayModel:
    """The array of a loaded design (tactcad.parts.rules.load). Raises InputError if it has no rig
    tables.
    """
    calibration, sample, grasping = design.calibration, design.sample, design.grasping
    if calibration is None or sample is None or grasping is None:
        lacking = next(n for n in ("calibration", "sample", "grasping") if getattr(design, n) is None)
        raise InputError(f"design {design.name}", f"has no [{lacking}] table, which a validation needs")
    layout = Layout(design)
    places = layout.elements
    return ArrayModel(
        design.name,
        np.array([p.number for p in places]),
        np.array([float(p.arm) for p in places]),
        # friction acts at the pad of a calibration rig, and is evaluated there
        hinge_section(layout, places).with_(pad_height=0.0, friction=0.0),
        design.element.pad_length,
        design.element.pad_height,
        *pads.places(layout),
        design_gauge(design),
        # leads and switch of the published array are not known
        replace(design_readout(design), transmission=1.0),
        power_of(layout),
        replace(design.tolerance, zero_drift=zero_drift(layout)),
        design.stiffness_factor or 1.0,
        modulus_per_kelvin(design.material.alloy),
        calibration,
        sample,
        grasping,
        gauge_layers(design),
        design.bonding is not None,
    )


def gauge_layers(design: Design) -> tuple[Layer, ...]:
    """Layers from the leaf's face outwards, the foil last.

    The first one is the adhesive, if the design names one ([bonding]); the rest of gauge.grid_height is the
    carrier's backing. The foil's metal counts by its share of the grid's area.
    """
    g, b = design.gauge, design.bonding
    carrier = (min(g.carrier_width, design.sheet.thickness), (g.carrier_arm_side, g.carrier_body_side))
    glue = b.glue_thickness if b else 0.0
    backing = g.grid_height - glue
    half = g.grid_length / 2
    layers = [Layer(glue, b.glue_modulus, *carrier)] if b else []
    if backing > 0:
        layers.append(Layer(backing, g.carrier_modulus, *carrier))
    if g.foil_thickness > 0:
        foil = (g.foil_thickness, g.foil_modulus * g.foil_coverage, g.grid_width, (half, half))
        layers.append(Layer(*foil))
    return tuple(layers)
