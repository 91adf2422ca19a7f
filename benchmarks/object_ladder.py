"""How far the rungs of the object's ladder err: `tactcad.contact`'s data, and the tables of docs/accuracy.md.

    python benchmarks/object_ladder.py src/tactcad/contact/data/errors.json docs/accuracy.md

An error is the largest difference of a pad's force over the mean force of the pads that touch. Held-out
scenes draw arrays by chance; climbs change one scene at a time and keep changes that raise the error.
"""

from __future__ import annotations

import json
import sys
from dataclasses import replace
from math import inf
from pathlib import Path

import numpy as np
from tables import filled, lines

from tactcad.contact import large_strain, springs
from tactcad.contact.elastic_body import Body
from tactcad.contact.press import Pads, PadsOnBody, Pressed, pad_stiffness
from tactcad.design.files import write_whole

BODIES = ((0.3, 6.0), (0.45, 3.0), (0.49, 1.0), (0.4999, 4.0))  # nu, thickness (mm)
SCENES = 10  # for each of them
PLACES = ((2.0, 0.0), (-2.0, 0.0), (2.0, 4.0), (-2.0, 4.0), (2.0, 8.0), (-2.0, 8.0))
HARDNESS = (0.0, 0.01, 0.03, 0.1, 0.3, 1.0)  # zones of K/(K + K_obj), of the stiffest element
DEPTHS = (0.05, 0.1, 0.2, 0.3)  # of the lesser of a pad's radius and the thickness
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


def layer_against_elements(seed: int = 31) -> list[tuple[Body, float]]:
    """Body and error of the layer on SCENES arrays drawn for each, E 0.01 to 10 MPa, inclined
    up to 3 degrees. The whole field of pads is set up once, and an array takes its own of it."""
    rng = np.random.default_rng(seed)
    rows = []
    for nu, h in BODIES:
        body = Body(1.0, nu, h)
        full = None
        for _ in range(SCENES):
            pads = array(rng)
            E = float(np.exp(rng.uniform(np.log(0.01), np.log(10))))
            angle = tuple(rng.uniform(-3, 3, 2))
            flat = PadsOnBody(pads, body)
            if full is None:
                whole = replace(pads, x=np.array(PLACES)[:, 0], y=np.array(PLACES)[:, 1])
                full = PadsOnBody(whole, body, "fem-object").face
            right = PadsOnBody(pads, body)
            right.face = full[: len(flat.face), : len(flat.face)]
            loads = {"load": float(rng.uniform(0.2, 3)), "angle": angle, "modulus": E}
            a, b = flat.press(**loads), right.press(**loads)
            rows.append((body, difference(a.force, b.force)))
            print(body, rows[-1][1], flush=True)
    return rows


def springs_error(pads: Pads, body: Body, angle: tuple[float, float]) -> tuple[float, float]:
    """K/(K + K_obj) of the stiffest element, and the springs' error under 1 N."""
    K = 1 / pads.compliance[:, 0, 0]
    alone = pad_stiffness(body, pads.length, pads.width)
    right = PadsOnBody(pads, body).press(load=1.0, angle=angle)
    back = pads.height + pads.x * np.tan(np.radians(angle[0])) + pads.y * np.tan(np.radians(angle[1]))
    force = springs.press(K, back, pads.stop, alone, 1.0)[1]
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


def main(data: Path, page: Path) -> None:
    layer = layer_against_elements()
    of_springs = [climb_of_springs(low, high) for low, high in zip(HARDNESS, HARDNESS[1:])]
    of_strain = [climb_of_strain(low, high) for low, high in zip(THICKNESSES, THICKNESSES[1:])]
    elements = max(error for _, error in layer)
    errors = {
        "layer": max(MARGIN * elements, 0.004),
        "fem-object": max(MARGIN * elements, 0.004),
        "hardness": HARDNESS[1:],
        "springs": [MARGIN * e for e in of_springs],
        "depth": (0.0, *DEPTHS),
        "thickness": THICKNESSES[1:-1],
        "strain": [[0.0, *(MARGIN * e for e in zone)] for zone in of_strain],
    }
    write_whole(data, (json.dumps(errors, indent=1) + "\n").encode())
    held = [
        (
            f"{nu:g}",
            f"{h:g}",
            SCENES,
            f"{max(e for b, e in layer if (b.poisson, b.thickness) == (nu, h)):.2%}",
        )
        for nu, h in BODIES
    ]
    soft = [(f"{z:g}", f"{e:.2g}", f"{MARGIN * e:.2g}") for z, e in zip(HARDNESS[1:], of_springs)]
    deep = [
        (f"{low:g} to {high:g}", *(f"{MARGIN * e:.2g}" for e in zone))
        for low, high, zone in zip(THICKNESSES, THICKNESSES[1:], of_strain)
    ]
    text = page.read_text("utf-8")
    heads = "nu | thickness, mm | scenes | layer against fem-object, largest"
    text = filled(text, "object held out", lines(heads, held))
    text = filled(
        text, "object springs", lines("K/(K + K_obj) up to | springs, largest found | stated", soft)
    )
    heads = "thickness, radii | " + " | ".join(f"depth {d:g}" for d in DEPTHS)
    write_whole(page, filled(text, "object strain", lines(heads, deep)).encode())


if __name__ == "__main__":
    main(Path(sys.argv[1]), Path(sys.argv[2]))
