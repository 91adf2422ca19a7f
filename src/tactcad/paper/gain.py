"""K_v by one gain for all elements, and the combination of gain and hinge length that the data identifies.

The read-out turns strain into volts by one factor, excitation x amplifier gain x gauge factor/4; strain per
deflection is geometric, t/(2 l_e L) for a short hinge. So K_v determines gain over length, not the gain.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from tactcad.lab.regression import t_quantile
from tactcad.mechanics import gauge_signal, ladder, readout
from tactcad.mechanics.readout import Signal, predict
from tactcad.mechanics.section import HingeSection
from tactcad.paper.array_model import ArrayModel
from tactcad.paper.published import Published
from tactcad.paper.residuals import matched
from tactcad.report import plots as d
from tactcad.report.figures import exact, interval, listed, percent, sig, signed_percent
from tactcad.report.report import Cell, Marked, Picture, ReportSection, ReportTable

from .prose import drawn, section, table, tabulated

LENGTHS = np.linspace(0.7, 1.5, 17)  # mm


@dataclass(frozen=True)
class GainFit:
    """For each element: printed and predicted |K_v| (V/mm), K_v/K (V/N). Gains in V per unit of foil
    strain."""

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
    always_on: gauge_signal.Heating
    switched: gauge_signal.Heating
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
        for how in (gauge_signal.continuous, gauge_signal.switched)
    )
    volts = float(readout.volts_per_strain(1.0, array.readout))
    newtons = [abs(h.drift) * volts / signal.per_force for h in (on, off)]
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
    """The same elements with another slot length and the same clamp edge."""
    clamp = s.body_length + s.hinge_length / 2
    return s.with_(hinge_length=np.full(s.shape, length), body_length=clamp - length / 2)


def _effective(s: HingeSection) -> float:
    """Mean E b t^3/(12 K L^2): length of a short hinge with this stiffness, which Table 1's K determines."""
    K = ladder.stiffness(s)
    return float((s.youngs_modulus * s.width * s.hinge_thickness**3 / (12 * K * s.load_arm**2)).mean())


def page(g: GainFit, array: ArrayModel) -> ReportSection:
    return section(
        "gain", findings(g, array), (_by_element(g), _lengths(g), _heating(g, array)), (_plot(g),), g
    )


def findings(g: GainFit, array: ArrayModel) -> tuple[str, ...]:
    far = np.abs(g.residual) > 2 * g.scatter
    inside = g.fitted_low <= g.design_gain <= g.fitted_high
    change = g.scatter_at_length.max() / g.scatter_at_length.min() - 1
    sentences = [
        f"One gain of {sig(g.fitted_gain)} V per unit of strain (95 % "
        f"{interval(g.fitted_low, g.fitted_high)}) leaves a scatter of {percent(g.scatter)} in K_v. "
        f"Excitation {array.readout.excitation:g} V × amplifier {array.readout.gain:g} × gauge factor "
        f"{array.gauge.factor:g}/4 gives {sig(g.design_gain)}, {'inside' if inside else 'OUTSIDE'} that "
        "interval.",
        "What the data identify is gain over hinge length, not the gain: over slot lengths from "
        f"{g.lengths[0]:.2f} to {g.lengths[-1]:.2f} mm the fitted gain runs from "
        f"{sig(g.gain_at_length[0])} to {sig(g.gain_at_length[-1])} V (as the effective length that K fixes "
        f"to the power {g.per_length_exponent:.2f}; a grid longer than the leaf keeps it below 1), while the "
        f"scatter changes by {percent(change)} of itself.",
        (
            f"Element{'s' if far.sum() > 1 else ''} {listed(f'no. {n}' for n in g.element[far])} "
            f"lie{'' if far.sum() > 1 else 's'} more than two standard deviations off."
            if far.any()
            else "No element lies more than two standard deviations off: gauge place and bonding scatter "
            "over all of them alike."
        ),
    ]
    if g.signal.limited.any():
        sentences.append(
            "At the paper's largest deflections the read-out of "
            f"{listed(f'no. {n}' for n in g.element[g.signal.limited])} reaches a supply's or the "
            "converter's limit."
        )
    sentences.append(
        f"The quarter bridge is non-linear by up to {percent(np.abs(g.signal.nonlinearity).max())} at the "
        f"paper's largest deflections (strains up to {percent(g.signal.strain.max())}); two standard "
        "deviations of the averaged reading are "
        f"{interval(g.signal.resolution.min() * 1e3, g.signal.resolution.max() * 1e3, 2)} mN, "
        "with the noise that the design assumes."
    )
    sentences.append(
        f"With power on all the time a grid stays {sig(g.always_on.rise, 2)} K warmer than its leaf at "
        f"{sig(g.always_on.power_density, 2)} kW/m² and reads up to "
        f"{sig(g.drift_always_on.max() * 1e3, 2)} mN too much; powered only while reading, "
        f"{sig(g.switched.rise, 2)} K and {sig(g.drift_switched.max() * 1e3, 2)} mN remain at the end of "
        f"a reading, with {percent(g.switched.power / g.always_on.power)} of the heat."
    )
    return tuple(sentences)


