"""A foil beam between a rigid island and a clamped frame: six stiffnesses, in closed form.

The beam is symmetric, so the relative motions of its ends do not mix: stretch, twist, and bending out of the
foil's plane and in it, each with even moments (bend) and with a guided end (shear)::

         frame |\\_________________________/| island      s between the edges, w wide, t thick,
               | _________________________  |             fillets r at all four corners
               |/                         \\|

Etching leaves bevels: w at half the thickness, 2 c less on either face, straight between them.
"""

from __future__ import annotations

import csv
import json
from dataclasses import dataclass
from functools import cache, lru_cache
from math import log, pi
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Whole = NDArray[np.int64]
MODES = ("axial", "twist", "bend_out", "shear_out", "bend_in", "shear_in")
DATA = Path(__file__).parent / "data"
# Parts of the foil's surface on which a mode's stress can be largest: in the fillets up to 0.3 of their
# radius off the clamped edge ("root") or between them ("span"); of the face by shares of the half width to
# 0.5, 0.97 and 1, and the beam's side.
STRESSED = {
    "axial": ("root side",),
    "twist": ("root beside", "root edge", "span inside", "span beside"),
    "bend_out": ("root inside", "root edge", "span beside"),
    "shear_out": ("root inside", "root beside", "root edge"),
    "bend_in": ("root side",),
    "shear_in": ("root side",),
}
KEPT = 256  # beams whose figures are kept: rules and searches ask for the same one again and again
BEVEL = 0.2  # thicknesses: what data/beam-bevel.csv was solved with; less bevel changes less in proportion
KAPPA = 5.0 / 6.0  # Reissner's shear factor of a rectangle


@dataclass(frozen=True)
class FoilBeam:
    """Length s, width w, thickness t and fillet radius r, mm; E, MPa, and Poisson's ratio; bevel c, mm."""

    length: float
    width: float
    thickness: float
    fillet: float
    youngs_modulus: float
    poisson: float
    bevel: float = 0.0


gauss = cache(np.polynomial.legendre.leggauss)  # points and weights from -1 to 1


def sections(beam: FoilBeam, points: int = 24) -> tuple[Array, Array, Array]:
    """Gauss points of the half 0 <= x <= s/2, their weights, and the width there, mm: w + 2 r (1 - cos phi)
    in the fillet, x = s/2 - r + r sin phi."""
    at, weight = gauss(points)
    at, weight = (at + 1.0) / 2.0, weight / 2.0
    straight, r = beam.length / 2.0 - beam.fillet, beam.fillet
    phi = pi / 2.0 * at
    x = np.concatenate([straight * at, straight + r * np.sin(phi)])
    dx = np.concatenate([straight * weight, r * np.cos(phi) * pi / 2.0 * weight])
    width = np.concatenate([np.full(points, beam.width), beam.width + 2.0 * r * (1.0 - np.cos(phi))])
    return x, dx, width


def torsion_constant(width: Array, thickness: float, bevel: float = 0.0) -> Array:
    """J = w t^3/3 (1 - k t/w (1 - t^4/(12 (w - c/2)^4))), mm4; k = 0.630 of a rectangle: Roark's Formulas for
    Stress and Strain, within 0.3 % of Saint-Venant's series for w >= t. What a bevel c adds is fitted: within
    0.5 % of elements of Poisson's equation for w >= 1.5 t, c <= 0.3 t."""
    c = bevel / thickness
    ends = (0.630 + c * (0.70 + 0.55 * c)) * (1.0 - (thickness / (width - bevel / 2.0)) ** 4 / 12.0)
    return thickness**3 / 3.0 * (width - ends * thickness)


def section(beam: FoilBeam, width: Any) -> tuple[Any, Any, Any]:
    """Area, mm2, and second moments out of the foil's plane and in it, mm4, of a section that wide."""
    w, t, c = width, beam.thickness, beam.bevel
    within = t * (w**3 - c * (3.0 * w**2 - 4.0 * w * c + 2.0 * c**2)) / 12.0
    return t * (w - c), t**3 * (w - 1.5 * c) / 12.0, within


