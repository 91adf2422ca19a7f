"""Knowledge of an array's elements in use: standard deviations of the relative errors of K and K_v.

drawn       all dimensions lie within their tolerances
inspected   the hinge's thickness is measured, the rest lies within tolerances
calibrated  force and signal were read against the stage's displacement, several runs an element

Two errors come to each: the contact's place along the arm, in use against as known; and, uncalibrated, the
gauge's own sensitivity. What all elements share is kept apart: one sheet, one lot, one machine's offset, and
what only softens: one cut's recast layer, one clamp that turns. Those count both ways, as in
mechanics/as_built: half their limit is the root mean square of what they may be about nothing.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from tactcad.circuit import element_signals
from tactcad.design.tree import Design
from tactcad.lab.regression import KNOWN
from tactcad.mechanics import as_built, gauge_signal, ladder, readout
from tactcad.mechanics.section import Array, HingeSection
from tactcad.parts.array.bridge_figures import zero_drift
from tactcad.parts.array.hinge_section import design_gauge, design_readout
from tactcad.parts.array.layout import Layout
from tactcad.stacks.variables import OFFSET_SHARE, SIGMAS

from .target import Target

STEP = 1e-4  # relative, of the differences that derivatives are made from


@dataclass(frozen=True)
class Knowledge:
    """Errors of belief, relative; arrays of the elements' shape.

    of_k, of_v   variances of K and K_v, each element's own
    cross        their covariance
    place        of them (K, K_v) for one standard deviation of the contact's place along the arm, in use
                 against as known: no calibration shows it
    common       by name, (K, K_v) for one standard deviation of what all elements share
    load_cell    half-width of the limits of the load cell's compliance, mm/N: K_obj's 1/K_obj shifts by it
    dof          degrees of freedom of each element's own variances
    """

    of_k: Array
    of_v: Array
    cross: Array
    place: tuple[Array, Array]
    common: dict[str, tuple[Array, Array]] = field(default_factory=dict)
    load_cell: float = 0.0
    dof: float = KNOWN

    def calibration_errors(self, z_k: Array, z_v: Array) -> tuple[Array, Array]:
        """Errors of ln K and ln K_v by a calibration from independent standard normal numbers, with their
        covariance; the contact's place apart."""
        k, v = self.place
        first = np.sqrt(np.maximum(self.of_k - k * k, 0.0))
        along = np.divide(self.cross - k * v, first, out=np.zeros_like(first), where=first > 0.0)
        own = np.sqrt(np.maximum(self.of_v - v * v - along**2, 0.0))
        return first * z_k, along * z_k + own * z_v


@dataclass(frozen=True)
class Elements:
    """Elements as the interval's model sees them; arrays of one shape.

    section      their hinges
    stiffness    K, N/mm; NaN beyond the estimator's range
    signal       K_v, V/mm
    per_force    V/N behind the amplifier
    free         as made: what of them carries load, out of the clamp
    """

    section: HingeSection
    stiffness: Array
    signal: Array
    per_force: Array
    free: Elements | None = None


def elements(section: HingeSection, design: Design) -> Elements:
    """K and K_v of hinges by the closed forms, with the design's gauge and read-out."""
    gauge = design_gauge(design)
    fitted = ladder.evaluate(section)
    inside = fitted.valid
    safe = section if inside.all() else section.rows(np.flatnonzero(inside.ravel()))
    signal, per_force = np.full((2, *section.shape), np.nan)
    if inside.any():
        per_strain = readout.volts_per_strain(gauge.factor, design_readout(design))
        per_newton = per_strain * gauge_signal.foil_strain_per_force(safe, gauge)
        per_force[inside] = per_newton.reshape(-1)
        signal[inside] = (per_newton * gauge_signal.stiffness(safe, gauge)).reshape(-1)
    return Elements(section, fitted.stiffness, signal, per_force)


def as_made(section: HingeSection, design: Design, layer: Array | float, turn: Array | float) -> Elements:
    """Elements of which a layer (mm) on every cut face carries nothing, in a clamp that turns (rad/(N mm)):
    its turn adds deflection, and no strain under the gauge. The section stays what can be measured."""
    cut = elements(as_built.without_layer(section, layer), design)
    soft = as_built.in_clamp(section, cut.stiffness, turn) / cut.stiffness
    return Elements(section, cut.stiffness * soft, cut.signal * soft, cut.per_force, cut)


def reading_noise(design: Design) -> float:
    """Standard deviation of one averaged reading in a grasp, V: the read-out's own, and the drift of the
    bridge's zero by its leads' warmth, whose half-width is taken as two standard deviations."""
    r, layout = design_readout(design), Layout(design)
    drift = r.excitation * r.gain * zero_drift(layout) / 4.0
    return float(np.hypot(element_signals.reading_noise(layout), drift / SIGMAS))


