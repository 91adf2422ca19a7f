"""Whether every element's signal stays in range, and tells the force that the design wishes for."""

from __future__ import annotations

from collections.abc import Iterator

from tactcad.circuit.element_signals import element_signals
from tactcad.design.tree import Design
from tactcad.parts.finding import Finding
from tactcad.parts.hinge_section import design_readout
from tactcad.parts.layout import Layout


def check_signals(design: Design) -> Iterator[Finding]:
    """Failures by element. Raises CheckFailure where one is out of the estimator's range."""
    layout, chain, wish = Layout(design), design_readout(design), design.readout.force_resolution
    for signal in element_signals(layout):
        who = signal.place.designator
        for load, (low, high) in (("rated force", signal.rated), ("overload", signal.overload)):
            if low < chain.lowest or high > chain.highest:
                message = (
                    f"at the {load} its output reaches {low:.3g} or {high:.3g} V, tolerances at their worst; "
                    f"amplifier and converter take {chain.lowest:.3g} to {chain.highest:.3g}"
                )
                yield Finding("signal-range", "fail", who, (), max(-low, high), chain.highest, message)
                break
        told = signal.resolution * 1e3
        if wish is not None and told > wish:
            message = (
                f"tells no less than {told:.3g} mN from none (noise, quantisation, drift); "
                f"readout.force_resolution asks for {wish:g} mN"
            )
            yield Finding("force-resolution", "fail", who, (), told, wish, message)
