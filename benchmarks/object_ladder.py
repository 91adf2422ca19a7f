"""How far the rungs of the object's ladder err: `tactcad.contact`'s data, and the tables of docs/accuracy.md.

    python benchmarks/object_ladder.py src/tactcad/contact/data/errors.json docs/accuracy.md

An error is the largest difference of a pad's force over the mean force of the pads that touch. Held-out
scenes draw arrays by chance; climbs change one scene at a time and keep changes that raise the error.
"""

from __future__ import annotations

import json
import sys
from dataclasses import dataclass, replace
from math import inf
from pathlib import Path

import numpy as np
import tilted_strip
from tables import filled, lines

from tactcad.contact import large_strain, springs
from tactcad.contact.elastic_body import Body
from tactcad.contact.press import Face, Pads, PadsOnBody, Pressed, pad_stiffness
from tactcad.design.files import write_whole

BODIES = ((0.3, 6.0), (0.45, 3.0), (0.49, 1.0), (0.4999, 4.0))  # nu, thickness (mm)
SCENES = 10  # for each of them
PLACES = ((2.0, 0.0), (-2.0, 0.0), (2.0, 4.0), (-2.0, 4.0), (2.0, 8.0), (-2.0, 8.0))
HARDNESS = (0.0, 0.01, 0.03, 0.1, 0.3, 1.0)  # zones of K/(K + K_obj), of the stiffest element
DEPTHS = (0.05, 0.1, 0.2, 0.3)  # of the lesser of a pad's radius and the thickness
DEEP = (*DEPTHS, 0.5)  # of rung large
# Radii from a round pad's middle to halfway between it and its neighbours: pads of 2 x 3 mm on macro-array's
# grid of 4 x 4.5 mm have 1.73.
CLOSEST = 1.7
THICKNESSES = (0.44, 1.0, 3.0, 20.0)  # zones, in radii; rung layer reaches no thinner layer
STEPS = 25  # of a climb
MARGIN = 1.25  # factor of the stated over the largest error found


def array(rng: np.random.Generator) -> Pads:
    """Two to six pads of 2 x 3 mm, each on a lever that turns as it sinks; heights differ by some um."""
    x, y = np.array(PLACES[: rng.integers(2, 7)]).T
    K = np.exp(rng.uniform(np.log(0.5), np.log(50), len(x)))
    move = np.stack([np.ones(len(x)), -np.sign(x) / rng.uniform(2.5, 8, len(x)), np.zeros(len(x))], axis=1)
    compliance = move[:, :, None] * move[:, None, :] / K[:, None, None]
    return Pads(x, y, 2.0, 3.0, compliance, rng.uniform(0, 0.01, len(x)), np.full(len(x), inf))


def difference(found: np.ndarray, right: np.ndarray) -> float:
    return float(np.abs(found - right).max() / right[right > 0].mean())


def by_layer(pads: Pads, body: Body, depth: float, angle: tuple[float, float]) -> Pressed:
    return PadsOnBody(pads, body).press(approach=depth, angle=angle)


@dataclass(frozen=True)
class Scene:
    """An array pressed by a load (N) on a body of a modulus (MPa), inclined (degrees)."""

    pads: Pads
    load: float
    modulus: float
    angle: tuple[float, float]

    @staticmethod
    def drawn(rng: np.random.Generator) -> Scene:
        """E 0.01 to 10 MPa, inclined up to 3 degrees."""
        pads, E = array(rng), float(np.exp(rng.uniform(np.log(0.01), np.log(10))))
        x, y = rng.uniform(-3, 3, 2)
        return Scene(pads, float(rng.uniform(0.2, 3)), E, (float(x), float(y)))

    def changed(self, rng: np.random.Generator) -> Scene:
        """A scene near this one, in the same limits."""
        K = np.exp(rng.normal(0, 0.4, len(self.pads.x)))
        pads = replace(self.pads, compliance=self.pads.compliance * K[:, None, None])
        load = float(np.clip(self.load * np.exp(rng.normal(0, 0.4)), 0.2, 3))
        E = float(np.clip(self.modulus * np.exp(rng.normal(0, 0.7)), 0.01, 10))
        x, y = np.clip(self.angle + rng.normal(0, 0.6, 2), -3, 3)
        return Scene(pads, load, E, (float(x), float(y)))