def knowledge(target: Target, design: Design, e: Elements, steps: Array | None = None) -> Knowledge:
    """The elements' errors under `target.known`.

    Parameters
    ----------
    target, design
        The target, and the design with its tolerances, read-out and calibration.
    e
        The elements.
    steps
        calibrated: displacements of the calibration after 0, of a shape that broadcasts with the elements.
    """
    sensitivity = _log_derivative(e, design, "load_arm") / e.section.load_arm
    place = target.known.contact / SIGMAS * sensitivity
    of_k, of_v, cross = place[0] ** 2, place[1] ** 2, place[0] * place[1]
    if target.known.how == "calibrated":
        own = _calibrated(target, design, e, np.asarray(steps, dtype=float))
        cell = design.calibration
        assert cell is not None
        limits = cell.load_cell_accuracy / cell.load_cell_stiffness
        known = (of_k + own[0], of_v + own[1], cross + own[2], (place[0], place[1]))
        return Knowledge(*known, load_cell=limits, dof=target.known.runs - 1.0)
    of_v = of_v + (target.known.gauge_factor / SIGMAS) ** 2
    common = {}
    for name, half, derivative, shared in _dimensions(target, design, e):
        k, v = derivative * half / SIGMAS
        if shared > 0.0:
            common[name] = (shared**0.5 * k, shared**0.5 * v)
        own_share = 1.0 - shared
        of_k, of_v, cross = of_k + own_share * k * k, of_v + own_share * v * v, cross + own_share * k * v
    for name, (k, v) in _softening(design, e).items():
        common[name] = (k / SIGMAS, v / SIGMAS)
    return Knowledge(of_k, of_v, cross, (place[0], place[1]), common)


def _dimensions(target: Target, design: Design, e: Elements) -> list[tuple[str, float, Array, float]]:
    """Name, half-width, derivative of ln K and ln K_v, and the share common to all elements, of every
    quantity that is uncertain in an uncalibrated array."""
    t = design.tolerance
    rows = []
    for name, parameter in as_built.DIMENSIONS.items():
        half, alike = getattr(t, name), 1.0 if name in as_built.COMMON else OFFSET_SHARE
        if name == "hinge_thickness" and target.known.how == "inspected":
            half, alike = target.known.thickness, 0.0
        rows.append(
            (name, half, _log_derivative(e, design, parameter) / getattr(e.section, parameter), alike)
        )
    modulus = np.stack([np.ones(e.stiffness.shape), np.zeros(e.stiffness.shape)])
    rows.append(("youngs_modulus", float(t.youngs_modulus or 0.0), modulus, 1.0))
    return rows


def _softening(design: Design, e: Elements) -> dict[str, tuple[Array, Array]]:
    """Change of ln K and ln K_v from those as drawn with the recast layer, or the clamp's turn, at its
    limit."""
    t = design.tolerance
    cut = elements(as_built.without_layer(e.section, t.recast_layer), design)
    clamped = np.log(as_built.in_clamp(e.section, e.stiffness, t.clamp_compliance) / e.stiffness)
    return {
        "recast_layer": (np.log(cut.stiffness / e.stiffness), np.log(cut.signal / e.signal)),
        "clamp_compliance": (clamped, clamped),
    }


def _log_derivative(e: Elements, design: Design, parameter: str) -> Array:
    """dln K/dln p and dln K_v/dln p, (2, elements)."""
    e = e.free or e
    nominal = getattr(e.section, parameter)
    changed = elements(e.section.with_(**{parameter: nominal * (1.0 + STEP)}), design)
    pairs = ((changed.stiffness, e.stiffness), (changed.signal, e.signal))
    return np.stack([np.log(after / before) / np.log1p(STEP) for after, before in pairs])


def _calibrated(target: Target, design: Design, e: Elements, steps: Array) -> tuple[Array, Array, Array]:
    """Variances of K and K_v and their covariance, relative, of `runs` regressions on the stage's
    displacement.

    With k = K K_c/(K + K_c) and v = K_v K_c/(K + K_c) per displacement, an error of the displacement enters
    both; then K = k K_c/(K_c - k) and K_v = v/(1 - k/K_c) carry dln K = (1 + K/K_c) dln k and
    dln K_v = dln v + K/K_c dln k.
    """
    rig, known = design.calibration, target.known
    assert rig is not None
    noise_v = element_signals.reading_noise(Layout(design), alike=True)
    soft = e.stiffness / rig.load_cell_stiffness
    k, v = e.stiffness / (1.0 + soft), e.signal / (1.0 + soft)
    spread = steps * (steps**2 - 1.0) / 12.0 * rig.step**2  # even steps; the reading at 0 is left out
    both = known.displacement_noise**2 / spread
    own_k = known.force_noise**2 / spread / k**2 + known.run_scatter**2
    own_v = noise_v**2 / spread / v**2 + known.run_scatter**2
    of_k = (1.0 + soft) ** 2 * (both + own_k)
    of_v = (1.0 + soft) ** 2 * both + own_v + soft**2 * own_k
    cross = (1.0 + soft) ** 2 * both + (1.0 + soft) * soft * own_k
    return of_k / known.runs, of_v / known.runs, cross / known.runs
