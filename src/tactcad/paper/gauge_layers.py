"""The design's gauge as layers on the leaf: adhesive, backing, foil."""

from __future__ import annotations

from tactcad.design.tree import Design
from tactcad.fem.layered_leaf import Layer


def gauge_layers(design: Design) -> tuple[Layer, ...]:
    """Layers from the leaf's face outwards, the foil last.

    The first one is the adhesive, of a design that says which ([bonding]); what of gauge.grid_height it does
    not take is the carrier's backing. The foil's metal counts by its share of the grid's area.
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
