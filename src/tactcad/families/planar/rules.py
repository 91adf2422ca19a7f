"""Rules for every planar design; each names the field at fault and its legal range."""

from __future__ import annotations

from collections.abc import Iterator
from math import floor

import numpy as np

from tactcad.design.materials import ALLOYS
from tactcad.parts.language.finding import Finding
from tactcad.parts.language.metric import METRIC
from tactcad.parts.rules.rule import Rule, at_least, at_most, rule, wrong

from . import beam
from .cell_layout import Kind, PlanarLayout
from .field import pull
from .parts import (
    CHIP_ROOM,
    FOOT_INSET,
    SCREW,
    WEB,
    dowel_length,
    post_play,
    screw_length,
    stack_height,
    travel_limit,
)
from .sensor import aside, largest_field, lowest, neighbours_field, rated_force, stop_stress

LAND = 0.1  # mm of an island on the base around its well, at least; chosen
PULL = (
    0.01  # of the rated force, which a neighbour's magnet may pull; chosen: matrices are known to about that
)
CLEAR = 0.1  # mm between parts that pass each other, at least; chosen


def _each(layout: PlanarLayout) -> Iterator[tuple[str, Kind]]:
    return ((kind.name, kind) for kind in layout.used)


def _up(length: float) -> float:
    """To the next 0.1 um; what is not a number stays so."""
    return float(np.ceil(length * 1e4 - 1e-6)) / 1e4


@rule()
def foil_suits_process(layout: PlanarLayout) -> Iterator[Finding]:
    p, process = layout.design.planar, layout.process
    yield from at_least("planar.thickness", f"too thin to be {process.name}", p.thickness, process.thinnest)
    yield from at_most("planar.thickness", f"too thick to be {process.name}", p.thickness, process.thickest)
    spacer = min(kind.table.stop_gap for kind in layout.used)
    name = next(kind.name for kind in layout.used if kind.table.stop_gap == spacer)
    yield from at_least(f"{name}.stop_gap", "spacer thinner than the process takes", spacer, process.thinnest)
    yield from at_least("planar.web", "narrower than the process leaves", p.web, process.web(p.thickness))


@rule(after="foil_suits_process")
def islands_fit_pitch(layout: PlanarLayout) -> Iterator[Finding]:
    p = layout.design.planar
    slot = layout.process.slot(p.thickness)
    for name, kind in _each(layout):
        most = kind.opening - 2.0 * (slot + kind.reach - kind.table.island / 2.0)
        yield from at_most(f"{name}.island", "island meets the frame at this pitch", kind.table.island, most)


@rule(after="islands_fit_pitch")
def beams_can_be_cut(layout: PlanarLayout) -> Iterator[Finding]:
    t, process = layout.design.planar.thickness, layout.process
    for name, kind in _each(layout):
        yield from at_least(
            f"{name}.beam_width",
            "beam narrower than the process leaves",
            kind.table.beam_width,
            process.web(t),
        )
        yield from at_least(
            f"{name}.fillet",
            "fillet smaller than the process leaves",
            kind.table.fillet,
            process.inside_radius(t),
        )
        if kind.pinwheel:
            least = max(process.slot(t), kind.table.fillet + layout.corner)
            yield from at_least(
                f"{name}.slot", "slot narrower than the process or its fillets", kind.table.slot, least
            )
            yield from at_least(
                f"{name}.ear",
                "ear narrower than its corners, or than a web",
                kind.table.ear,
                max(2.0 * layout.corner, process.web(t)),
            )
            yield from at_most(
                f"{name}.ear", "ear meets the next beam's root", kind.table.ear, kind.table.island
            )
            if 2.0 * kind.table.fillet < layout.corner + kind.table.fillet - 1e-9:
                yield wrong(
                    f"{name}.fillet",
                    "ear's corner does not fit over its beam",
                    kind.table.fillet,
                    f"at least {layout.corner:g} mm",
                )
        else:
            side = (kind.table.island - kind.table.beam_width) / 2.0
            yield from at_most(
                f"{name}.fillet",
                "fillets do not fit the island's side",
                kind.table.fillet,
                side - layout.corner,
            )


@rule(after="beams_can_be_cut")
def beams_in_range(layout: PlanarLayout) -> Iterator[Finding]:
    for name, kind in _each(layout):
        if reason := beam.out_of_range(kind.beam):
            found, _, legal = reason.partition("; legal: ")
            yield wrong(
                f"{name}.beam_width", f"beam outside the model's range: {found}", kind.table.beam_width, legal
            )


@rule(after="islands_fit_pitch")
def island_takes_post(layout: PlanarLayout) -> Iterator[Finding]:
    post = layout.design.post
    for name, kind in _each(layout):
        least = post.spigot + 2.0 * layout.process.web(post.foot) + 2.0 * FOOT_INSET
        yield from at_least(
            f"{name}.island", "no foot plate is left around the spigot", kind.table.island, least
        )
        yield from at_most(
            "post.pad",
            "pads of neighbours meet at rated shear",
            post.pad,
            layout.design.planar.pitch - 2.0 * layout.design.housing.side_gap - CLEAR,
        )
    yield from at_least("post.pad", "the post has no shoulder", post.pad, post.spigot + 0.2)


