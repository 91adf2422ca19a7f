"""Rules for every planar design; each names the field at fault and its legal range."""

from __future__ import annotations

from collections.abc import Iterator
from math import floor
from operator import attrgetter

import numpy as np

from tactcad.design.materials import ALLOYS
from tactcad.parts.language.finding import Finding
from tactcad.parts.language.metric import METRIC
from tactcad.parts.rules.rule import SAME, Rule, at_least, at_most, rule, wrong

from . import beam, parts
from .cell_layout import PlanarLayout
from .field import pull
from .parts import CHIP_ROOM, EDGE, FOOT_INSET, SCREW, WEB, post_play, travel_limit
from .sensor import aside, largest_field, lowest, neighbours_field, rated_force, stop_stress

LAND = 0.1  # mm of an island on the base around its well, at least; chosen
PULL = 0.01  # of the rated force, by a neighbour's magnet; chosen: matrices are known to about that
TRANSFER = 0.3  # ms of a bus a reading: 12 bytes to and fro at 400 kHz, start and addresses included
CLEAR = 0.1  # mm between parts that pass each other, at least; chosen


def no_less(layout: PlanarLayout, field: str, what: str, least: float, legal: str = "") -> Iterator[Finding]:
    """A finding where a field of the design, by its path, is below `least`."""
    return at_least(field, what, attrgetter(field)(layout.design), least, legal)


def no_more(layout: PlanarLayout, field: str, what: str, most: float) -> Iterator[Finding]:
    legal = "" if most > 0.0 else "none beside the design's other values"
    return at_most(field, what, attrgetter(field)(layout.design), most, legal)


def _up(length: float) -> float:
    """To the next 0.1 um; what is not a number stays so."""
    return float(np.ceil(length * 1e4 - 1e-6)) / 1e4


@rule()
def foil_suits_process(layout: PlanarLayout) -> Iterator[Finding]:
    p, process = layout.design.planar, layout.process
    yield from no_less(layout, "planar.thickness", f"too thin to be {process.name}", process.thinnest)
    yield from no_more(layout, "planar.thickness", f"too thick to be {process.name}", process.thickest)
    name = min(layout.used, key=lambda kind: kind.table.stop_gap).name
    what = "spacer thinner than the process takes"
    yield from no_less(layout, f"{name}.stop_gap", what, process.thinnest)
    yield from no_less(layout, "planar.web", "narrower than the process leaves", process.web(p.thickness))


@rule(after="foil_suits_process")
def islands_fit_pitch(layout: PlanarLayout) -> Iterator[Finding]:
    slot = layout.process.slot(layout.design.planar.thickness)
    for kind in layout.used:
        most = kind.opening - 2.0 * (slot + kind.reach - kind.table.island / 2.0)
        yield from no_more(layout, f"{kind.name}.island", "island meets the frame at this pitch", most)


@rule(after="islands_fit_pitch")
def beams_can_be_cut(layout: PlanarLayout) -> Iterator[Finding]:
    t, process, corner = layout.design.planar.thickness, layout.process, layout.corner
    for kind in layout.used:
        width, fillet, slot, ear = (f"{kind.name}.{n}" for n in ("beam_width", "fillet", "slot", "ear"))
        own = kind.table
        yield from no_less(layout, width, "beam narrower than the process leaves", process.web(t))
        yield from no_less(layout, fillet, "fillet smaller than the process leaves", process.inside_radius(t))
        most = (kind.beam_length - EDGE) / 2.0
        yield from no_more(layout, fillet, "fillets leave nothing of the beam between them", most)
        if not kind.pinwheel:
            most = (own.island - own.beam_width) / 2.0 - corner - EDGE
            yield from no_more(layout, fillet, "fillets do not fit the island's side", most)
            continue
        least = max(process.slot(t), own.fillet + corner + EDGE)
        yield from no_less(layout, slot, "slot narrower than the process or its fillets", least)
        least = max(2.0 * corner + EDGE, process.web(t))
        yield from no_less(layout, ear, "ear narrower than its corners, or than a web", least)
        yield from no_more(layout, ear, "ear meets the next beam's root", own.island)
        yield from no_less(layout, fillet, "ear's corner does not fit over its beam", corner + EDGE)


@rule(after="beams_can_be_cut")
def beams_in_range(layout: PlanarLayout) -> Iterator[Finding]:
    for kind in layout.used:
        if reason := beam.out_of_range(kind.beam):
            found, _, legal = reason.partition("; legal: ")
            what = f"beam outside the model's range: {found}"
            yield wrong(f"{kind.name}.beam_width", what, kind.table.beam_width, legal)


@rule(after="islands_fit_pitch")
def island_takes_post(layout: PlanarLayout) -> Iterator[Finding]:
    d, post = layout.design, layout.design.post
    least = post.spigot + 2.0 * layout.process.web(post.foot) + 2.0 * FOOT_INSET
    most = d.planar.pitch - 2.0 * d.housing.side_gap - CLEAR
    for kind in layout.used:
        what = "no foot plate is left around the spigot"
        yield from no_less(layout, f"{kind.name}.island", what, least)
        yield from no_more(layout, "post.pad", "pads of neighbours meet at rated shear", most)
    yield from no_less(layout, "post.pad", "the post has no shoulder", post.spigot + 0.2)


