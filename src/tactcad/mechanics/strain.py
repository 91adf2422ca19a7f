"""Surface strain of the hinge: nominal, at the centre, as a gauge's grid averages it, and its peak.

The closed forms are factors on the nominal strain, fitted on plane elements like the stiffness; the fit
report gives each one's error. In three dimensions strain per newton goes down as the stiffness goes up;
strain per deflection hardly changes.

`data/strain.json`, written by `benchmarks/strain_fit.py`, divides the range into zones, as data/accuracy.json
does for K, with the errors of these forms against solid elements.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from tactcad.design.messages import CheckFailure

from . import ladder, validity
from .accuracy import in_zone
from .register import by_sides, rungs, strain_data
from .rungs import plane
from .section import Array, HingeSection, friction_factor

Constants = plane.Constants

NARROW = 1.5  # b/l below which a leaf curls over its whole width
SMALL_STEP = 30.0  # below it the rise of ln(1 + e^z) is computed without a difference


def nominal(s: HingeSection, force: Array | float) -> Array:
    """6 F L/(E b t^2), beam theory's surface strain at the hinge's centre; force in N."""
    t = s.hinge_thickness
    return 6.0 * np.asarray(force) * s.load_arm / (s.youngs_modulus * s.width * t * t)


def gauge(
    s: HingeSection,
    force: Array | float,
    grid_length: Array | float,
    rung: str = ladder.DEFAULT_RUNG,
    data: dict | None = None,
) -> Array:
    """Mean strain at mid-width under a grid on the gauge face, centred on the hinge, less what friction at
    the pad takes of the bending moment. (`peak` and the stresses are those without friction, which may be
    less than stated.)

    Parameters
    ----------
    s
        One design or many.
    force
        At the load line, N.
    grid_length
        Of the gauge's grid, mm.
    rung
        A closed-form rung.
    data
        As data/strain.json, by default the shipped one.

    Raises
    ------
    CheckFailure
        If a design is out of the rung's range, or a two-sided hinge's flat part is too short for the grid.
    """
    ladder.require_range(s, rung)
    bent = nominal(s, force) / friction_factor(s)
    return bent * grid_factor(s, grid_length, rung) * width_reduction(s, rung, "grid", grid_length, data)


def peak(
    s: HingeSection, force: Array | float, rung: str = ladder.DEFAULT_RUNG, data: dict | None = None
) -> Array:
    """Largest surface strain at mid-width: at the slot-side fillet towards the body.

    The rungs short, beam and section do not model the fillet: theirs is the nominal strain at the slot's end
    (short: at its centre).

    Parameters
    ----------
    s
        One design or many.
    force
        At the load line, N.
    rung
        A closed-form rung.
    data
        As data/strain.json, by default the shipped one.

    Raises
    ------
    CheckFailure
        If a design is out of the rung's range.
    """
    ladder.require_range(s, rung)
    if rung in ladder.FITTED:
        factor: Array | float = fillet_factor(s)
    else:
        factor = 1.0 if rungs()[rung].constant_moment else 1.0 + s.straight_length / 2.0 / s.load_arm
    return nominal(s, force) * factor * width_reduction(s, rung, "fillet", data=data)


def peak_stress(s: HingeSection, force: Array | float) -> Array:
    """Largest principal surface stress under a force (N) at the load line, MPa: at the slot-side fillet
    towards the body, of the whole width.

    Raises CheckFailure if the fillet's factor was not fitted.
    """
    _require_fitted(s)
    return stress_beyond_the_fit(s, force)


def leaf_stress(s: HingeSection, force: Array | float, rung: str) -> Array:
    """`peak_stress` by the rungs that know the fillet, by the others at the leaf's own peak strain, MPa."""
    if rung in ladder.FITTED:
        return peak_stress(s, force)
    return peak(s, force, rung) * s.youngs_modulus


def stress_beyond_the_fit(s: HingeSection, force: Array | float) -> Array:
    """`peak_stress` without its check of the range, MPa: not accurate enough to report, but good for
    bounds.
    """
    return mean_stress(s, force) * peak_share(s)


def mean_stress(s: HingeSection, force: Array | float) -> Array:
    """Mean over the width of the stress at the fillet, MPa: 6 F L/(b t^2) times the fillet's factor.

    It follows from equilibrium and does not depend on the width. Without a check of the range.
    """
    return nominal(s, force) * s.youngs_modulus * fillet_factor(s)


def peak_share(s: HingeSection) -> Array:
    """Largest principal stress over the width's mean, at the fillet: at mid-width, since the sheet's sides
    carry less; never less than the mean itself.
    """
    return np.maximum(mid_width_share(s), 1.0)


