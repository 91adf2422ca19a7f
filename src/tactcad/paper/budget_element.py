"""Effects on K where it is computed from the drawing: differences of the element as built, and what a model
leaves out.
"""

from __future__ import annotations

from math import log

import numpy as np

from tactcad.fem.layered_leaf import stiffness
from tactcad.mechanics import gauge_signal, ladder
from tactcad.mechanics.as_built import COMMON, half_widths
from tactcad.paper.array_model import ArrayModel
from tactcad.paper.budget_effect import BudgetPair, Effect
from tactcad.parts.wire_passes import WIRE_TOLERANCE

ROOM_SWING = 5.0  # K; hardware's own figure
CLOSED_FORM_ERROR = 0.0035  # goal for the closed forms against finite elements
SHEET_MEASURED = 0.01  # mm, half-width of a micrometer's reading of the sheet
MEASURED = "calibrate each element: K is measured, not computed"
# By field of [tolerance]: the effect's name and its unit.
AS_BUILT = {
    "hinge_thickness": ("hinge thickness, as toleranced", "mm"),
    "hinge_length": ("hinge length", "mm"),
    "fillet_radius": ("fillet radius", "mm"),
    "arm_height": ("arm height", "mm"),
    "sheet_thickness": ("sheet thickness", "mm"),
    "youngs_modulus": ("Young's modulus of the lot", "of it"),
    "recast_layer": ("recast layer of the cut", "mm on every cut face, at most"),
    "clamp_compliance": ("clamp gives way", "rad/(N mm), at most"),
}


def element(pair: BudgetPair, array: ArrayModel) -> list[Effect]:
    return [*_as_built(pair, array), *_contact(pair, array), *_models(pair, array)]


def _as_built(pair: BudgetPair, array: ArrayModel) -> list[Effect]:
    """What [tolerance] holds, by the model's own derivatives."""
    short, long = (half_widths(s, array.tolerance) for s in (pair.short, pair.long))
    effects = []
    for field, (name, unit) in AS_BUILT.items():
        size, half = getattr(array.tolerance, field), (float(short[field].item()), float(long[field].item()))
        on_object = pair.together(*half) if field in COMMON else pair.apart(*half)
        how = f"±{size:g} {unit}" + (", all elements alike" if field in COMMON else "")
        remedy, remaining = MEASURED, 0.0
        if field == "sheet_thickness":
            remedy = f"measure the sheet to {SHEET_MEASURED:g} mm"
            remaining = on_object * SHEET_MEASURED / size
        effects.append(Effect(name, how, *half, on_object, remedy, remaining))
    return effects


def _contact(pair: BudgetPair, array: ArrayModel) -> list[Effect]:
    """Position of the load, and the coarsest cut: by the closed form at both ends, since the effects are
    large.
    """
    wire = WIRE_TOLERANCE["1 pass"]

    def one(title: str, name: str, half: float, remedy: str, better: float) -> Effect:
        now, then = pair.change(name, half), pair.change(name, better)
        return Effect(
            title, f"±{half:g} mm by the closed form", *now, pair.apart(*now), remedy, pair.apart(*then)
        )

    return [
        one(
            "load point anywhere on the pad",
            "load_arm",
            array.pad_length / 2,
            f"roller within {array.rig.load_point:g} mm",
            array.rig.load_point,
        ),
        one("hinge thickness, one pass of the wire", "hinge_thickness", wire, MEASURED, 0.0),
    ]


def _bonded(pair: BudgetPair, array: ArrayModel) -> list[Effect]:
    """What the bond line adds to K, and what the gauge on it does, by elements with a layer of each."""

    def stiffer(more: int, fewer: int) -> tuple[float, float]:
        over, under = array.layers[:more], array.layers[:fewer]
        return pair.log_change(
            lambda s: np.array(stiffness(s.rows(0), over)), lambda s: np.array(stiffness(s.rows(0), under))
        )

    bond = int(array.bond_line)
    glued, gauge = stiffer(bond, 0), stiffer(len(array.layers), bond)
    whole = pair.log_change(lambda s: gauge_signal.stiffness(s, array.gauge), ladder.stiffness)
    effects = [
        Effect(
            "gauge stiffens the leaf",
            f"backing and foil by plane elements; with the bond line as a composite beam, an upper bound: "
            f"{whole[0]:.1%}",
            *gauge,
            pair.together(*gauge),
            "calibrate with the gauge on",
            0.0,
        )
    ]
    if bond:
        adhesive = array.layers[0]
        how = f"adhesive of {adhesive.thickness * 1e3:g} µm and {adhesive.modulus:g} MPa by plane elements"
        effects.append(
            Effect(
                "bond line stiffens the leaf",
                how,
                *glued,
                pair.together(*glued),
                "calibrate with the gauge on",
                0.0,
            )
        )
    return effects


def _models(pair: BudgetPair, array: ArrayModel) -> list[Effect]:
    """Effects that a computed K leaves out."""
    width = pair.log_change(lambda s: ladder.stiffness(s, "solid"), lambda s: ladder.stiffness(s, "plane"))
    warm = array.modulus_per_kelvin * ROOM_SWING
    other = abs(log(array.stiffness_factor))
    error = CLOSED_FORM_ERROR
    return [
        Effect(
            "plane stress instead of a solid",
            "solid rung over plane rung",
            *width,
            pair.together(*width),
            "solid rung",
            pair.apart(error, error),
        ),
        Effect(
            "design's modulus instead of its material's",
            "K of the real part over the printed one, all elements alike",
            other,
            other,
            pair.together(other, other),
            "take the table's value",
            0.0,
        ),
        *_bonded(pair, array),
        Effect(
            "closed form against finite elements",
            "what the ladder is held to",
            error,
            error,
            pair.apart(error, error),
            "finite-element rung, 0.1 %",
            pair.apart(0.001, 0.001),
        ),
        Effect(
            "Young's modulus with temperature",
            f"{ROOM_SWING:g} K at {array.modulus_per_kelvin:g} 1/K",
            warm,
            warm,
            pair.together(warm, warm),
            "1 K room",
            pair.together(warm, warm) / ROOM_SWING,
        ),
    ]
