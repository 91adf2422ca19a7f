"""K_v by one gain for all elements, and which combination of gain and hinge length the data identifies.

The read-out turns strain into volts by one factor, excitation x amplifier gain x gauge factor/4; strain per
deflection is geometric, t/(2 l_e L) for a short hinge. So K_v fixes gain over length, not the gain.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from tactcad.mechanics import gauge_signal, readout, self_heating
from tactcad.studies.array import ArrayModel
from tactcad.studies.published import Published
from tactcad.studies.regression import t_quantile
from tactcad.studies.residuals import matched

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
    per_length_exponent: float  # dlnG/dln(effective length): 1 where gain over length is what is fixed
    signal_per_force: np.ndarray  # predicted with the design's own gain, V/N
    strain_at_most: np.ndarray  # foil strain at the paper's largest deflection
    signal_at_most: np.ndarray  # V, with the design's gain, exact bridge and limits
    nonlinearity: np.ndarray  # of the bridge there
    limited: np.ndarray  # held by the supply or the converter
    resolution: np.ndarray  # N, two standard deviations of the averaged reading
    always_on: self_heating.Heating
    switched: self_heating.Heating
    drift_always_on: np.ndarray  # N, what the drift reads as, by element
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
    per_force = gauge_signal.foil_strain_per_force(s, array.gauge)
    log_gain, scatter = _log_mean(measured, q)
    half = t_quantile(0.95, len(q) - 1) * scatter / len(q) ** 0.5
    lengths = LENGTHS * float(np.median(s.hinge_length))
    lengths = lengths[lengths >= 2 * float(np.max(s.fillet_radius))]
    tried = [_log_mean(measured, _at_length(s, length, array)) for length in lengths]
    effective = [_effective(s, length, array) for length in lengths]
    gains = np.array([g for g, _ in tried])
    gain = float(readout.volts_per_strain(array.gauge.factor, array.readout))
    on, off = (
        how(array.readout.excitation, array.gauge, array.power)
        for how in (self_heating.continuous, self_heating.switched)
    )
    strain = q * t1.deflection.value[here] * 1e-3
    volts = readout.unlimited_output(strain, array.gauge.factor, array.readout)
    held = readout.output(strain, array.gauge.factor, array.readout)
    return GainFit(
        t1.element[here],
        t1.arm.value[here],
        measured,
        np.abs(t1.signal_per_force.value[here]),
        q,
        gain,
        float(np.exp(log_gain)),
        float(np.exp(log_gain - half)),
        float(np.exp(log_gain + half)),
        scatter,
        lengths,
        np.exp(gains),
        np.array([e for _, e in tried]),
        float(np.polyfit(np.log(effective), gains, 1)[0]),
        gain * per_force,
        strain,
        held - readout.output(0.0, array.gauge.factor, array.readout),
        readout.bridge_nonlinearity(array.gauge.factor * strain),
        held != volts,
        2 * array.readout.averaged_noise / (gain * per_force),
        on,
        off,
        *(abs(h.drift) / array.gauge.factor / per_force for h in (on, off)),
    )


def _log_mean(measured: np.ndarray, q: np.ndarray) -> tuple[float, float]:
    ratio = np.log(measured / q)
    return float(ratio.mean()), float(ratio.std(ddof=1))


def _with_length(s, length: float):
    clamp = s.body_length + s.hinge_length / 2
    return s.with_(hinge_length=np.full(s.shape, length), body_length=clamp - length / 2)


def _at_length(s, length: float, array: ArrayModel) -> np.ndarray:
    return gauge_signal.foil_strain_per_deflection(_with_length(s, length), array.gauge)


def _effective(s, length: float, array: ArrayModel) -> float:
    """Mean l_e = t/(2 q L): the length of a short hinge with this strain per deflection."""
    q = _at_length(s, length, array)
    return float((s.hinge_thickness / (2 * q * s.load_arm)).mean())