def mid_width_share(s: HingeSection, data: dict | None = None) -> Array:
    """Largest principal stress at mid-width over the closed form's mean over the width, at the fillet.

    1 + nu^2 P, where P is a polynomial of second degree in l/b, t/b, nu and ln(r/t), each clipped to the
    range that was sampled, times `narrow`. The error of the closed form is fitted with it.

    Parameters
    ----------
    s
        One design or many.
    data
        As data/strain.json, by default the shipped one.
    """
    data = data or strain_data()
    return (1.0 + s.poisson**2 * _polynomial(s, features(s), data["mid-width share"])) * narrow(
        s, "stress", data=data
    )


def narrow(s: HingeSection, at: str, grid_length: Array | float = 0.0, data: dict | None = None) -> Array:
    """Factor on strain ("grid", "fillet") or stress ("stress") at mid-width for a leaf hardly wider than
    long.

    1 + nu^2 P (l/b - 1/NARROW), and 1 if b is NARROW l or more. P as for `mid_width_share`, under a grid
    with grid/l besides.

    Parameters
    ----------
    s
        One design or many.
    at
        "grid", "fillet" or "stress".
    grid_length
        Of the gauge's grid, mm.
    data
        As data/strain.json, by default the shipped one.
    """
    slender = np.maximum(s.hinge_length / s.width - 1.0 / NARROW, 0.0)
    if not slender.any():
        return np.ones(s.shape)
    known = features(s, grid_length if at == "grid" else None)
    return 1.0 + s.poisson**2 * slender * _polynomial(s, known, (data or strain_data())["narrow"][at])


def features(s: HingeSection, grid_length: Array | float | None = None) -> Array:
    """l/b, t/b, nu and ln(r/t), and grid/l of a grid (mm): [..., feature]."""
    l, t, b = s.hinge_length, s.hinge_thickness, s.width
    tiny = np.finfo(float).tiny  # a slot without fillets is out of every range, but needs bounds
    found = [l / b, t / b, s.poisson, np.log(np.maximum(s.fillet_radius / t, tiny))]
    if grid_length is not None:
        found.append(np.asarray(grid_length) / l)
    return np.stack(np.broadcast_arrays(*found, s.two_sided)[: len(found)], axis=-1)


def terms(known: Array, k: Mapping[str, list[float]]) -> Array:
    """1, the features scaled to -1 to 1 over the sampled range, and their products: [..., term]."""
    low, high = np.array(k["low"]), np.array(k["high"])
    z = np.clip(2.0 * (known - low) / (high - low) - 1.0, -1.0, 1.0)
    first, second = np.triu_indices(z.shape[-1])
    return np.concatenate([np.ones((*z.shape[:-1], 1)), z, z[..., first] * z[..., second]], axis=-1)


def _polynomial(s: HingeSection, known: Array, k: Mapping[str, Mapping[str, list[float]]]) -> Array:
    """P by each design's notch form."""
    two, one = (terms(known, k[side]) @ np.array(k[side]["coefficients"]) for side in ("two", "one"))
    return np.where(s.two_sided, two, one)


def face_stress(s: HingeSection, force: Array | float) -> Array:
    """Largest stress on the flat gauge face of a one-sided hinge, MPa; on a two-sided one the fillet's.

    Over the width's mean by the fillet's share: solid elements on the fit's samples give 0.90 to 1.035 of it,
    and never more than 0.97 of the fillet's. Raises CheckFailure if the factor was not fitted.
    """
    _require_fitted(s)
    return nominal(s, force) * s.youngs_modulus * face_factor(s) * peak_share(s)


def _require_fitted(s: HingeSection) -> None:
    for rule in validity.broken_rules(s, "plane"):
        raise CheckFailure(f"the closed forms for stress do not reach this design: {rule}")


def width_reduction(
    s: HingeSection, rung: str, at: str, grid_length: Array | float = 0.0, data: dict | None = None
) -> Array | float:
    """Strain per newton at mid-width over that in plane stress; 1 on rungs that do not model the width.

    `at` is "grid" (of this length, mm) or "fillet". K2D/K3D, since strain per deflection hardly changes,
    times
    `mid_width` and `narrow`.
    """
    if "width" not in rungs()[rung].fitted:
        return 1.0
    # a leaf longer than wide curls no more than one as long as wide, up to which the polynomial was fitted
    curled = s.with_(hinge_length=np.minimum(s.hinge_length, s.width))
    softer = ladder.compliance(s, rung) / ladder.compliance(s, "plane")
    return softer * mid_width(curled, at) * narrow(s, at, grid_length, data)


