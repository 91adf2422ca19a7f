"""The leaf with adhesive, backing and foil as layers, against bare elements and composite beams."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from variants import variant

from tactcad.fem import bonded_leaf
from tactcad.fem.bonded_leaf import Layer, stiffness
from tactcad.fem.elements import solve_plane
from tactcad.fem.shape import reference_shape
from tactcad.mechanics import gauge_signal, ladder
from tactcad.mechanics.section import REFERENCE
from tactcad.paper.array_model import gauge_layers
from tactcad.parts.array.hinge_section import design_gauge, hinge_section
from tactcad.parts.array.layout import Layout

REACH = (1.2, 2.8)


def leaf(element=0):
    layout = Layout(variant())
    return hinge_section(layout, layout.elements).rows(element)


@pytest.mark.parametrize("s", [leaf(), leaf(3), REFERENCE], ids=["short", "long", "two-sided"])
def test_without_layers_it_is_the_plane_element(s):
    bare = solve_plane(
        reference_shape(s), float(s.youngs_modulus), float(s.poisson), float(s.width), density=2, order=3
    )
    assert stiffness(s, []) == pytest.approx(bare.stiffness, rel=1e-9)


@pytest.mark.parametrize("element", [0, 3])
@pytest.mark.parametrize(("thick", "modulus"), [(0.03, 3000.0), (0.01, 2000.0), (0.02, 20000.0)])
def test_one_stiff_bonded_layer_stiffens_as_the_sandwich_does(element, thick, modulus):
    """The composite beam of `gauge_signal`, its foil taken away: an upper bound, and near."""
    s = leaf(element)
    beam = replace(
        design_gauge(variant()),
        grid_height=thick,
        carrier_modulus=modulus,
        carrier_width=3.0,
        foil_modulus=0.0,
    )
    closed = float(gauge_signal.stiffness(s, beam, "plane") / ladder.stiffness(s, "plane")) - 1
    own = stiffness(s, [Layer(thick, modulus, 3.0, REACH)]) / stiffness(s, []) - 1
    assert 0.9 * closed < own < 1.05 * closed


def test_of_the_leafs_own_material_a_layer_is_a_thicker_leaf():
    """On a hinge slotted from both faces, whose lower slot it fills by a tenth of the leaf."""
    s = leaf().with_(hinge_length=3.0)
    thicker = s.with_(hinge_thickness=0.275)
    own = stiffness(s, [Layer(0.025, float(s.youngs_modulus), float(s.width), (1.5, 1.5))])
    ratio = own / stiffness(s, [])
    # the slot's walls stand where they stood: but for their fillets the leaf alone is thicker
    assert ratio == pytest.approx(stiffness(thicker, []) / stiffness(s, []), rel=0.03)


def test_layers_add_up_and_the_foil_counts_over_its_grid_only():
    s, layers = leaf(), gauge_layers(variant())
    assert [round(layer.thickness, 6) for layer in layers] == [0.01, 0.02, 0.005]
    K = [stiffness(s, layers[:n]) for n in range(4)]
    assert np.all(np.diff(K) > 0)
    whole = float(gauge_signal.stiffness(s, design_gauge(variant()), "plane") / ladder.stiffness(s, "plane"))
    assert 1.0 + 0.4 * (whole - 1) < K[-1] / K[0] < whole  # composite beams are the bound they are called
    longer = [*layers[:2], replace(layers[2], reach=REACH)]
    assert K[-1] < stiffness(s, longer) < 1.001 * whole * K[0]


def test_without_a_bond_line_of_its_own_the_carrier_takes_all_of_the_height():
    design = replace(variant(), bonding=None)
    assert [round(layer.thickness, 6) for layer in gauge_layers(design)] == [0.03, 0.005]


@pytest.mark.parametrize("element", [0, 3])
def test_finer_meshes_agree(element, monkeypatch):
    s, layers = leaf(element), gauge_layers(variant())
    coarse = stiffness(s, layers) / stiffness(s, []) - 1
    monkeypatch.setattr(bonded_leaf, "DENSITY", 4)
    assert coarse == pytest.approx(stiffness(s, layers) / stiffness(s, []) - 1, rel=0.03)