class AgainstElements:
    """Rung layer against rung fem-object on one body: the whole field of pads is set up once, and an array
    takes its own pads from it."""

    def __init__(self, body: Body) -> None:
        x, y = np.array(PLACES).T
        some = array(np.random.default_rng(0))
        self.body, self.full = body, PadsOnBody(replace(some, x=x, y=y), body, "fem-object").face

    def error(self, at: Scene) -> float:
        flat, right = (PadsOnBody(at.pads, self.body) for _ in range(2))
        n = len(at.pads.x)
        right.face = Face(self.full.blocks, self.full.place[:n, :n])
        a, b = (p.press(load=at.load, angle=at.angle, modulus=at.modulus) for p in (flat, right))
        return difference(a.force, b.force)

    def climb(self, rng: np.random.Generator, steps: int) -> tuple[float, float]:
        """The largest error of SCENES drawn, and the largest that a climb from the worst of them found."""
        drawn = [Scene.drawn(rng) for _ in range(SCENES)]
        errors = [self.error(at) for at in drawn]
        best, at = max(errors), drawn[int(np.argmax(errors))]
        for _ in range(steps):
            near = at.changed(rng)
            if (error := self.error(near)) > best:
                best, at = error, near
        return max(errors), best


def layer_against_elements(seed: int = 31, steps: int = STEPS) -> list[tuple[Body, float, float]]:
    """Each body with the largest error of scenes drawn and of a climb."""
    rng, rows = np.random.default_rng(seed), []
    for nu, h in BODIES:
        rows.append((Body(1.0, nu, h), *AgainstElements(Body(1.0, nu, h)).climb(rng, steps)))
        print(*rows[-1], flush=True)
    return rows


def springs_error(pads: Pads, body: Body, angle: tuple[float, float]) -> tuple[float, float]:
    """K/(K + K_obj) of the stiffest element, and the springs' error under 1 N."""
    K = 1 / pads.compliance[:, 0, 0]
    alone = pad_stiffness(body, pads.length, pads.width)
    right = PadsOnBody(pads, body).press(load=1.0, angle=angle)
    back = pads.height + pads.x * np.tan(np.radians(angle[0])) + pads.y * np.tan(np.radians(angle[1]))
    force = springs.press(K, alone, np.ones(1), back, pads.stop)[1][:, 0]
    return float(K.max() / (K.max() + alone)), difference(force, right.force)


def climb_of_springs(low: float, high: float, seed: int = 7) -> float:
    """The largest error of springs found with a hardness from low to high, inclined up to 1 degree."""
    rng = np.random.default_rng(seed)
    best = 0.0
    kept: Pads | None = None
    for _ in range(STEPS):
        fresh = array(rng) if kept is None or rng.random() < 0.3 else kept
        scale = np.exp(rng.normal(0, 0.3, len(fresh.x)))
        pads = replace(fresh, compliance=fresh.compliance * scale[:, None, None])
        nu, h = float(rng.choice([0.3, 0.45, 0.49])), float(np.exp(rng.uniform(np.log(1.5), np.log(40))))
        share = rng.uniform(max(low, high / 10), high)
        K = float((1 / pads.compliance[:, 0, 0]).max())
        E = K * (1 / share - 1) / pad_stiffness(Body(1.0, nu, h), 2.0, 3.0)
        error = springs_error(pads, Body(E, nu, h), tuple(rng.uniform(-1, 1, 2)))[1]
        if error > best:
            best, kept = error, pads
    return best


def climb_of_strain(low: float, high: float, seed: int = 3, steps: int = STEPS) -> list[float]:
    """The largest departure from linear theory found, by depth, with thicknesses of low to high radii. A law
    that ends before a depth, where an element folds, gives no error for that depth: the rung refuses it."""
    rng = np.random.default_rng(seed)
    best, kept = np.zeros(len(DEPTHS)), (0.49, low)
    for step in range(steps):
        if step < steps // 2:
            nu, h = rng.uniform(0.3, 0.4999), float(np.exp(rng.uniform(np.log(low), np.log(high))))
        else:  # near the worst yet
            nu = min(kept[0] + 0.02 * rng.normal(), 0.4999)
            h = float(np.clip(kept[1] * np.exp(0.3 * rng.normal()), low, high))
        depth, factor = large_strain.hardening(Body(1.0, nu, h), 1.0)
        at = np.array(DEPTHS) * min(1.0, h)
        found = np.where(at <= depth[-1], np.abs(np.interp(at, depth, factor) - 1), 0.0)
        if found[-1] > best[-1]:
            kept = (nu, h)
        best = np.maximum(best, found)
    return [float(b) for b in best]


