"""Pairs of parts whose verdict is known in closed form: overlap, touch or clear, at gaps from 0.1 mm to 0.1
um.

Every pair is turned and moved at random, and round parts about their own axis too, so that facets of two
meshes meet in every way that they can.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from math import acos, hypot, pi, sqrt

import numpy as np

from tactcad.contour import circle, rectangle
from tactcad.parts.language.description import Extrusion, Material, Part, vector
from tactcad.scenes.scene import Placement, Rotation, Scene, rotation

STEEL = Material("steel", 7850.0)
GAPS = (-0.1, -0.01, -0.001, -0.0001, 0.0, 0.0001, 0.001, 0.01, 0.1)  # mm; negative: they overlap by so much
ALONG_X = ((0.0, 0.0, 1.0), (0.0, 1.0, 0.0), (-1.0, 0.0, 0.0))  # local z runs along x


@dataclass(frozen=True)
class KnownPair:
    """Two placed parts: their kind, the gap between them (mm), and the volume that they share (mm3)."""

    kind: str
    gap: float
    overlap: float
    placements: tuple[Placement, Placement]

    @property
    def verdict(self) -> str:
        return "overlap" if self.gap < 0.0 else "touch" if self.gap == 0.0 else "clear"

    @property
    def scene(self) -> Scene:
        return Scene(self.kind, self.placements)


def known_pairs(rounds: int, seed: int) -> Iterator[KnownPair]:
    """Every kind at every gap, `rounds` times, each time placed and sized anew."""
    rng = np.random.default_rng(seed)
    for _ in range(rounds):
        for kind, make in KINDS.items():
            for gap in GAPS:
                overlap, first, second = make(gap, rng)
                yield KnownPair(kind, gap, overlap, _thrown((first, second), rng))


def box_on_box(gap: float, rng: np.random.Generator) -> tuple[float, Placement, Placement]:
    """Two blocks face to face, shifted sideways."""
    a, b, shift = rng.uniform(3, 10, 3), rng.uniform(3, 10, 3), rng.uniform(-2, 2, 2)
    common = np.minimum(a[:2] / 2, shift + b[:2] / 2) - np.maximum(-a[:2] / 2, shift - b[:2] / 2)
    first, second = _block("A", *a), _block("B", *b)
    return (
        float(max(-gap, 0.0) * np.prod(common)),
        Placement("A", first),
        Placement("B", second, (*shift, a[2] + gap)),
    )


def pin_in_hole(gap: float, rng: np.random.Generator) -> tuple[float, Placement, Placement]:
    """A pin in a bore, out of the middle by some of the play: the least gap is at one side."""
    bore, height = rng.uniform(1.0, 3.0), rng.uniform(2.0, 6.0)
    off = rng.choice([0.0, 0.02])
    pin = bore - gap - off
    body = Extrusion(rectangle(-6, -6, 6, 6), height, (circle((0.0, 0.0), 2 * bore),))
    overlap = (pi * pin * pin - lens(pin, bore, off)) * height
    return (
        overlap,
        Placement("A", _part("A", body)),
        Placement("B", _rod("B", pin, height + 4.0), (off, 0.0, -2.0), _spun(rng)),
    )


def pin_beside_pin(gap: float, rng: np.random.Generator) -> tuple[float, Placement, Placement]:
    """Two pins with parallel axes."""
    r, s, height = *rng.uniform(0.8, 3.0, 2), rng.uniform(2.0, 6.0)
    overlap = lens(r, s, r + s + gap) * height
    return (
        overlap,
        Placement("A", _rod("A", r, height), rotation=_spun(rng)),
        Placement("B", _rod("B", s, height), (r + s + gap, 0, 0), _spun(rng)),
    )


def pin_on_plate(gap: float, rng: np.random.Generator) -> tuple[float, Placement, Placement]:
    """A pin that lies on a plate's face."""
    r, length = rng.uniform(0.8, 3.0), rng.uniform(2.0, 6.0)
    sunk = max(-gap, 0.0)
    segment = r * r * acos((r - sunk) / r) - (r - sunk) * sqrt(max(2 * r * sunk - sunk * sunk, 0.0))
    turn = rotation((np.array(ALONG_X) @ np.array(_spun(rng))).tolist())
    return (
        segment * length,
        Placement("A", _block("A", 16.0, 16.0, 3.0)),
        Placement("B", _rod("B", r, length), (-length / 2, 0.0, 3.0 + r + gap), turn),
    )


KINDS: dict[str, Callable] = {
    "box on box": box_on_box,
    "pin in its hole": pin_in_hole,
    "pin beside pin": pin_beside_pin,
    "pin on a plate": pin_on_plate,
}


def lens(r: float, s: float, d: float) -> float:
    """Area (mm2) that two circles of radii r and s with centres d apart (mm) have in common."""
    if d >= r + s:
        return 0.0
    if d <= abs(r - s):
        return pi * min(r, s) ** 2
    a, b = (d * d + r * r - s * s) / (2 * d * r), (d * d + s * s - r * r) / (2 * d * s)
    return r * r * _segment(a) + s * s * _segment(b)


def _segment(cosine: float) -> float:
    """Area of the unit circle beyond a chord at that distance: acos c - c sqrt(1 - c^2)."""
    return acos(cosine) - cosine * sqrt((1 - cosine) * (1 + cosine))


def _block(name: str, x: float, y: float, z: float) -> Part:
    return _part(name, Extrusion(rectangle(-x / 2, -y / 2, x / 2, y / 2), z))


def _rod(name: str, radius: float, height: float) -> Part:
    return _part(name, Extrusion(circle((0.0, 0.0), 2 * radius), height))


def _part(name: str, body: Extrusion) -> Part:
    return Part(name, name, "milled", STEEL, body)


def _spun(rng: np.random.Generator) -> Rotation:
    """A random turn about z."""
    x, y = rng.normal(size=2)
    c, s = x / hypot(x, y), y / hypot(x, y)
    return ((c, -s, 0.0), (s, c, 0.0), (0.0, 0.0, 1.0))


def _thrown(pair: tuple[Placement, Placement], rng: np.random.Generator) -> tuple[Placement, Placement]:
    """Both moved and turned as one, by a random rotation (QR of a normal matrix)."""
    q, r = np.linalg.qr(rng.normal(size=(3, 3)))
    q *= np.sign(np.diag(r))
    q[:, 2] *= np.linalg.det(q)
    shift = rng.uniform(-50, 50, 3)
    first, second = (
        Placement(
            p.designator,
            p.part,
            vector((q @ np.array(p.origin) + shift).tolist()),
            rotation((q @ np.array(p.rotation)).tolist()),
        )
        for p in pair
    )
    return first, second