def mid_width(s: HingeSection, at: str, k: Constants | None = None) -> Array:
    """Strain per deflection at mid-width over that in plane stress.

    1 + nu^2 (a x^2 + d x y + e y^2), x = l/b, y = t/b; `at` is "grid" or "fillet".
    """
    k = k or by_sides(f"mid-width {at}", s.two_sided)
    x, y, nu = s.hinge_length / s.width, s.hinge_thickness / s.width, s.poisson
    return 1.0 + nu * nu * (x * (k["a"] * x + k["d"] * y) + k["e"] * y * y)


def fillet_factor(s: HingeSection, k: Constants | None = None) -> Array:
    """Peak at the body-side fillet over nominal.

    [1 + (lc/2 + a sqrt(r t) - b r)/L] [1 + c rho^-m (1 + d exp(-e lc/t))]: the moment at the peak, times the
    fillet's own stress concentration, which is larger where two fillets form one round notch.
    """
    k = k or by_sides("fillet", s.two_sided)
    t, r, lc = s.hinge_thickness, s.fillet_radius, s.straight_length
    notch = 1.0 + k["d"] * np.exp(-k["e"] * lc / t)
    return (1.0 + peak_position(s, k) / s.load_arm) * (1.0 + k["c"] * (r / t) ** -k["m"] * notch)


def peak_position(s: HingeSection, k: Constants | None = None) -> Array:
    """Distance of the peak from the hinge's centre towards the body, mm: lc/2 + a sqrt(r t) - b r."""
    k = k or by_sides("fillet", s.two_sided)
    t, r = s.hinge_thickness, s.fillet_radius
    return s.straight_length / 2.0 + k["a"] * np.sqrt(r * t) - k["b"] * r


def face_factor(s: HingeSection, k: Constants | None = None) -> Array:
    """Peak on the gauge face over nominal; on a two-sided hinge the fillet's.

    One-sided: [1 + (a lc/2 - b t)/L] [1 - c/(d + rho) exp(-e lc/t)].
    """
    k = k or by_sides("face", np.False_)
    t, lc = s.hinge_thickness, s.straight_length
    flat = (1.0 + (k["a"] * lc / 2.0 - k["b"] * t) / s.load_arm) * (
        1.0 - k["c"] / (k["d"] + s.fillet_radius / t) * np.exp(-k["e"] * lc / t)
    )
    return np.where(s.two_sided, fillet_factor(s), flat) if np.any(s.two_sided) else flat


def grid_factor(s: HingeSection, grid_length: Array | float, rung: str = ladder.DEFAULT_RUNG) -> Array:
    """Mean strain under the grid over nominal; 1 on the rungs without roots.

    Each root adds X(w) to the integral of (strain over nominal - 1), up to w = distance from the
    fillet's end over t: mean = 1 + 2 t/grid [X(w+) - X(w-)], w+- = (+-grid - lc)/(2 t). Raises
    CheckFailure if a grid on a two-sided hinge would reach over more than half of its fillets.
    """
    grid = np.asarray(grid_length, dtype=float)
    if rung not in ladder.FITTED:
        return np.broadcast_to(1.0, np.broadcast_shapes(s.shape, grid.shape))
    climbs = s.two_sided & (grid > s.straight_length + s.fillet_radius)
    if np.any(climbs):
        raise CheckFailure(
            "the gauge's grid is longer than the flat part of a two-sided hinge and half of its fillets"
        )
    to_arm, to_body = plane.root_lengths(s)
    root = (to_arm + to_body) / 2.0
    if np.all(s.two_sided):
        return two_sided_grid(s, grid, by_sides("grid", np.True_), root)
    one = one_sided_grid(s, grid, by_sides("grid", np.False_), root)
    if not np.any(s.two_sided):
        return one
    return np.where(s.two_sided, two_sided_grid(s, grid, by_sides("grid", np.True_), root), one)


def one_sided_grid(s: HingeSection, grid: Array, k: Constants, root: Array) -> Array:
    """`grid_factor` of one-sided hinges, by X = -g [m f(u, v; w/g) + (1 - m) f(x, y; w/g)].

    f(u, v; z) = ln(1 + exp(u (z - v)))/u. g is the mean root length in t: beyond the end of the slot the
    strain fades, partly at once, partly in the block.

    Parameters
    ----------
    s
        One design or many.
    grid
        Length of the gauge's grid, mm.
    k
        Constants of the fit.
    root
        g.
    """
    g, middle, step = root, *_reach(s, grid)
    near = _softplus_rise(k["u"] * (middle / g - k["v"]), k["u"] * step / g) / k["u"]
    far = _softplus_rise(k["x"] * (middle / g - k["y"]), k["x"] * step / g) / k["x"]
    return 1.0 - 2.0 * g * (k["m"] * near + (1.0 - k["m"]) * far) / step