@rule(after="islands_fit_pitch")
def island_lands_on_base(layout: PlanarLayout) -> Iterator[Finding]:
    d = layout.design
    for name, kind in _each(layout):
        yield from at_most(
            "housing.well",
            f"the island of a {name} cell falls into the well",
            d.housing.well,
            kind.corner - LAND - d.magnet.diameter / 2.0,
        )
    yield from at_least(
        "housing.well", "the magnet meets the base at rated shear", d.housing.well, d.housing.side_gap + CLEAR
    )
    yield from at_most(
        "magnet.diameter",
        "wells of neighbours meet",
        d.magnet.diameter,
        d.planar.pitch - 2.0 * d.housing.well - WEB,
    )


@rule()
def chips_fit(layout: PlanarLayout) -> Iterator[Finding]:
    d, chip = layout.design, layout.chip
    widest = max(chip.length, chip.width) + 2.0 * CHIP_ROOM
    yield from at_least("planar.pitch", f"chips {chip.name} do not fit side by side", d.planar.pitch, widest)
    web = layout.base_thickness - chip.height - CHIP_ROOM
    yield from at_least(
        "hall.gap", "too little of the base is left over the chips", d.hall.gap, d.hall.gap + WEB - web
    )
    count, most = len(layout.elements), chip.addresses * d.hall.buses
    if count > most:
        yield wrong(
            "hall.buses",
            f"{count} chips {chip.name} with {chip.addresses} addresses a bus: two would have one address",
            d.hall.buses,
            f"at least {-(-count // chip.addresses)}",
        )


@rule(after="chips_fit")
def screws_fit(layout: PlanarLayout) -> Iterator[Finding]:
    h = layout.design.housing
    if not layout.screwed:
        return
    for name, border in zip(("border", "side"), layout.borders):
        least = METRIC[SCREW].head + 0.6
        yield from at_least(
            f"housing.{name}",
            "no room for the screws' heads",
            border,
            least,
            f'at least {least:g} mm, or joint = "bonded"',
        )
    if screw_length(layout) is None:
        yield wrong(
            "housing.cover_thickness",
            f"no {SCREW} screw engages one diameter and ends in the cover, {stack_height(layout):.3g} mm "
            "from under its head",
            h.cover_thickness,
            "another cover, board, gap of the chips, foot plate or lift",
        )
    if dowel_length(layout) is None:
        yield wrong(
            "housing.cover_thickness", "no dowel is short enough", h.cover_thickness, "a thicker cover"
        )


@rule(after="beams_in_range")
def stop_protects(layout: PlanarLayout) -> Iterator[Finding]:
    limit = layout.design.material.yield_strength
    for name, kind in _each(layout):
        gap, tolerance = kind.table.stop_gap, travel_limit(layout, kind)
        _, rated = rated_force(layout, kind)
        least = _up(lowest(layout, kind, rated) + tolerance)
        what = f"at its limits the stop closes before the rated force of {rated:.3g} N with its shear"
        yield from at_least(f"{name}.stop_gap", what, gap, least)
        if stop_stress(layout, kind, gap + tolerance) > limit:
            low, high = 0.0, gap
            for _ in range(40):
                middle = (low + high) / 2.0
                low, high = (
                    (low, middle) if stop_stress(layout, kind, middle + tolerance) > limit else (middle, high)
                )
            yield wrong(
                f"{name}.stop_gap",
                f"a {name} cell yields before its stop closes",
                gap,
                f"at most {floor(low * 1e4) / 1e4:g} mm",
            )


@rule(after="beams_in_range")
def posts_clear_cover(layout: PlanarLayout) -> Iterator[Finding]:
    for name, kind in _each(layout):
        least = _up(aside(layout, kind) + post_play(layout))
        what = f"the post of a {name} cell meets the cover at rated shear, at the limits of their places"
        yield from at_least("housing.side_gap", what, layout.design.housing.side_gap, least)


@rule(after="beams_in_range")
def magnets_keep_apart(layout: PlanarLayout) -> Iterator[Finding]:
    d = layout.design
    if len(layout.elements) < 2:
        return
    force = pull(layout.magnet, (d.planar.pitch, 0.0))
    rated, name = min((rated_force(layout, kind)[1], name) for name, kind in _each(layout))
    if force > PULL * rated:
        most = d.magnet.diameter * (PULL * rated / force) ** 0.25  # force goes with the square of its volume
        yield wrong(
            "magnet.diameter",
            f"a neighbour's magnet pulls a {name} cell by {1e3 * force:.3g} mN, more than {100 * PULL:g} % "
            f"of its rated force of {rated:.3g} N",
            d.magnet.diameter,
            f"at most {most:.2g} mm, a lower magnet, or a larger pitch",
        )


@rule()
def foil_leaves_magnets_alone(layout: PlanarLayout) -> Iterator[Finding]:
    alloy = layout.design.material.alloy
    if ALLOYS[alloy].magnetic == "yes":
        legal = ", ".join(name for name, other in ALLOYS.items() if other.magnetic != "yes")
        yield wrong("material.alloy", "a magnetic foil pulls the magnets and bends their field", alloy, legal)


@rule(after="chips_fit")
def field_in_scale(layout: PlanarLayout) -> Iterator[Finding]:
    d, chip = layout.design, layout.chip
    near = neighbours_field(layout)
    for name, kind in _each(layout):
        most = (largest_field(layout, kind) + near) * (1.0 + d.magnet.tolerance)
        if most > chip.full_scale:
            yield wrong(
                "hall.gap",
                f"the field of a {name} cell reaches {most:.3g} mT, {chip.name} takes {chip.full_scale:g}",
                d.hall.gap,
                "more, a smaller magnet, or another chip",
            )


def design_rules() -> dict[str, Rule]:
    """Every rule by name, in the order in which they are tried."""
    return {r.name: r for r in globals().values() if isinstance(r, Rule)}