@lru_cache(KEPT)
def base(beam: FoilBeam) -> dict[str, float]:
    """Beam theory's stiffness of every mode (units as `stiffness`): compliances of the sections, fillets
    included, added along the beam; Timoshenko's shear."""
    x, dx, w = sections(beam)
    E, t = beam.youngs_modulus, beam.thickness
    G = E / (2.0 * (1.0 + beam.poisson))
    area, out, within = section(beam, w)
    shear = np.sum(dx / (KAPPA * G * area))
    return {
        "axial": E / (2.0 * np.sum(dx / area)),
        "twist": G / (2.0 * np.sum(dx / torsion_constant(w, t, beam.bevel))),
        "bend_out": E / (2.0 * np.sum(dx / out)),
        "shear_out": 1.0 / (2.0 * (np.sum(x**2 * dx / (E * out)) + shear)),
        "bend_in": E / (2.0 * np.sum(dx / within)),
        "shear_in": 1.0 / (2.0 * (np.sum(x**2 * dx / (E * within)) + shear)),
    }


def nominal_stress(beam: FoilBeam) -> dict[str, float]:
    """Beam theory's stress at the root's face per relative motion 1 of the ends (MPa/mm; MPa/rad): sections
    of the straight width."""
    k, t, s = base(beam), beam.thickness, beam.length
    area, out, within = section(beam, beam.width)
    twist, out, within = t / (4.0 * out), t / (2.0 * out), beam.width / (2.0 * within)
    return {
        "axial": k["axial"] / area,
        "twist": twist * k["twist"],
        "bend_out": out * k["bend_out"],
        "shear_out": out * k["shear_out"] * s / 2.0,
        "bend_in": within * k["bend_in"],
        "shear_in": within * k["shear_in"] * s / 2.0,
    }


def groups(beam: FoilBeam) -> tuple[float, float, float, float]:
    """Arguments of the factors, each from about -1 to 1: w/s, r/w, nu, and ln(t/w)."""
    return (
        (beam.width / beam.length - 0.3) / 0.2,
        (beam.fillet / beam.width - 0.55) / 0.45,
        (beam.poisson - 0.3) / 0.1,
        (float(np.log(beam.thickness / beam.width)) + 2.05) / 1.65,
    )


DEGREE = 4
# Poisson's ratio enters by its square at most
_POWERS = [p for p in np.ndindex(*(DEGREE + 1,) * 4) if sum(p) <= DEGREE and p[2] <= 2]


def terms(*x: Any) -> Array:
    """Every product of powers up to DEGREE in all, (designs, terms)."""
    values = np.array(x, dtype=float).reshape(len(x), -1)
    return np.stack([np.prod([v**n for v, n in zip(values, p)], axis=0) for p in _POWERS], axis=-1)


@cache
def fit() -> dict[str, Any]:
    """Constants, range and errors of the stiffness, as benchmarks/planar_beams.py wrote them."""
    return json.loads((DATA / "beam.json").read_text("utf-8"))


@cache
def bevel_errors() -> dict[str, dict[str, dict[str, float]]]:
    """By "stiffness" or "stress" and mode: errors of beveled beams, as benchmarks/planar_bevels.py wrote
    them."""
    return json.loads((DATA / "beam-bevel.json").read_text("utf-8"))["errors"]


@cache
def stress_errors() -> dict[str, dict[str, float]]:
    """By mode: rms and largest held out, and the largest that a climb found, relative, as
    benchmarks/planar_stress.py wrote them."""
    return json.loads((DATA / "beam-stress.json").read_text("utf-8"))["errors"]


def out_of_range(beam: FoilBeam) -> str:
    """Dimensions of the beam outside the fit's range, with the legal range; empty if none is."""
    w, s, r = beam.width, beam.length, beam.fillet
    shape = {"w/s": w / s, "s/t": s / beam.thickness, "r/w": r / w, "r/s": r / s, "nu": beam.poisson}
    for name, value in (shape | {"c/t": beam.bevel / beam.thickness}).items():
        low, high = (fit()["range"] | {"c/t": (0.0, BEVEL)})[name]
        if not low * (1 - 1e-9) <= value <= high * (1 + 1e-9):
            return f"{name} = {value:.3g}; legal: {name} from {low:g} to {high:g}"
    return ""


