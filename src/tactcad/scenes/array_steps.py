"""How the array is put together, and how its pads are made coplanar."""

from __future__ import annotations

from tactcad.parts.description import Vector
from tactcad.parts.layout import Layout
from tactcad.parts.library.screws import seating_torque

from .scene import Step


def array_steps(layout: Layout, designators: tuple[str, ...]) -> tuple[Step, ...]:
    """The steps, each with those of the array's designators that it places."""
    d = layout.design
    gap = 2 * layout.pad_inner
    stack = layout.stack
    clamp = len(layout.screw_x) * 2
    width = stack + 2 * d.clamp.end_plate_thickness

    def named(*prefixes: str, low: int = 1, high: int = 10**6) -> tuple[str, ...]:
        chosen = []
        for name in designators:
            prefix = name.rstrip("0123456789")
            if prefix in prefixes and low <= int(name[len(prefix) :]) <= high:
                chosen.append(name)
        return tuple(chosen)

    def step(title: str, names: tuple[str, ...], explode: Vector, text: str, fan: bool = False) -> Step:
        return Step(title, names, explode, text, fan)

    through = named("SC", high=clamp) if not named("TR") else ()
    carrier_screws = tuple(n for n in named("SC") if n not in through)
    tolerance = d.tolerance.pad_height
    return (
        step(
            "Gauges",
            (),
            (0, 0, 0),
            f"Measure and record the hinge thickness of every element. Bond a gauge on each flat face, its grid centred on the "
            f"hinge within 0.1 mm, carrier trimmed to {d.gauge.carrier_arm_side + d.gauge.carrier_body_side:g} mm; cure, coat, "
            "solder three leads, and lay them in the wire recess towards the rear end.",
        ),
        step(
            "End plate and dowels",
            (*named("EP", low=2), *named("DW")),
            (0, 0.6 * width, 0),
            "Press the dowels square into the tapped end plate (H7, light press). Stand the plate on its outer face.",
        ),
        step(
            "Stack",
            tuple(reversed((*named("SP", "E", "BL"),))),
            (0, -1.5 * stack - 20.0, 0),
            "Slide spacer, element, spacer, ... on the dowels, each row in the order of its numbers. Nothing is tight yet.",
            fan=True,
        ),
        step(
            "Other end plate",
            named("EP", high=1),
            (0, -1.5 * stack - 20.0 - width, 0),
            "Slide the counterbored end plate on the dowels.",
        ),
        step(
            "Coplanar pads",
            (*through, *named("TR", "NU")),
            (0, -1.5 * stack - 40.0 - 1.6 * width, 0),
            f"Set the stack pads down on a surface plate (grade 1 or better). Put a gauge block of {gap:g} mm between the rows' "
            "pads. Press the elements' rear bodies down with a bar of rubber so that every pad stands on the plate, then tighten the "
            "clamping screws crosswise, in three rounds: a third, two thirds, the whole torque. "
            f"Measure: no pad may let a {2 * tolerance * 1e3:g} um feeler pass. Then turn the array on its back and read each pad "
            f"with a lever indicator against the surface plate: all within {tolerance * 1e3:g} um; in the calibration set-up the "
            "heights at which the force gauge first reads 0.01 N show the same to a micrometre. Record them; loosen and repeat if one is off.",
        ),
        step(
            "Stop plate",
            named("ST"),
            (0, 0, 0.8 * width),
            (
                "An array that is still to be calibrated goes to that set-up without stop plate and set screws, its carrier on: the stops would "
                "close before the end of the travel. Afterwards take the carrier off again. "
                if d.calibration
                else ""
            )
            + "Wipe ledges and plate. Lay the stop plate on the ledges, ground face down.",
        ),
        step(
            "Carrier",
            (*named("CA"), *carrier_screws),
            (0, 0, 1.4 * width),
            "Screw the carrier on both end plates. On the surface plate again: the pads must not have moved.",
        ),
        step(
            "Hold the stop plate down",
            named("SS"),
            (0, 0, 2.1 * width),
            f"Turn the set screws in, crosswise, to {seating_torque(d.clamp.screw):g} N m, locked with a drop of thread lacquer. Check each stop: push every pad with a "
            "plastic rod; it must give way and come to a stop, with "
            + ", ".join(
                sorted(
                    {f"{g:g} mm at arm {a:g}" for a, g in _gaps(layout)}, key=lambda s: float(s.split()[-1])
                )
            )
            + f" (within {d.stop.tolerance:g} mm) on the lever indicator at the tip.",
        ),
    )


def _gaps(layout: Layout) -> set[tuple[float, float]]:
    from tactcad.parts.stop_gap import stop_gap

    return {(p.arm, stop_gap(layout, p)) for p in layout.elements}
