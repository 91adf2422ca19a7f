"""Rung `layer` against ContactMechanics (MIT), which is not installed with tactcad: for the poses at which
the pads of random arrays come to rest, that code's own forces.

    pip install ContactMechanics
    python benchmarks/contact_mechanics.py 100

Four bodies of five are half-spaces (free boundaries), the fifth is a bonded layer of 0.75 to 1.6 mm
(periodic, with GAP between images).
"""

from __future__ import annotations

import sys
from math import inf, radians, tan

import numpy as np
from object_ladder import Scene, difference

from tactcad.contact.elastic_body import Body
from tactcad.contact.press import PadsOnBody, Pressed

CELL = 0.025  # mm, a whole part of the pads' sides: 0.24 % softer than a square punch, with 0.05 twice that
GAP = 10.0  # mm, six thicknesses and more; at four, images change forces by 0.3 %
DEEPEST = 0.1  # mm, to which the poses are scaled: the body is linear


def forces(at: Scene, body: Body, p: Pressed) -> np.ndarray:
    """Of every pad at its pose, by ContactMechanics, N."""
    from ContactMechanics import FreeFFTElasticHalfSpace, PeriodicFFTElasticHalfSpace, make_system
    from SurfaceTopography import Topography

    pads, free = at.pads, body.thickness == inf
    around = CELL if free else GAP / 2
    half = np.array([pads.length, pads.width]) / 2
    low = np.array([pads.x.min(), pads.y.min()]) - half - around
    number = np.round((np.array([pads.x.max(), pads.y.max()]) + half + around - low) / CELL).astype(int)
    x, y = (low[i] + CELL * (np.arange(number[i]) + 0.5) for i in (0, 1))
    X, Y = np.meshgrid(x, y, indexing="ij")
    depth, under = np.full(X.shape, -1e3), []
    for i in range(len(pads.x)):
        on = (np.abs(X - pads.x[i]) < half[0]) & (np.abs(Y - pads.y[i]) < half[1])
        back = pads.height[i] + X * tan(radians(at.angle[0])) + Y * tan(radians(at.angle[1]))
        moved = p.sink[i] + p.slope[i, 0] * (X - pads.x[i]) + p.slope[i, 1] * (Y - pads.y[i])
        depth[on] = (p.approach - back - moved)[on]
        under.append(on)
    scale = DEEPEST / depth.max()
    size = tuple(number * CELL)
    substrate = (
        FreeFFTElasticHalfSpace(tuple(number), at.modulus / (1 - body.poisson**2), size)
        if free
        else PeriodicFFTElasticHalfSpace(
            tuple(number), at.modulus, size, thickness=body.thickness, poisson=body.poisson
        )
    )
    surface = Topography(np.maximum(depth * scale, -1.0), size, periodic=not free)
    found = make_system(interaction="hardwall", substrate=substrate, surface=surface).minimize_proxy(
        offset=0.0, pentol=1e-5
    )
    if not found.success:
        raise RuntimeError(f"ContactMechanics: {found.message}")
    return np.array([found.jac[on].sum() for on in under]) / scale


def main(number: int) -> None:
    rng, errors = np.random.default_rng(100), []
    for k in range(number):
        at = Scene.drawn(rng)
        nu, thick = float(rng.uniform(0.3, 0.49)), float(rng.uniform(0.75, 1.6))
        body = Body(1.0, nu, inf if k % 5 else thick)
        p = PadsOnBody(at.pads, body).press(load=at.load, angle=at.angle, modulus=at.modulus)
        errors.append(difference(forces(at, body, p), p.force))
        lifted = int((p.contact < 1).sum())
        print(f"{k} {body.thickness:.2f} mm, nu {nu:.2f}: {errors[-1]:.3%}, {lifted} lifted", flush=True)
    for name, of in (("layers", errors[::5]), ("half-spaces", [e for k, e in enumerate(errors) if k % 5])):
        print(f"{len(of)} {name}: median {np.median(of):.2%}, largest {max(of):.2%}")


if __name__ == "__main__":
    main(int(sys.argv[1]))