def departure(nu: float, thickness: float, wall: float) -> tuple[np.ndarray, np.ndarray]:
    """By depth, how far a round pad's force in an endless grid, `wall` (radii) halfway between pads, departs
    from linear theory and from rung large; thickness in radii. A depth that is not reached, as an element
    folds, counts as 0: the rung refuses it."""
    body = Body(1.0, nu, thickness)
    at = np.array(DEEP) * min(1.0, thickness)
    alone, grid = (large_strain.initial_stiffness(body, 1.0, w) for w in (None, wall))
    approach = at * alone / grid  # at which a pad of the grid bears what presses one alone by `at`
    depth, force = large_strain.punch(body, 1.0, float(approach[-1]), wall)
    over = np.interp(approach, depth, force) / (grid * approach)
    reached, factor = large_strain.hardening(body, 1.0)
    known = (approach <= depth[-1] * (1 + 1e-9)) & (at <= reached[-1] * (1 + 1e-9))
    linear, large = (np.abs(over / by - 1) for by in (1.0, np.interp(at, reached, factor)))
    return np.where(known, linear, 0.0), np.where(known, large, 0.0)


def climb_of_neighbours(low: float, high: float, seed: int = 5, steps: int = STEPS) -> np.ndarray:
    """The largest departure of rung large found in grids, by DEEP, with thicknesses of low to high radii."""
    rng = np.random.default_rng(seed)
    best, kept = np.zeros(len(DEEP)), (0.49, low, CLOSEST)
    for step in range(steps):
        if step < steps // 2:
            nu, h = rng.uniform(0.3, 0.4999), float(np.exp(rng.uniform(np.log(low), np.log(high))))
            wall = float(rng.uniform(CLOSEST, 3.0))
        else:  # near the worst yet
            nu = float(np.clip(kept[0] + 0.02 * rng.normal(), 0.3, 0.4999))
            h = float(np.clip(kept[1] * np.exp(0.3 * rng.normal()), low, high))
            wall = float(max(kept[2] * np.exp(0.2 * rng.normal()), CLOSEST))
        found = departure(nu, h, wall)[1]
        if found[-2] > best[-2]:
            kept = (nu, h, wall)
        best = np.maximum(best, found)
    return np.maximum.accumulate(best)  # a depth at which most fold errs no less than one before


def main(data: Path, page: Path) -> None:
    layer = layer_against_elements()
    of_springs = [climb_of_springs(low, high) for low, high in zip(HARDNESS, HARDNESS[1:])]
    of_strain = [climb_of_strain(low, high) for low, high in zip(THICKNESSES, THICKNESSES[1:])]
    elements = max(climbed for *_, climbed in layer)
    of_neighbours = [climb_of_neighbours(low, high) for low, high in zip(THICKNESSES, THICKNESSES[1:])]
    errors = {
        "layer": max(MARGIN * elements, 0.004),
        "fem-object": max(MARGIN * elements, 0.004),
        "hardness": HARDNESS[1:],
        "springs": [MARGIN * e for e in of_springs],
        "depth": (0.0, *DEPTHS),
        "thickness": THICKNESSES[1:-1],
        "strain": [[0.0, *(MARGIN * e for e in zone)] for zone in of_strain],
        "deep": (0.0, *DEEP),
        "neighbours": [[0.0, *(MARGIN * e for e in zone)] for zone in of_neighbours],
        "tilt": [MARGIN * e for e in tilted_strip.coefficients()],  # its thicknesses are those of the zones
    }
    write_whole(data, (json.dumps(errors, indent=1) + "\n").encode())
    held = [
        (f"{b.poisson:g}", f"{b.thickness:g}", SCENES, f"{drawn:.2%}", f"{climbed:.2%}")
        for b, drawn, climbed in layer
    ]
    soft = [(f"{z:g}", f"{e:.2g}", f"{MARGIN * e:.2g}") for z, e in zip(HARDNESS[1:], of_springs)]
    deep = [
        (f"{low:g} to {high:g}", of, *(f"{e:.2g}" for e in errors[of][k][1:]), *[""] * (of == "strain"))
        for k, (low, high) in enumerate(zip(THICKNESSES, THICKNESSES[1:]))
        for of in ("strain", "neighbours")
    ]
    text = page.read_text("utf-8")
    heads = "nu | thickness, mm | scenes | layer against fem-object, largest | by a climb"
    text = filled(text, "object held out", lines(heads, held))
    text = filled(
        text, "object springs", lines("K/(K + K_obj) up to | springs, largest found | stated", soft)
    )
    heads = "thickness, radii | of | " + " | ".join(f"depth {d:g}" for d in DEEP)
    write_whole(page, filled(text, "object strain", lines(heads, deep)).encode())


if __name__ == "__main__":
    main(Path(sys.argv[1]), Path(sys.argv[2]))
