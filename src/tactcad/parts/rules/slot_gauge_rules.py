"""Rule on the gauge of a hinge that is slotted from both sides: it has no flat face but the slots' floors."""

from __future__ import annotations

from collections.abc import Iterator

from ..finding import SAME, Finding
from ..layout import Layout
from .rule import rule, wrong


@rule(after="no_slivers")
def gauge_lies_in_slot(layout: Layout) -> Iterator[Finding]:
    if layout.design.element.sides == "one":
        return
    gauge = layout.design.gauge
    reach = max(gauge.carrier_arm_side, gauge.carrier_body_side, gauge.grid_length / 2)
    for p in layout.elements:
        flat = round(p.hinge.l / 2 - p.hinge.r, 9)
        if reach > flat + SAME:
            yield wrong(
                "element.sides",
                f"no gauge can be bonded on element {p.number}: the floor of its slots is flat for "
                f"{2 * flat:g} mm between the fillets, the carrier reaches {reach:g} mm to a side of "
                "its middle",
                "two",
                f'"one"; or gauge.carrier_arm_side and gauge.carrier_body_side of at most {flat:g} mm',
            )