@lru_cache(KEPT)
def stiffness(beam: FoilBeam) -> dict[str, float]:
    """Stiffness of every mode: N/mm; bending and twist N mm a radian.

    Beam theory times a factor that was fitted on solid elements (data/beam.json): clamped roots keep a wide
    beam from curling and its ends from warping. What bevels change of that is interpolated.
    """
    row, factors, more = terms(*groups(beam)), fit()["stiffness"], told("beam-bevel", beam)
    share = beam.bevel / beam.thickness / BEVEL
    logs = {m: float((row @ np.array(factors[m]))[0]) + share * more[m] for m in MODES}
    return {m: v * float(np.exp(logs[m])) for m, v in base(beam).items()}


def place(beam: FoilBeam) -> Array:
    """Arguments of the stresses, each from about -1 to 1: w/s, ln(r/w), nu and ln(t/w); Poisson's ratio,
    which matters least, by 0.3 of that."""
    rounded, thin = log(beam.fillet / beam.width), log(beam.thickness / beam.width)
    wide, nu = (beam.width / beam.length - 0.3) / 0.2, 0.3 * (beam.poisson - 0.3) / 0.1
    return np.array([wide, rounded / log(10.0) * 2.0 + 1.0, nu, (thin + 2.05) / 1.65])


def spline(at: Array, points: Array) -> Array:
    """Terms of an interpolation between points, (places, points + 15): distances cubed, and every product of
    two arguments, one and 1."""
    away = np.linalg.norm(at[:, None] - points[None], axis=-1)
    whole = np.column_stack([np.ones(len(at)), at])
    pairs = [whole[:, i] * whole[:, j] for i in range(whole.shape[1]) for j in range(i + 1)]
    return np.column_stack([away**3, *pairs])


def interpolated(points: Array, values: Array) -> Array:
    """Coefficients of `spline` that meet the values at the points, (terms, columns)."""
    rows = spline(points, points)
    n, tail = len(points), rows[:, len(points) :]
    side = np.zeros((tail.shape[1], rows.shape[1]))
    side[:, :n] = tail.T
    right = np.vstack([values, np.zeros((tail.shape[1], values.shape[1]))])
    return np.asarray(np.linalg.solve(np.vstack([rows, side]), right))


@cache
def _table(name: str) -> tuple[list[str], Array, Array]:
    """Names of a table's columns, places of the beams that solid elements solved, and coefficients."""
    with (DATA / f"{name}.csv").open(encoding="utf-8", newline="") as file:
        names, *rows = csv.reader(file)
    data = np.array(rows, dtype=float)
    beams = (FoilBeam(1.0, w, 1.0 / slender, r * w, 1.0, nu) for w, slender, r, nu in data[:, :4])
    points = np.array([place(beam) for beam in beams])
    return names[4:], points, interpolated(points, data[:, 4:])


def told(table: str, beam: FoilBeam) -> dict[str, float]:
    """What a table says of a beam, by its columns: logarithms of ratios."""
    names, points, c = _table(table)
    return dict(zip(names, (spline(place(beam)[None], points) @ c)[0].tolist()))


@lru_cache(KEPT)
def stress(beam: FoilBeam) -> dict[str, float]:
    """Largest von Mises stress of the foil's surface per relative motion 1 of the ends (MPa/mm; MPa/rad), up
    to 0.3 fillet radii off the clamped edge.

    Beam theory times what solid elements find over it, interpolated by the place where it is largest, and in
    proportion to the bevel: 4 % too high where r = 0.15 t and c = 0.05 t (etching leaves r >= t).
    """
    k, plain = stiffness(beam), base(beam)
    over, more = told("beam-stress", beam), told("beam-bevel", beam)
    share, most = beam.bevel / beam.thickness / BEVEL, {}
    for mode, sites in STRESSED.items():
        most[mode] = max(over[f"{mode} {site}"] + share * more[f"{mode} {site}"] for site in sites)
    return {m: v * k[m] / plain[m] * float(np.exp(most[m])) for m, v in nominal_stress(beam).items()}
