"""Rule on the element's contour: no straight piece and no arc so short that neither wire nor kernel makes it."""

from __future__ import annotations

from collections.abc import Iterator

from .element import outline
from .layout import Layout
from .stop_gap import stop_gap

# A tenth of the finest step that any shop here works to (0.01 mm).
LEAST_EDGE = 1e-3
SAME = 1e-9

# Which field makes a piece of the contour short; what is not named here lies between holes.web and the body's heights.
_FIELD = {
    "pad_face": "element.pad_length",
    "pad_side": "element.pad_height",
    "flat_face": "array.row_arms",
    "hinge_face": "element.hinge_length",
    "slot_floor": "element.hinge_length",
    "slot_arm_wall": "element.arm_height",
    "slot_body_wall": "element.body_height",
    "front_slot_arm_wall": "element.arm_height",
    "front_slot_body_wall": "element.body_height",
    "arm_back": "array.row_arms",
    "land_ramp": "element.body_height",
    "stop_land": "stop.land_length",
    "tip": "element.body_height",
    "ledge": "element.seat_length",
    "clamp_edge": "element.rear_height",
    "body_face": "element.seat_length",
    "recess_wall": "element.recess_depth",
    "recess_face": "element.recess_offset",
    "rear_end": "element.rear_height",
    "rear_top": "element.rear_length",
}


def no_slivers(layout: Layout) -> Iterator[tuple[str, str, object, str]]:
    """Every piece of every element's contour is LEAST_EDGE long, or not there at all."""
    seen = set()
    for p in layout.elements:
        gap = stop_gap(layout, p)
        if (p.arm, p.hinge, gap) in seen:
            continue
        seen.add((p.arm, p.hinge, gap))
        for s in outline(layout, p.arm, p.hinge, gap):
            if s.length < LEAST_EDGE - SAME:
                yield (
                    _FIELD.get(s.name, "element.corner_radius"),
                    f"leaves {s.length:.3g} mm of {s.name or 'edge'} on element {p.number}",
                    round(s.length, 9),
                    f"at least {LEAST_EDGE:g} mm of it, or none",
                )