def _heating(g: GainFit, array: ArrayModel) -> ReportTable:
    switched = f"on for {array.power.on_time * 1e3:g} ms in every {array.power.period:g} s"
    return tabulated(
        "gain heating",
        (("power on all the time", g.always_on, g.drift_always_on), (switched, g.switched, g.drift_switched)),
        ("", "", lambda row: row[0]),
        ("mean power", "mW", lambda row: row[1].power * 1e3),
        ("per grid area", "kW/m²", lambda row: row[1].power_density),
        ("grid over leaf", "K", lambda row: row[1].rise),
        ("drift dR/R", "10⁻⁶", lambda row: f"{row[1].drift * 1e6:.1f}".replace("-", "−")),
        ("reads as, least", "mN", lambda row: row[2].min() * 1e3),
        ("largest", "mN", lambda row: row[2].max() * 1e3),
    )


def _by_element(g: GainFit) -> ReportTable:
    def fitted(i: int) -> Cell:
        return Marked(g.predicted[i]) if abs(g.residual[i]) > 2 * g.scatter else g.predicted[i]

    return tabulated(
        "gain by_element",
        range(len(g.element)),
        ("element", "", lambda i: int(g.element[i])),
        ("arm a", "mm", lambda i: exact(g.arm[i])),
        ("foil strain per deflection", "%/mm", lambda i: g.strain_per_deflection[i] * 100),
        ("K_v printed", "V/mm", lambda i: exact(g.measured[i])),
        ("K_v, fitted gain", "V/mm", fitted),
        ("printed over fitted", "−1", lambda i: signed_percent(np.expm1(g.residual[i]))),
        ("K_v/K printed", "V/N", lambda i: exact(g.measured_per_force[i])),
        ("K_v/K, design's gain", "V/N", lambda i: g.signal.per_force[i]),
        ("signal at largest deflection", "V", lambda i: g.signal.volts[i]),
        ("bridge non-linearity", "", lambda i: percent(g.signal.nonlinearity[i])),
        ("resolution", "mN", lambda i: g.signal.resolution[i] * 1e3),
    )


def _lengths(g: GainFit) -> ReportTable:
    pick = np.unique(np.linspace(0, len(g.lengths) - 1, 7).round().astype(int))
    return table(
        "gain lengths",
        (("slot length", "mm"), *((f"{g.lengths[i]:.2f}", "") for i in pick)),
        (
            ("fitted gain, V", *(sig(g.gain_at_length[i]) for i in pick)),
            ("scatter of ln K_v", *(f"{g.scatter_at_length[i]:.4f}" for i in pick)),
        ),
    )


def _plot(g: GainFit) -> Picture:
    with d.panels(1, 2, size=(11.2, 4.4)) as (figure, (left, right)):
        span = np.array([g.predicted.min() * 0.7, g.predicted.max() * 1.4])
        low, high = span * np.exp(-g.scatter), span * np.exp(g.scatter)
        shade = {"color": d.SKY, "alpha": 0.35, "lw": 0}
        left.fill_between(span, low, high, label="± one standard deviation", **shade)
        left.plot(span, span, color=d.BLACK, lw=1.2)
        left.plot(g.predicted, g.measured, "o", color=d.RED, ms=8, mec="white")
        used: list[tuple[float, float]] = []
        for x, y, n in zip(g.predicted, g.measured, g.element):
            shift = 9 if not any(abs(x - a) < 0.05 * x and abs(y - b) < 0.06 * y for a, b in used) else -22
            d.note(left, f"{n}", (x, y), (shift, -4), fontsize=10)
            used.append((x, y))
        d.log_axes(left, x=(3, 4, 5, 6, 8, 10), y=(2, 3, 4, 6, 8, 10))
        left.set(xlim=span, xlabel="K_v predicted with one gain, V/mm", ylabel="K_v printed, V/mm")
        left.set_title("by element number")
        left.legend(loc="upper left")
        right.plot(g.lengths, g.gain_at_length, "-", color=d.BLUE, lw=2)
        right.axhline(g.design_gain, color=d.RED, ls="--", lw=1.6)
        end, style = (g.lengths[-1], g.design_gain), {"ha": "right", "color": d.RED, "fontsize": 10}
        d.note(right, "the design's read-out", end, (0, -15), **style)
        right.set(ylim=0, xlabel="slot length l, mm", ylabel="gain that fits K_v best, V per unit strain")
        right.set_title("gain and length: every point on the line fits equally well")
        return drawn(figure, "gain")
