"""Facing rows for robots: every arm on the hinge about which the estimator turns it."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from itertools import pairwise

import numpy as np

from tactcad.circuit.element_signals import reading_noise
from tactcad.contour.cut import cut
from tactcad.design.tree import Design
from tactcad.lab.pads import springs_of
from tactcad.mechanics.strength import tip_compliance
from tactcad.parts.array.hinge_section import arms, hinge_section
from tactcad.parts.array.layout import ElementPlace, Layout
from tactcad.parts.array.stop_gap import stop_gap
from tactcad.parts.language.description import Extrusion, Part
from tactcad.scenes.scene import DOWN

from .mechanism import ElementJoint, Mechanism, Moving, array_seen
from .taxel_table import Taxel


def cantilevers(design: Design) -> Mechanism:
    """The array from its carrier's upper face, on the robot's flange.

    The hinge lies level with the leaf's middle, at the distance from the pad's middle that gives the
    estimator's deflections of pad and tip: the stop closes at its gap at the tip, and K at the pad's middle
    is the estimate. All on the pad's side of the leaf's middle moves. The pad touches by a ball whose middle
    is level with the hinge, so that a rigid face presses at the pad's middle, as in the estimate, at any turn
    of the arm.

    Raises CheckFailure if an element is out of the estimator's range.
    """
    layout, e, width = Layout(design), design.element, design.sheet.thickness
    springs, signal = springs_of(design)
    K = 1 / springs.compliance[:, 0, 0]
    tip = tip_compliance(hinge_section(layout, layout.elements), K, arms(layout))
    flange = np.array([0.0, 0.0, layout.carrier_bottom + design.clamp.carrier_thickness])
    placed = array_seen(design, flange, np.array(DOWN))
    noise, beside, moving = reading_noise(layout, alike=True), [*_neighbours(layout.elements)], []
    for i, p in enumerate(layout.elements):
        whole = placed[p.designator]
        arm, body = _parted(whole.part, p.hinge_x)
        placed[p.designator] = replace(whole, part=body)
        half = p.arm - p.load_arm  # of the pad's length
        lever = half / (tip[i] * K[i] - 1)  # hinge to pad's middle
        hinge_z = p.hinge.t / 2 if e.sides == "one" else p.hinge.h / 2
        level = e.pad_height + hinge_z
        pad = np.array(DOWN) @ (springs.x[i], springs.y[i], -e.pad_height - flange[2])
        back = p.row == 1  # the pad's x runs from hinge to tip
        turn = np.diag([-1.0, -1.0, 1.0]) if back else np.eye(3)
        reach = springs.stop[i] / lever
        taxel = Taxel(  # type: ignore[call-arg]  # the starred ones have a known length
            p.number,
            p.designator,
            "cantilever",
            *(pad + 0.0).tolist(),
            *((0.0, 0.0, 0.0, 1.0) if back else (1.0, 0.0, 0.0, 0.0)),
            *turn[:, 2].tolist(),
            e.pad_length,
            width,
            e.pad_length * width,
            float(K[i]),
            float(signal[i]),
            noise,
            float(springs.stop[i]),
            stop_gap(layout, p),
            (f"{p.designator}_hinge",),
            (float(lever),),
            tuple(sorted(b if a == p.number else a for a, b in beside if p.number in (a, b))),
        )
        hinge = ElementJoint(taxel.joints[0], "hinge", (0.0, 1.0, 0.0), float(K[i] * lever**2), float(reach))
        top = hinge_z - arm.extrusion.outer.box[3]
        least, most = (lever + half - p.arm, -width / 2, top), (lever + half, width / 2, hinge_z)
        at, box = np.array([-lever, 0.0, -level]), np.array([least, most])
        moving.append(Moving(taxel, turn, at, (hinge,), (replace(whole, part=arm),), box, level))
    return Mechanism(design, tuple(placed.values()), tuple(moving))


def _parted(part: Part, x: float) -> tuple[Part, Part]:
    """The moving and the fixed part of an element, cut at the leaf's middle."""
    whole = part.extrusion

    def piece(name: str, side: str, openings: tuple) -> Part:
        (outer,) = cut(whole.outer, "x", x, side)  # type: ignore[arg-type]
        body, number = Extrusion(outer, whole.thickness, openings), f"{part.part_no}-{name}"
        return Part(number, f"{part.name}: {name}", "wire-cut", part.material, body, colour=part.colour)

    return piece("arm", "below", ()), piece("body", "above", whole.openings)


def _neighbours(places: tuple[ElementPlace, ...]) -> Iterator[tuple[int, int]]:
    """Numbers of pads side by side in a row, and of facing ones: row two is row one turned by 180 degrees."""
    yield from ((a.number, b.number) for a, b in pairwise(places) if a.row == b.row)
    second = {-p.y: p.number for p in places if p.row == 2}
    yield from ((p.number, second[p.y]) for p in places if p.row == 1 and p.y in second)
