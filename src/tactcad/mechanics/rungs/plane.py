"""Rungs of plane stress. plane: the leaf between two elastic roots, arm and body; fem-plane: elements.

With rho = r/t, kappa = Lb/Hb, s = L - l/2 and p = L + l/2 the lever arms at the slot's junctions with arm and
body, lc = l - 2 r, and n the number of slotted faces, E b C is the sum of::

    hinge  12/t^3 [lc L^2 + t g (L - lc/2 - g t/2)^2 + t g (L + lc/2 + g t/2)^2]
           g = sqrt(A rho + p0 - p1/(1 + p2 rho)) - (p6 + p7 rho) exp(-p8 l/t)
    slope  (lc/t)^3
    arm    4 (s/h)^3 - 12 (s/h)^2 (p3 + d t/h),   d = p4 + p5 rho
    body   4 [3 p Lb^2 + Lb^3]/Hb^3 + 12 (p/Lb)^2 J
           J = J0 + p3 u^2 + u^3 - (f0 + f1 nu)(1 - w) - d t/Lb (d0 + 2 p3 u^2 + u^3)
               - c nu^2 (1 + Lb/p)^2 kappa^2 w
           u = m ln(1 + exp((kappa - 2 p3/3)/m)),   w = 1/(1 + exp(-(kappa - k)/m))
    shear  12/5 [lc/t + s/h + Lb/Hb + nu (p + Lb)/Hb] + v0 + v1 rho + v2 sqrt(rho) l/t
           - V ln(t/h q) + 12 e (s/h - p q/t),   q = (2 p3/3 + u) t/Lb

g t is the hinge length that one filleted root adds to a block without end. A = (3 pi/16)^2 2/n is the exact
limit of a thin notch; p6 to p8 are what two roots close to each other take from one another. A block of
finite height adds less, by p3 and d. In a body that is high for its length the clamp, not the height, limits
the deformation: J goes over from kappa^3 - p3 kappa^2 (written with u, J0 = -4 p3^3/27 and d0 = 8 p3^3/27) to
a constant, and never falls with kappa, so that K never falls as the body grows higher. m is the length over
which a self-equilibrated load fades in a strip, V the logarithm's factor under a force on a straight edge or
a corner; both follow from elasticity. c accounts for the clamp, which prevents lateral contraction of the
body's end; e couples moment and shear in the roots. By Michell's theorem Poisson's ratio enters plane stress
only where displacements are prescribed: at the clamp. All other letters are constants of the fit.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from tactcad.design.family import Late

from ..register import Rung, by_sides
from ..section import Array, HingeSection
from .beams import SHEAR_FACTOR

THIN_NOTCH = (3.0 * np.pi / 16.0) ** 2 * 2.0  # over n: squared root length per r/t as r/t grows
# Length, in heights of the strip, over which the energy of a self-equilibrated load fades: that of the
# slowest odd mode (two-sided; sin x = x) or of the slowest of all (one-sided; sin x = -x), by the real part
# of x (Papkovich, Fadle).
FADING = {True: 1.0 / (2.0 * 7.498), False: 1.0 / (2.0 * 4.212)}
# E b times the compliance under a force along the edge of a half-plane or a quarter-plane, per logarithm of
# the radius (Flamant, Michell).
EDGE_FORCE = {True: 2.0 / np.pi, False: 1.0 / (np.pi / 4.0 - 1.0 / np.pi)}

Constants = Mapping[str, Array | float]


@dataclass(frozen=True)
class Parts:
    """Tip compliance in plane stress by place of deformation, mm/N.

    Bending of the leaf with its roots under the mean moment; of the leaf under the moment's `slope`; of the
    arm; of the body; and all shear.
    """

    hinge: Array
    slope: Array
    arm: Array
    body: Array
    shear: Array

    @property
    def whole(self) -> Array:
        return self.hinge + self.slope + self.arm + self.body + self.shear


def root_length(s: HingeSection, k: Constants | None = None) -> Array:
    """Length g that one root in a block without end adds to the leaf, in units of the hinge thickness."""
    k = k or by_sides("root", s.two_sided)
    rho = s.fillet_radius / s.hinge_thickness
    alone = np.sqrt(THIN_NOTCH / s.notch_sides * rho + k["p0"] - k["p1"] / (1.0 + k["p2"] * rho))
    return alone - (k["p6"] + k["p7"] * rho) * np.exp(-k["p8"] * s.hinge_length / s.hinge_thickness)


def root_lengths(s: HingeSection, k: Constants | None = None) -> tuple[Array, Array]:
    """Lengths that the roots to arm and body add to the leaf between blocks of finite height, in hinge
    thicknesses.
    """
    k = k or by_sides("root", s.two_sided)
    g, t = root_length(s, k), s.hinge_thickness
    low, rise = _height_felt(s, k)
    to_arm, to_body = t / s.arm_height, t / s.body_length * (low + rise)
    d = _cubic(s, k)
    return g - to_arm**2 * (k["p3"] + d * to_arm), g - to_body**2 * (k["p3"] + d * to_body)


def parts(s: HingeSection, k: Constants | None = None) -> Parts:
    """Tip compliance in plane stress by its parts; `k` are the root's constants, by default the shipped
    ones.
    """
    k = k or by_sides("root", s.two_sided)
    per = s.youngs_modulus * s.width
    slope = (s.straight_length / s.hinge_thickness) ** 3 / per
    t, h, Hb, Lb = s.hinge_thickness, s.arm_height, s.body_height, s.body_length
    slender, p = (s.load_arm - s.hinge_length / 2.0) / h, s.load_arm + s.hinge_length / 2.0
    rho, q = s.fillet_radius / t, sum(_height_felt(s, k)) / Lb
    beams = s.straight_length / t + slender + Lb / Hb + s.poisson * (p + Lb) / Hb
    roots = k["v0"] + k["v1"] * rho + k["v2"] * np.sqrt(rho) * s.hinge_length / t
    spread = _by_form(EDGE_FORCE, s.two_sided) * np.log(t * q * (t / h))
    return Parts(
        _hinge(s, k) / per,
        slope,
        _arm(s, k) / per,
        _body(s, k) / per,
        (beams / (SHEAR_FACTOR / 2.0) + roots - spread + 12.0 * k["e"] * (slender - p * q)) / per,
    )


def compliance(s: HingeSection, k: Constants | None = None) -> Array:
    """Tip compliance in plane stress, mm/N; `k` are the root's constants, by default the shipped ones."""
    return parts(s, k).whole