def two_sided_grid(s: HingeSection, grid: Array, k: Constants, root: Array) -> Array:
    """`grid_factor` of two-sided hinges: fading strain, and the fillet's peak; parameters as
    `one_sided_grid`.

    X = -g f(u, v; w/g) + m rho^-x [1 + tanh(y (w/sqrt(rho) - z))]/2.
    """
    g, middle, step = root, *_reach(s, grid)
    rho = s.fillet_radius / s.hinge_thickness
    fading = _softplus_rise(k["u"] * (middle / g - k["v"]), k["u"] * step / g) / k["u"]
    slope = 2.0 * k["y"] / np.sqrt(rho)
    bump = k["m"] * rho ** -k["x"] * _logistic_rise(slope * middle - 2.0 * k["y"] * k["z"], slope * step)
    return 1.0 + 2.0 * (bump - g * fading) / step


def _reach(s: HingeSection, grid: Array) -> tuple[Array, Array]:
    """Middle of w- and w+, and their distance: -lc/(2 t) and grid/t. A point is a grid of t/1000."""
    t = s.hinge_thickness
    return -s.straight_length / (2.0 * t), np.maximum(grid / t, 1e-3)


def _softplus_rise(middle: Array, step: Array) -> Array:
    """ln(1 + e^(middle + step/2)) - ln(1 + e^(middle - step/2)), to the last digits for small steps too."""
    low = middle - step / 2.0
    small = np.minimum(step, SMALL_STEP)
    near = np.log1p(_logistic(low) * np.expm1(small))
    return np.where(step < SMALL_STEP, near, np.logaddexp(0.0, low + step) - np.logaddexp(0.0, low))


def _logistic_rise(middle: Array, step: Array) -> Array:
    """L(middle + step/2) - L(middle - step/2) of the logistic L, as L(high) L(-low) (1 - e^-step)."""
    return _logistic(middle + step / 2.0) * _logistic(step / 2.0 - middle) * -np.expm1(-step)


def _logistic(z: Array) -> Array:
    """1/(1 + e^-z) = (1 + tanh(z/2))/2"""
    with np.errstate(over="ignore"):
        return 1.0 / (1.0 + np.exp(-z))


SIDES = {"two": True, "one": False}
# Slot lengths on the flat face (two-sided: lengths of flat part and one fillet) above which a grid counts as
# long, and above which none was measured.
LONG_GRID, LONGEST_GRID = 2.0, 5.0
# Of fem-solid, twice the most by which its meshes 2 to 4 were found to differ: under a grid 0.024 %, and
# 0.145 % where the slot is shorter than SHORT thicknesses; 0.70 % at the fillet of a narrow two-sided hinge
# (tests/fit/test_strain_errors.py).
OF_ELEMENTS, OF_ELEMENTS_SHORT, OF_ELEMENTS_AT_FILLET = 0.0005, 0.003, 0.015
SHORT = 1.0


@dataclass(frozen=True)
class StrainErrors:
    """Largest relative errors that are stated: of the mean under a grid of the gauge, of the peak strain and
    of the largest principal stress at the fillet, all at mid-width. NaN if nothing was measured."""

    gauge: Array
    fillet_strain: Array
    fillet_stress: Array


def stated(s: HingeSection, grid_length: float, rung: str) -> StrainErrors:
    """Stated errors of a rung at every design; NaN for rungs other than solid and fem-solid.

    Parameters
    ----------
    s
        One design or many.
    grid_length
        Of the gauge's grid, mm.
    rung
        The rung's name.
    """
    if rung != "solid":
        known = np.full(s.shape, 1.0 if rung == "fem-solid" else np.nan)
        short_slot = s.hinge_length < SHORT * s.hinge_thickness
        fillet = known * OF_ELEMENTS_AT_FILLET
        return StrainErrors(known * np.where(short_slot, OF_ELEMENTS_SHORT, OF_ELEMENTS), fillet, fillet)
    short, long, strain, stress = (
        _stated(s, name) for name in ("gauge", "long gauge", "fillet strain", "fillet stress")
    )
    grid = grid_length / np.broadcast_to(s.hinge_length, s.shape)
    gauge = np.where(grid <= LONG_GRID, short, np.where(grid <= LONGEST_GRID, long, np.nan))
    return StrainErrors(gauge, strain, stress)


def _stated(s: HingeSection, name: str) -> Array:
    error, groups = np.full(s.shape, np.nan), validity.groups(s)
    for zone in strain_data()["zones"]:
        inside = np.broadcast_to(in_zone(zone, groups, s.two_sided), s.shape)
        error[inside] = np.nan if zone["stated"][name] is None else zone["stated"][name]
    return np.where(validity.reasons(s, "solid") == "", error, np.nan)
