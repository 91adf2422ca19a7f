"""Rungs of the solid. solid: the plane rung's parts, each stiffened as the width prevents anticlastic
curvature; fem-solid: elements.

    C3D = hinge (1 - nu^2/(1 + P)) + slope (1 - nu^2/(1 + cs P)) + arm + body (1 - nu^2/(1 + cb Lb/b)) + shear
    P = (1 + a nu) (cx x + cy y + (cz + cl t/l) z + cxx x^2 + cyz y z + cxxy x^2 y + cxxz x^2 z + cxyy x y^2
                    + cyyy y^3 + cyyz y^2 z + ch (t/h)^3 (L - l/2)/b)

with x = lc/b, y = t/b, z = r/b, and hinge, slope, arm, body, shear as in `plane`. A sheet that is
narrow for the length that bends curls freely across (plane stress); a wide one cannot (plane strain,
1 - nu^2). The arm's ends are free across, so it curls at any width, and the hinge of a low arm curls with it
(ch). As no constant but a is negative, C3D never exceeds that of plane stress, and K3D/b never falls with b,
for any values of the constants.
"""

from __future__ import annotations

from tactcad.design.family import Late

from ..register import Rung, by_sides
from ..section import Array, HingeSection
from . import plane


def curled(s: HingeSection, flat: plane.Parts, k: plane.Constants | None = None) -> Array:
    """Tip compliance of the solid from the parts in plane stress, mm/N.

    Parameters
    ----------
    s
        One design or many.
    flat
        Their compliances in plane stress, `plane.parts`.
    k
        Constants of the width, by default the shipped ones.
    """
    k = k or by_sides("width", s.two_sided)
    b, nu2 = s.width, s.poisson * s.poisson
    free = (1.0 + k["a"] * s.poisson) * _narrowness(s, k)
    hinge = flat.hinge * (1.0 - nu2 / (1.0 + free)) + flat.slope * (1.0 - nu2 / (1.0 + k["cs"] * free))
    body = flat.body * (1.0 - nu2 / (1.0 + k["cb"] * (s.body_length / b)))
    return hinge + flat.arm + body + flat.shear


def _narrowness(s: HingeSection, k: plane.Constants) -> Array:
    """P/(1 + a nu): how freely the hinge curls across."""
    x, y, z = (length / s.width for length in (s.straight_length, s.hinge_thickness, s.fillet_radius))
    t, l, reach = s.hinge_thickness, s.hinge_length, s.load_arm - s.hinge_length / 2.0
    alone = x * (k["cx"] + k["cxx"] * x) + y * (k["cy"] + k["cyyy"] * y * y) + z * (k["cz"] + k["cl"] * t / l)
    both = x * (x * (k["cxxy"] * y + k["cxxz"] * z) + k["cxyy"] * y * y) + y * z * (k["cyz"] + k["cyyz"] * y)
    return alone + both + k["ch"] * (t / s.arm_height) ** 3 * reach / s.width


def compliance(s: HingeSection, data: dict | None = None) -> Array:
    """Tip compliance of the solid, mm/N, by the constants in `data` (as data/ladder.json), else the shipped
    ones."""
    flat = plane.parts(s, by_sides("root", s.two_sided, data))
    return curled(s, flat, by_sides("width", s.two_sided, data))


RUNG = Rung("solid", 5, "design: the default", compliance, fitted=("plane", "width"))
ELEMENTS = Rung(
    "fem-solid", 7, "the reference", elements=Late("tactcad.fem.fem_ladder:converged_solid"), meshes=(2, 3)
)
