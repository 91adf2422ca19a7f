"""From a candidate to a design: kinds dealt out over the rows so that different ones are neighbours."""

from __future__ import annotations

from dataclasses import replace
from math import ceil

import numpy as np

from tactcad.design.load import paths
from tactcad.design.tree import Design, Hinge

from .candidates import Candidates
from .target import ARM, THICKNESS


def order(count: list[int], rows: int) -> list[list[int]]:
    """Kind of every place, row by row: each kind spread evenly along both rows.

    A pair that feels the same spot of the object gives its ratio best, so each kind's elements are dealt out
    where it lags most behind its share.
    """
    total = sum(count)
    dealt = [0] * len(count)
    dealing: list[int] = []
    for n in range(1, total + 1):
        lag = [count[k] * n / total - dealt[k] if dealt[k] < count[k] else -np.inf for k in range(len(count))]
        kind = int(np.argmax(lag))
        dealt[kind] += 1
        dealing.append(kind)
    first = ceil(total / rows)
    return [dealing[:first], dealing[first:][::-1]][:rows]


def dealt(c: Candidates) -> list[list[int]]:
    """Kind of every place of one candidate (the first), row by row."""
    return order([int(n) for n in c.count[0]], c.stand.target.room.rows)


def realised(c: Candidates) -> Design:
    """The design of one candidate (the first); [element]'s hinge is the first kind's, others override."""
    d, grip = c.stand.base, c.stand.target.grasp
    kinds = dealt(c)
    arms = [round(round(a / ARM) * ARM, 6) for a in c.arm[0]]
    thick = [round(round(t / THICKNESS) * THICKNESS, 6) for t in c.thickness[0]]
    numbered = [k for row in kinds for k in row]
    override = {
        n: Hinge(hinge_thickness=thick[k]) for n, k in enumerate(numbered, start=1) if thick[k] != thick[0]
    }
    force = float(c.largest_force[0].max())
    rating = ceil(force * 100) / 100 if np.isfinite(force) else grip.force
    calibration = d.calibration
    if calibration is not None and c.steps[0, 0] >= 1:
        calibration = replace(calibration, travel=round(float(c.steps[0, 0]) * calibration.step, 6))
    made = replace(
        d,
        array=replace(d.array, row_arms=tuple(tuple(arms[k] for k in row) for row in kinds)),
        element=replace(
            d.element,
            hinge_thickness=thick[0],
            hinge_length=round(float(c.slot[0]), 6),
            fillet_radius=round(float(c.radius[0]), 6),
            override=override,
        ),
        rating=replace(d.rating, force=rating),
        calibration=calibration,
    )
    known = paths(made)  # the base design may say where values are from that this one lacks
    return replace(made, origin={path: text for path, text in made.origin.items() if path in known})


def origins(base: Design, made: Design, binding: str) -> dict[str, str]:
    """Where every value that differs from the base design's is from, by its path."""
    before, after = paths(base), paths(made)
    told = {path: f"synthesised from a target, on {base.name}; {binding}" for path in SEARCHED}
    told |= {
        "design.name": "chosen: the target's",
        "design.title": "chosen: the target's",
        "design.revision": "chosen: first issue",
        "array.pitch": "synthesised: at least the target's pitch, the sheet's and a spacer's thickness",
        "array.row_pitch": "synthesised: at least the target's pitch",
        "array.spacer": "derived: pitch less sheet",
        "rating.force": "synthesised: largest force on one element over the object's range",
        "rating.overload_force": "chosen: the target's overload",
        "calibration.travel": "synthesised: what every hinge bears",
        "sheet.thickness": "chosen: of the target's stock",
        "tolerance.hinge_thickness": "chosen: of the target's stock",
        "tolerance.youngs_modulus": "chosen: the material's row",
    }
    told |= {path: "chosen: of the target's stock" for path in after if path.startswith("material.")}
    changed = {path for path, value in after.items() if before.get(path) != value}
    always = {"design.name", "design.title", "design.revision", *SEARCHED}
    by_element = "synthesised: the other kind of element, as element.hinge_thickness"
    return {p: told.get(p, by_element) for p, v in after.items() if v is not None and p in changed | always}


SEARCHED = ("array.row_arms", "element.hinge_thickness", "element.hinge_length", "element.fillet_radius")