def compliance_by(s: HingeSection, data: dict | None = None) -> Array:
    """Tip compliance in plane stress, mm/N, by the constants in `data` (as data/ladder.json), else the
    shipped ones."""
    return compliance(s, by_sides("root", s.two_sided, data))


def _hinge(s: HingeSection, k: Constants) -> Array:
    """E b times the compliance of the leaf under its mean moment, and of its roots, in bending."""
    t, L, lc = s.hinge_thickness, s.load_arm, s.straight_length
    g = t * root_length(s, k)
    to_arm, to_body = L - (lc + g) / 2.0, L + (lc + g) / 2.0
    return 12.0 * (lc * L * L + g * (to_arm * to_arm + to_body * to_body)) / (t * t * t)


def _arm(s: HingeSection, k: Constants) -> Array:
    slender, q = (s.load_arm - s.hinge_length / 2.0) / s.arm_height, s.hinge_thickness / s.arm_height
    return slender * slender * (4.0 * slender - 12.0 * (k["p3"] + _cubic(s, k) * q))


def _body(s: HingeSection, k: Constants) -> Array:
    p, Lb, stout = s.load_arm + s.hinge_length / 2.0, s.body_length, s.body_length / s.body_height
    low, u = _height_felt(s, k)
    # w, from 0 if the clamp is close behind the root to 1 if it is far; no exponential overflows
    clamped = 0.5 + 0.5 * np.tanh((stout - k["k"]) / (2.0 * _by_form(FADING, s.two_sided)))
    grip = s.poisson * stout * (1.0 + Lb / p)
    J = (
        u * u * (1.5 * low + u)
        - 0.5 * low * low * low
        - (k["f0"] + k["f1"] * s.poisson) * (1.0 - clamped)
        - _cubic(s, k) * s.hinge_thickness / Lb * (low * low * low + u * u * (3.0 * low + u))
        - k["c"] * grip * grip * clamped
    )
    return 4.0 * stout * stout * (3.0 * p + Lb) / s.body_height + 12.0 * (p / Lb) ** 2 * J


def _cubic(s: HingeSection, k: Constants) -> Array:
    """d: factor of the term by which a root's length decreases, cubic in thickness over height."""
    return k["p4"] + k["p5"] * (s.fillet_radius / s.hinge_thickness)


def _height_felt(s: HingeSection, k: Constants) -> tuple[Array, Array]:
    """2 p3/3, the body length over height below which the height has no effect, and u, by how much it is
    exceeded.
    """
    low, fading = np.asarray(k["p3"]) / 1.5, _by_form(FADING, s.two_sided)
    return low, fading * np.logaddexp(0.0, (s.body_length / s.body_height - low) / fading)


def _by_form(table: Mapping[bool, float], two_sided: NDArray[np.bool_]) -> Array:
    return np.where(two_sided, table[True], table[False])


RUNG = Rung("plane", 4, "thin sheet; to compare with plane models", compliance_by, fitted=("plane",))
ELEMENTS = Rung(
    "fem-plane",
    6,
    "a contour of your own, in plane stress",
    elements=Late("tactcad.fem.fem_ladder:converged_plane"),
)
