"""Whether the gauges bear their foil's strain; and parts with unverified figures.

A limit that nobody read in a maker's sheet never decides silently: results that depend on it are flagged,
with the parts.
"""

from __future__ import annotations

from collections.abc import Iterator

from tactcad.checks.check import Check
from tactcad.circuit.element_signals import ElementSignal, element_signals
from tactcad.design.messages import CheckFailure
from tactcad.design.sensing import FOILS
from tactcad.design.tree import Design
from tactcad.parts.array.layout import Layout
from tactcad.parts.bought.electronic_parts import parts_used
from tactcad.parts.language.finding import Finding

# Results that depend on the figures of each kind of part.
STAND_ON = {
    "amplifier": "range, common mode, settling, noise, drift",
    "multiplexer": "supplies, settling, noise",
    "switch": "signal, the bridges' supply",
    "converter": "range, noise, time, drift",
    "completion": "imbalance, drift",
    "foil": "strain and fatigue of the gauge",
}


def check_gauges(design: Design) -> Iterator[Finding]:
    """Flags on the foil's strain, and on figures that were not read."""
    foil = FOILS[design.gauge.foil]
    try:
        signals = element_signals(Layout(design))
    except CheckFailure:  # out of the estimator's range: reported by the check of signals
        signals = []
    unread = "" if foil.verified else "; the limit is unread"
    tried = f"makers try them for {foil.cycles:.0e} cycles at"
    for check, strain, limit, said in (
        ("gauge-fatigue", _rated, foil.fatigue, f"at the rated force; {tried} +-{foil.fatigue * 1e6:g}"),
        ("gauge-strain", _overload, foil.strain, f"at overload; it bears {foil.strain * 1e6:g}"),
    ):
        if over := [s for s in signals if strain(s) > limit]:
            worst = max(over, key=strain)
            message = (
                f"foil {foil.name} of {len(over)} of {len(signals)} elements is strained by up to "
                f"{strain(worst) * 1e6:.0f} e-6 {said} e-6{unread}"
            )
            yield Finding(check, "flag", worst.place.designator, (), strain(worst), limit, message)
    if from_memory := {kind: part for kind, part in parts_used(design).items() if not part.verified}:
        names = "; ".join(f"{part.name} ({STAND_ON[kind]})" for kind, part in from_memory.items())
        message = f"not every figure was read in the maker's own sheet of: {names}"
        yield Finding("unread-figures", "flag", design.name, (), len(from_memory), 0, message)


def _rated(signal: ElementSignal) -> float:
    return signal.rated_strain


def _overload(signal: ElementSignal) -> float:
    return signal.overload_strain


CHECKS = (Check("gauge limits", "design", lambda design, _: check_gauges(design), place=65),)