@rule(after="islands_fit_pitch")
def island_lands_on_base(layout: PlanarLayout) -> Iterator[Finding]:
    d = layout.design
    for kind in layout.used:
        what = f"the island of a {kind.name} cell falls into the well"
        yield from no_more(layout, "housing.well", what, kind.corner - LAND - d.magnet.diameter / 2.0)
    what = "the magnet meets the base at rated shear"
    yield from no_less(layout, "housing.well", what, d.housing.side_gap + CLEAR)
    most = d.planar.pitch - 2.0 * d.housing.well - WEB
    yield from no_more(layout, "magnet.diameter", "wells of neighbours meet", most)


@rule()
def chips_fit(layout: PlanarLayout) -> Iterator[Finding]:
    d, chip = layout.design, layout.chip
    widest = max(chip.length, chip.width) + 2.0 * CHIP_ROOM
    yield from no_less(layout, "planar.pitch", f"chips {chip.name} do not fit side by side", widest)
    web = layout.base_thickness - chip.height - CHIP_ROOM
    what = "too little of the base is left over the chips"
    yield from no_less(layout, "hall.gap", what, d.hall.gap + WEB - web)
    count, most = len(layout.elements), chip.addresses * d.hall.buses
    if count > most:
        what = f"{count} chips {chip.name} with {chip.addresses} addresses a bus: two would have one address"
        yield wrong("hall.buses", what, d.hall.buses, f"at least {-(-count // chip.addresses)}")
    fastest = 1e3 / (chip.reading_ms + TRANSFER * -(-count // d.hall.buses))
    if d.hall.rate > fastest:
        what = f"{count} chips {chip.name} are not read so often"
        yield wrong("hall.rate", what, d.hall.rate, f"at most {floor(10.0 * fastest) / 10.0:g} Hz")


@rule(after="chips_fit")
def screws_fit(layout: PlanarLayout) -> Iterator[Finding]:
    if not layout.screwed:
        return
    least = METRIC[SCREW].head + 0.6
    legal = f'at least {least:g} mm, or joint = "bonded"'
    for name, border in zip(("border", "side"), layout.borders):
        yield from at_least(f"housing.{name}", "no room for the screws' heads", border, least, legal)
    field, cover = "housing.cover_thickness", layout.design.housing.cover_thickness
    if parts.screw_length(layout) is None:
        away = f"{parts.stack_height(layout):.3g} mm from under its head"
        what = f"no {SCREW} screw engages one diameter and ends in the cover, {away}"
        yield wrong(field, what, cover, "another cover, board, gap of the chips, foot plate or lift")
    if parts.dowel_length(layout) is None:
        yield wrong(field, "no dowel is short enough", cover, "a thicker cover")


@rule(after="beams_in_range")
def stop_protects(layout: PlanarLayout) -> Iterator[Finding]:
    limit = layout.design.material.yield_strength
    for kind in layout.used:
        field, gap, tolerance = f"{kind.name}.stop_gap", kind.table.stop_gap, travel_limit(layout, kind)
        _, rated = rated_force(layout, kind)
        least = _up(lowest(layout, kind, rated) + tolerance)
        early = gap < least - SAME
        if not early and stop_stress(layout, kind, gap + tolerance) <= limit:
            continue
        ways = np.linspace(0.0, 10.0 * max(gap, least), 20_001)
        most = ways[stop_stress(layout, kind, ways + tolerance) <= limit].max(initial=0.0)
        legal = f"{least:g} to {floor(most * 1e4) / 1e4:g} mm"  # rounded to the side that is legal
        if least > most:
            legal = f"none: over {least:g} mm by that force, under {most:.3g} by yield; a lower rating"
        what = f"at its limits the stop closes before the rated force of {rated:.3g} N with its shear"
        yield wrong(field, what if early else f"a {kind.name} cell yields before its stop closes", gap, legal)


@rule(after="beams_in_range")
def posts_clear_cover(layout: PlanarLayout) -> Iterator[Finding]:
    for kind in layout.used:
        least = _up(aside(layout, kind) + post_play(layout))
        what = f"the post of a {kind.name} cell meets the cover at rated shear, at the limits of their places"
        yield from no_less(layout, "housing.side_gap", what, least)


@rule(after="beams_in_range")
def magnets_keep_apart(layout: PlanarLayout) -> Iterator[Finding]:
    d = layout.design
    if len(layout.elements) < 2:
        return
    force = pull(layout.magnet, (d.planar.pitch, 0.0))
    rated, name = min((rated_force(layout, kind)[1], kind.name) for kind in layout.used)
    if force > PULL * rated:
        most = d.magnet.diameter * (PULL * rated / force) ** 0.25  # force goes with the square of its volume
        what = (
            f"a neighbour's magnet pulls a {name} cell by {1e3 * force:.3g} mN, more than {100 * PULL:g} % "
            f"of its rated force of {rated:.3g} N"
        )
        legal = f"at most {most:.2g} mm, a lower magnet, or a larger pitch"
        yield wrong("magnet.diameter", what, d.magnet.diameter, legal)


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
    for kind in layout.used:
        most = (largest_field(layout, kind) + near) * (1.0 + d.magnet.tolerance)
        if most > chip.full_scale:
            took = f"{chip.name} takes {chip.full_scale:g}"
            what = f"the field of a {kind.name} cell reaches {most:.3g} mT, {took}"
            yield wrong("hall.gap", what, d.hall.gap, "more, a smaller magnet, or another chip")


def design_rules() -> dict[str, Rule]:
    """Every rule by name, in the order in which they are tried."""
    return {r.name: r for r in globals().values() if isinstance(r, Rule)}
