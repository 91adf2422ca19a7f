"""The ladder's compliances written independently in mpmath, at whatever precision is set.

The section compliances and the beams are integrated numerically instead of repeating their closed forms;
only the fitted root is written out again.
"""

from __future__ import annotations

import mpmath as mp

from tactcad.mechanics.constants import ladder_data
from tactcad.mechanics.section import HingeSection

ORDER = (  # of the values, as the section names them
    "hinge_thickness",
    "hinge_length",
    "fillet_radius",
    "load_arm",
    "arm_height",
    "body_height",
    "body_length",
    "poisson",
    "youngs_modulus",
    "width",
)


def section(values, two):
    t, l, r, L, h, Hb, Lb, nu, E, b = values  # noqa: E741
    return HingeSection(t, l, r, L, h, Hb, Lb, nu, E, b, two)


def cantilever(M0, length, height, E, b, G):
    """int M^2/(E I) + V^2/(5/6 G A) dx with unit force and moment M0 at the near end, growing."""
    bending = mp.quad(lambda x: (M0 + x) ** 2, [0, length]) * 12 / (E * b * height**3)
    return bending + length / (mp.mpf(5) / 6 * G * b * height)


def true_compliance(rung, values, two):
    t, l, r, L, h, Hb, Lb, nu, E, b = values  # noqa: E741
    G, lc = E / (2 * (1 + nu)), l - 2 * r
    ends = cantilever(0, L - l / 2, h, E, b, G) + cantilever(L + l / 2, Lb, Hb, E, b, G)
    leaf = lambda a, length: cantilever(a, length, t, E, b, G)  # noqa: E731
    if rung == "short":
        return 12 * l * L**2 / (E * b * t**3)
    if rung == "beam":
        return leaf(L - l / 2, l) + ends
    if rung == "section":
        return leaf(L - lc / 2, lc) + ends + sum(fillet(sign, values, two, G) for sign in (-1, 1))
    return rooted(rung, values, two, G, lc, ends, leaf)


def fillet(sign, values, two, G):
    t, l, r, L, h, Hb, Lb, nu, E, b = values  # noqa: E741
    if r == 0:
        return mp.mpf(0)
    n, lc = (2 if two else 1), l - 2 * r

    def integrand(phi):  # x = r sin(phi) from the fillet's inner end
        height = t + n * r * (1 - mp.cos(phi))
        M = L + sign * (lc / 2 + r * mp.sin(phi))
        return (12 * M**2 / (E * b * height**3) + 1 / (mp.mpf(5) / 6 * G * b * height)) * r * mp.cos(phi)

    peak = mp.sqrt(t / (n * r))
    points = [0] + [p for p in (peak, 4 * peak, 16 * peak, 64 * peak) if p < 1] + [mp.pi / 2]
    return mp.quad(integrand, points)


def rooted(rung, values, two, G, lc, ends, leaf):
    t, l, r, L, h, Hb, Lb, nu, E, b = values  # noqa: E741
    k = {n: mp.mpf(v) for n, v in ladder_data()["root"]["two" if two else "one"].items()}
    rho = r / t
    A = (3 * mp.pi / 16) ** 2 * (1 if two else 2)

    def g(H):
        eta = H / t
        own = mp.sqrt(A * rho + k["p0"] - k["p1"] / (1 + k["p2"] * rho)) - k["p3"] / eta**2
        return own - k["p4"] * rho / eta**3 - k["p5"] / eta**3 - k["p6"] * mp.exp(-k["p7"] * l / t)

    ga, gb = g(h), g(Hb) - k["p8"] * (t / Lb) ** 3
    C = ends + leaf(L - lc / 2, lc)
    C += 12 / (E * b * t**2) * (ga * (L - lc / 2 - ga * t / 2) ** 2 + gb * (L + lc / 2 + gb * t / 2) ** 2)
    C += (k["s"] * (ga + gb) - k["s0"]) / (mp.mpf(5) / 6 * G * b)
    C += 12 * k["e"] * (L - l / 2) / (E * b * h)
    C -= 12 * k["c"] * nu**2 * (L + l / 2) ** 2 / (E * b * Hb**2)
    if rung == "plane":
        return C
    w = {n: mp.mpf(v) for n, v in ladder_data()["width"]["two" if two else "one"].items()}
    x, y = l / b, t / b
    leaf = 1 + w["c1"] * x + w["c2"] * y + w["c3"] * x**2 + w["c4"] * x * y + w["c5"] * y**2 + w["c6"] * r / b
    leaf += w["c7"] * y * r / l + w["c8"] * nu * x + w["c9"] * y * t / l + w["c10"] * t / Hb
    arm = 4 * ((L - l / 2) / h) ** 3 / (E * b) / C
    body = 4 * ((L + l / 2 + Lb) ** 3 - (L + l / 2) ** 3) / (E * b * Hb**3) / C
    psi = (1 - arm - body) * leaf + arm / (1 + w["ca"] * h / b) + body / (1 + w["cb"] * Hb / b)
    return C / (1 + nu**2 / (1 - nu**2) * psi)


def condition(f, values):
    """Sum of |x_i df/dx_i / f| by differences at 50 digits."""
    at = f(values)
    total = mp.mpf(0)
    for i, x in enumerate(values):
        moved = list(values)
        moved[i] = x * (1 + mp.mpf(10) ** -18)
        total += abs((f(moved) - at) / at) * mp.mpf(10) ** 18
    return float(total)
