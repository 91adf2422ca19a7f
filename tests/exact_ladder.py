"""The ladder's compliances written independently in mpmath, at whatever precision is set.

The section compliances and the beams are integrated numerically instead of repeating their closed forms;
only the fitted root is written out again.
"""

from __future__ import annotations

import mpmath as mp

from tactcad.mechanics.register import ladder_data
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
    if rung in ("plane", "solid"):
        return rooted(rung, values, two, lc)
    ends = cantilever(0, L - l / 2, h, E, b, G) + cantilever(L + l / 2, Lb, Hb, E, b, G)
    leaf = lambda a, length: cantilever(a, length, t, E, b, G)  # noqa: E731
    if rung == "short":
        return 12 * l * L**2 / (E * b * t**3)
    if rung == "beam":
        return leaf(L - l / 2, l) + ends
    if rung != "section":
        raise LookupError(f"rung {rung} is not written here: tests/exact_ladder.py asks for it in mpmath")
    return leaf(L - lc / 2, lc) + ends + sum(fillet(sign, values, two, G) for sign in (-1, 1))


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


def rooted(rung, values, two, lc):
    """The closed form by what it adds to beam theory, which is integrated."""
    t, l, r, L, h, Hb, Lb, nu, E, b = values  # noqa: E741
    k = {n: mp.mpf(v) for n, v in ladder_data()["root"]["two" if two else "one"].items()}
    rho, s, p, Eb = r / t, L - l / 2, L + l / 2, E * b
    A = (3 * mp.pi / 16) ** 2 * (1 if two else 2)
    g = mp.sqrt(A * rho + k["p0"] - k["p1"] / (1 + k["p2"] * rho))
    g -= (k["p6"] + k["p7"] * rho) * mp.exp(-k["p8"] * l / t)
    d = k["p4"] + k["p5"] * rho
    bending = lambda M0, length, H: mp.quad(lambda x: 12 * (M0 + x) ** 2 / (Eb * H**3), [0, length])  # noqa: E731
    hinge, slope = 12 * lc * L**2 / (Eb * t**3), lc**3 / (Eb * t**3)
    hinge += 12 * g / (Eb * t**2) * ((L - lc / 2 - g * t / 2) ** 2 + (L + lc / 2 + g * t / 2) ** 2)
    arm = bending(0, s, h) - 12 / Eb * (k["p3"] * (s / h) ** 2 + d * t * s**2 / h**3)
    # the body: of its bending, p^2 12 Lb/Hb^3 is in J
    m, kappa = 1 / (2 * mp.mpf("7.498" if two else "4.212")), Lb / Hb
    u = m * mp.log(1 + mp.exp((kappa - 2 * k["p3"] / 3) / m))
    w = 1 / (1 + mp.exp(-(kappa - k["k"]) / m))
    J = -4 * k["p3"] ** 3 / 27 + k["p3"] * u**2 + u**3 - (k["f0"] + k["f1"] * nu) * (1 - w)
    J -= d * t / Lb * (8 * k["p3"] ** 3 / 27 + 2 * k["p3"] * u**2 + u**3)
    J -= k["c"] * nu**2 * (1 + Lb / p) ** 2 * kappa**2 * w
    body = bending(p, Lb, Hb) + 12 / Eb * ((p / Lb) ** 2 * J - p**2 * Lb / Hb**3)
    q = (2 * k["p3"] / 3 + u) * t / Lb
    shear = mp.mpf(12) / 5 * (lc / t + s / h + Lb / Hb + nu * (p + Lb) / Hb)
    shear += k["v0"] + k["v1"] * rho + k["v2"] * mp.sqrt(rho) * l / t + 12 * k["e"] * (s / h - p * q / t)
    shear -= (2 / mp.pi if two else 1 / (mp.pi / 4 - 1 / mp.pi)) * mp.log(t / h * q)
    if rung == "plane":
        return hinge + slope + arm + body + shear / Eb
    w = {n: mp.mpf(v) for n, v in ladder_data()["width"]["two" if two else "one"].items()}
    x, y, z = lc / b, t / b, r / b
    P = w["cx"] * x + w["cy"] * y + w["cz"] * z + w["cxx"] * x**2 + w["cyz"] * y * z + w["cxxy"] * x**2 * y
    P += w["cxxz"] * x**2 * z + w["cxyy"] * x * y**2 + w["cyyy"] * y**3 + w["cyyz"] * y**2 * z
    P += w["cl"] * t / l * z + w["ch"] * (t / h) ** 3 * s / b
    P *= 1 + w["a"] * nu
    held = 1 / (1 + P), 1 / (1 + w["cs"] * P), 1 / (1 + w["cb"] * Lb / b)
    return sum(C * (1 - nu**2 * share) for C, share in zip((hinge, slope, body), held)) + arm + shear / Eb


def condition(f, values):
    """Sum of |x_i df/dx_i / f| by differences at 50 digits."""
    at = f(values)
    total = mp.mpf(0)
    for i, x in enumerate(values):
        moved = list(values)
        moved[i] = x * (1 + mp.mpf(10) ** -18)
        total += abs((f(moved) - at) / at) * mp.mpf(10) ** 18
    return float(total)
