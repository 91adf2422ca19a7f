"""K_v by one gain for all elements, and the combination of gain and hinge length that the data identifies.

The read-out turns strain into volts by one factor, excitation x amplifier gain x gauge factor/4; strain per
deflection is geometric, t/(2 l_e L) for a short hinge. So K_v determines gain over length, not the gain.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from tactcad.lab.regression import t_quantile
from tactcad.mechanics import gauge_signal, ladder, readout, self_heating
from tactcad.mechanics.section import HingeSection
from tactcad.mechanics.signal import Signal, predict
from tactcad.paper.array_model import ArrayModel
from tactcad.paper.published import Published
from tactcad.paper.residuals import matched

LENGTHS = np.linspace(0.7, 1.5, 17)  # mm


@dataclass(frozen=True)
class GainFit:
    """By element: printed and predicted |K_v| (V/mm), K_v/K (V/N). Gains in V per unit of foil strain."""

    element: np.ndarray
    arm: np.ndarray
    measured: np.ndarray
    measured_per_force: np.ndarray
    strain_per_deflection: np.ndarray  # 1/mm
    design_gain: float
    fitted_gain: float
    fitted_low: float  # 95 % interval
    fitted_high: float
    scatter: float  # standard deviation of ln(measured/predicted)
    lengths: np.ndarray  # slot lengths tried
    gain_at_length: np.ndarray
    scatter_at_length: np.ndarray
    per_length_exponent: float  # dlnG/dln(effective length of K): near 1 only gain over length is determined
    signal: Signal  # with the design's own read-out, at the paper's largest deflection
    always_on: self_heating.Heating
    switched: self_heating.Heating
    drift_always_on: np.ndarray  # N, force equivalent of the drift, by element
    drift_switched: np.ndarray

    @property
    def predicted(self) -> np.ndarray:
        """V/mm with the fitted gain."""
        return self.fitted_gain * self.strain_per_deflection

    @property
    def residual(self) -> np.ndarray:
        return np.log(self.measured / self.predicted)


def fit(data: Published, array: ArrayModel) -> GainFit:
    """One gain for all elements of Table 1 that the design has."""
    here, s = matched(data, array)
    t1 = data.table1
    measured = np.abs(t1.signal_per_deflection.value[here])
    q = gauge_signal.foil_strain_per_deflection(s, array.gauge)
    log_gain, scatter = _log_mean(measured, q)
    half = t_quantile(0.95, len(q) - 1) * scatter / len(q) ** 0.5
    lengths = LENGTHS * float(np.median(s.hinge_length))
    lengths = lengths[lengths >= 2 * float(np.max(s.fillet_radius))]
    others = [_with_length(s, length) for length in lengths]
    tried = [_log_mean(measured, gauge_signal.foil_strain_per_deflection(o, array.gauge)) for o in others]
    gains = np.array([g for g, _ in tried])
    signal = predict(s, array.gauge, array.readout, t1.deflection.value[here] * 1e-3)
    on, off = (
        how(array.readout.excitation, array.gauge, array.power)
        for how in (self_heating.continuous, self_heating.switched)
    )
    newtons = [
        abs(h.drift) * float(readout.volts_per_strain(1.0, array.readout)) / signal.per_force
        for h in (on, off)
    ]
    return GainFit(
        element=t1.element[here],
        arm=t1.arm.value[here],
        measured=measured,
        measured_per_force=np.abs(t1.signal_per_force.value[here]),
        strain_per_deflection=q,
        design_gain=float(readout.volts_per_strain(array.gauge.factor, array.readout)),
        fitted_gain=float(np.exp(log_gain)),
        fitted_low=float(np.exp(log_gain - half)),
        fitted_high=float(np.exp(log_gain + half)),
        scatter=scatter,
        lengths=lengths,
        gain_at_length=np.exp(gains),
        scatter_at_length=np.array([e for _, e in tried]),
        per_length_exponent=float(np.polyfit(np.log([_effective(o) for o in others]), gains, 1)[0]),
        signal=signal,
        always_on=on,
        switched=off,
        drift_always_on=newtons[0],
        drift_switched=newtons[1],
    )


def _log_mean(measured: np.ndarray, q: np.ndarray) -> tuple[float, float]:
    ratio = np.log(measured / q)
    return float(ratio.mean()), float(ratio.std(ddof=1))


def _with_length(s: HingeSection, length: float) -> HingeSection:
    """The same elements with another slot length, the clamp's edge where it is."""
    clamp = s.body_length + s.hinge_length / 2
    return s.with_(hinge_length=np.full(s.shape, length), body_length=clamp - length / 2)


def _effective(s: HingeSection) -> float:
    """Mean E b t^3/(12 K L^2): length of a short hinge with this stiffness, which Table 1's K determines."""
    K = ladder.stiffness(s)
    return float((s.youngs_modulus * s.width * s.hinge_thickness**3 / (12 * K * s.load_arm**2)).mean())
