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
from tactcad.report.figures import sig
from tactcad.report.report import Picture, ReportSection, ReportTable

from .prose import drawn, grid, marked, saying, section, table

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
    say, s = saying("gain", g=g, array=array), g.signal
    far, limited = g.element[_far(g)], g.element[s.limited]
    inside = g.fitted_low <= g.design_gain <= g.fitted_high
    spread = g.scatter_at_length.max() / g.scatter_at_length.min() - 1
    drifts = [d.max() * 1e3 for d in (g.drift_always_on, g.drift_switched)]
    return (
        say("one", fitted=(g.fitted_low, g.fitted_high), where="inside" if inside else "OUTSIDE"),
        say("length", longest=g.lengths[-1], at_longest=g.gain_at_length[-1], spread=spread),
        say("off" if len(far) == 1 else "all off" if len(far) else "none off", far=far),
        *([say("limited", limited=limited)] if len(limited) else []),
        say(
            "bridge",
            bent=np.abs(s.nonlinearity).max(),
            strain=s.strain.max(),
            resolution=(s.resolution.min() * 1e3, s.resolution.max() * 1e3),
        ),
        say("heating", drifts=drifts, share=g.switched.power / g.always_on.power),
    )


def _far(g: GainFit) -> np.ndarray:
    return np.abs(g.residual) > 2 * g.scatter


def _heating(g: GainFit, array: ArrayModel) -> ReportTable:
    switched = f"on for {array.power.on_time * 1e3:g} ms in every {array.power.period:g} s"
    ways, drifts = (g.always_on, g.switched), (g.drift_always_on, g.drift_switched)
    return table(
        "gain heating",
        ("power on all the time", switched),
        [w.power * 1e3 for w in ways],
        [w.power_density for w in ways],
        [w.rise for w in ways],
        [w.drift * 1e6 for w in ways],
        [d.min() * 1e3 for d in drifts],
        [d.max() * 1e3 for d in drifts],
    )


def _by_element(g: GainFit) -> ReportTable:
    s = g.signal
    return table(
        "gain by_element",
        *(g.element, g.arm, g.strain_per_deflection * 100, g.measured, marked(g.predicted, _far(g))),
        *(np.expm1(g.residual), g.measured_per_force, s.per_force, s.volts, s.nonlinearity),
        s.resolution * 1e3,
    )


def _lengths(g: GainFit) -> ReportTable:
    pick = np.unique(np.linspace(0, len(g.lengths) - 1, 7).round().astype(int))
    return grid(
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
