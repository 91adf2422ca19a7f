"""The bonding jig: a bed that holds every magnet under its island, and a guide that keeps the posts upright.

    | |    | |       posts, in the guide's bores
 ===| |====| |===    guide, on the array's own upper spacer
!__[===]__[===]____  foot plates on the foil, which lies on the bed against three pins
!|_|(m)|__|(m)|___|  bed with a bore for every magnet, on a sheet of steel
   push    push      holes, by which the magnets are pushed out
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from tactcad.contour import rectangle
from tactcad.parts.array.supplies import supplies as bill_lines
from tactcad.parts.bought.standard_parts import LEAST_PLAY, dowel, dowel_diameter, dowel_lengths
from tactcad.parts.language.description import Extrusion, Hole, Part, Vector
from tactcad.parts.language.finding import Finding
from tactcad.parts.language.limits import Characteristic
from tactcad.parts.rules.rule import fits
from tactcad.scenes.builder import Builder, telling
from tactcad.scenes.moves import PRESS, TWEEZED
from tactcad.scenes.requirement import Built, DimensionLimits, Requirement, variable
from tactcad.scenes.rig import plain_rig
from tactcad.scenes.scene import STILL, Move, Scene

from . import parts
from .cell_array import MAGNET_BOND, MAGNET_PLACE
from .cell_layout import PlanarLayout
from .cell_tables import PlanarDesign
from .parts import DOWEL, MAGNET_LIMIT, PAD_FIELD, PLATE_ZONE, REAMED, bored, foil_zone, milled
from .rules import no_less, no_more

said = telling(__file__)

NAME = "bonding"
BESIDE = 4.0  # mm of bed beyond the foil, all round; chosen: room for the pins
UNDER = 2.0  # mm of bed below the magnets: stiff, and near enough for a steel sheet to hold them
PUSH = 0.7  # of a magnet's diameter: the hole to push it out; chosen: leaves a ledge
DRILL, WALL = 0.5, 0.8  # mm: least hole, and least wall between bores: checks/data/shop.toml
FILM, DEPTH = 0.03, 0.01  # mm of adhesive over a magnet, limit of its bore's depth; chosen: none stands out
PIN_PLAY = 0.01  # mm between a pin's middle size and the foil's edge: its largest radius is less
INSET, SHORT = 0.5, 0.3  # mm: guide inside the foil's edge, clear of the pins; posts over the guide
SLID = 0.3  # mm that the foil is laid beside its pins, and pushed; chosen
FOAM, BRASS = 5.0, 8.4e-3  # mm of foam under the weight; g/mm3
LIFTED = 40.0  # mm that what the jig holds is lifted off; chosen: clear of its pins
OVER: Vector = (0.0, 0.0, LIFTED)
ASIDE: Vector = (-200.0, 0.0, LIFTED)
WEIGHT = 10.0  # g on every post; chosen: presses its shoulder flat, bends nothing on the bed
TOOLS = ("sheet of steel, 1 mm or more, larger than the bed", "tweezers of plastic", "felt pen")


def bore(layout: PlanarLayout) -> float:
    """Least diameter of a magnet's bore, mm; the largest is REAMED more."""
    return round(layout.design.magnet.diameter + MAGNET_LIMIT + LEAST_PLAY, 6)


def height(layout: PlanarLayout) -> float:
    """Of the bed."""
    return round(layout.design.magnet.height + FILM + UNDER, 9)


def pin_length(layout: PlanarLayout) -> float | None:
    """From the bed's lower face to the spacer's upper one at least."""
    return next((n for n in dowel_lengths(DOWEL) if n >= height(layout) + layout.cover_z), None)


def pins(layout: PlanarLayout) -> parts.Places:
    """Middles of the pins: two at the foil's lower edge, one at its left one, by which it is dimensioned."""
    (hx, hy), r = layout.half, dowel_diameter(DOWEL) / 2.0 + PIN_PLAY
    x = round(0.8 * hx, 2)
    return (-x, -hy - r), (x, -hy - r), (-hx - r, 0.0)


def bed(layout: PlanarLayout) -> Part:
    """z = 0 its lower face."""
    t, (hx, hy), m = height(layout), layout.half, layout.design.magnet
    wide, deep = round(bore(layout) + REAMED / 2.0, 6), round(m.height + FILM, 9)
    push, well = round(PUSH * m.diameter, 2), (wide, deep)
    holes = [Hole("magnet", (x, y, t), (0, 0, -1), push, t, True, well) for x, y in layout.places]
    holes += bored("pin_hole", pins(layout), dowel_diameter(DOWEL), t, parts.PRESSED)
    body = Extrusion(rectangle(-hx - BESIDE, -hy - BESIDE, hx + BESIDE, hy + BESIDE), t)
    low, zones = bore(layout), {"magnet": PLATE_ZONE, "pin_hole": PLATE_ZONE}
    wells = f"counterbores {low:g} to {low + REAMED:g} wide, {deep:g} ±{DEPTH:g} deep, floor flat"
    notes, fit = (wells, "pin holes masked when anodising"), (parts.pin_bore(DOWEL),)
    return milled(layout, "bonding-bed", "Bonding jig, bed", body, holes, zones, notes, fit)


def guide_bore(layout: PlanarLayout) -> Characteristic:
    """Limits of the guide's bores: it floats, and slips over all posts wherever foil and guide have them."""
    low = round(layout.design.post.pad + LEAST_PLAY + foil_zone(layout, layout.process) + PLATE_ZONE, 6)
    return Characteristic("bore diameter", low, round(low + REAMED, 6), low, between=("bore",))


def guide(layout: PlanarLayout) -> Part:
    """As thick as the posts are long over the spacer, less SHORT; z = 0 its lower face."""
    (hx, hy), own = layout.half, guide_bore(layout)
    t = round(layout.pad_z - layout.cover_z - SHORT, 9)
    outline = rectangle(INSET - hx, INSET - hy, hx - INSET, hy - INSET)
    body, holes = Extrusion(outline, t), bored("bore", layout.places, own.nominal, t)
    zones = {"bore": PLATE_ZONE}
    return milled(layout, "bonding-guide", "Bonding jig, guide", body, holes, zones, bores=(own,))


def leans(layout: PlanarLayout) -> float:
    """Most that the thinnest post leans in the widest bore, mrad."""
    play = guide_bore(layout).upper - layout.design.post.pad + PAD_FIELD
    return 1e3 * play / guide(layout).extrusion.thickness


def scene(design: PlanarDesign, _pose: object = None) -> Scene:
    """All in one cure; z = 0 is the bed's face, on which the foil lies."""
    b, layout = Builder(), PlanarLayout(design)
    t, n, low = design.planar.thickness, len(layout.elements), -height(layout)
    under = b.place("BJ", bed(layout), (0, 0, low))
    for x, y in pins(layout):
        b.meet(b.place("DP", dowel(DOWEL, pin_length(layout) or 0.0), (x, y, low)), under, "press")
    b.step("Bed", (0, 0, -20), said("Bed"), tools=(*TOOLS, PRESS, "a flat plate under the bed as stop"))
    below = -design.magnet.height - FILM
    magnets = [b.place("M", parts.magnet(layout), (x, y, below), on=under) for x, y in layout.places]
    b.step(
        "Magnets",
        (0, 0, 12),
        said("Magnets", n=n),
        by=TWEEZED,
        sets=("magnets in their bores: along x and y; along z, by the steel",),
        leaves=("magnets: turn about z",),
    )
    foil = b.place("F", parts.foil(layout), (0, 0, 0), on=under)
    aside = (SLID, SLID, 0.0)
    b.step(
        "Foil",
        (0, 0, 20),
        said("Foil", film=FILM),
        order=[Move((foil,), (SLID, SLID, 20.0), (aside, (0.0, 0.0, 0.0)))],
        sets=(f"{foil} on {under}: along z", f"{foil} against DP1 DP2 DP3: along x and y, turn about z"),
        leaves=(f"{foil}: away from the pins, until the spacer lies on it",),
    )
    post = parts.post(layout)
    feet = {kind.name: parts.foot(layout, kind) for kind in layout.used}
    upper = b.place("SP", parts.upper_spacer(layout), (0, 0, t), on=foil)
    b.step(
        "Upper spacer",
        (0, 0, 26),
        said("Upper spacer"),
        sets=(f"{upper} on {foil}: along z", f"{upper} against DP1 DP2 DP3: along x and y, turn about z"),
        leaves=(f"{upper}: away from the pins",),
    )
    plates = [b.place("FP", feet[e.kind.name], (e.x, e.y, t), on=foil) for e in layout.elements]
    b.step(
        "Foot plates",
        (0, 0, 32),
        said("Foot plates"),
        by=TWEEZED,
        sets=("foot plates on their islands: along z, turn about x and y",),
        leaves=("foot plates: along x and y, until the posts are in; turn about z, by eye",),
    )
    above = round(t + design.post.foot, 9)
    posts = [b.place("P", post, (x, y, above), on=foot) for (x, y), foot in zip(layout.places, plates)]
    b.step(
        "Posts",
        (0, 0, 42),
        "Wet spigot and shoulder of every post, and set it through foot plate and foil down on its shoulder.",
        by=TWEEZED,
        sets=("posts through foot plates and foil: along x and y; along z, by their shoulders",),
        leaves=("posts: lean, until the guide holds them",),
    )
    floating = b.place("BG", guide(layout), (0, 0, layout.cover_z), on=upper)
    (hx, hy), top = layout.half, layout.pad_z
    tall = FOAM + WEIGHT * n / (4.0 * hx * hy * BRASS)
    weight = b.aid("foam and weight of brass", (-hx, -hy, top), (hx, hy, top + tall))
    b.step(
        "Guide and weight",
        (0, 0, 60),
        said("Guide and weight", leans=leans(layout), foam=FOAM, weight=WEIGHT * n, short=SHORT),
        tools=(f"soft foam, {FOAM:g} mm", f"flat weight of brass, {WEIGHT * n:g} g"),
        order=[(floating,), Move((weight,), OVER, (STILL,))],
        sets=("posts in the guide: turn about x and y", "all in the jig: along z, by the weight"),
    )
    b.supplies += [*bill_lines("cells adhesive", {}), *bill_lines("cells release", {})]
    b.step(
        "Cure",
        (0, 0, 0),
        "Leave it until the adhesive has cured by its own sheet, cold: heat takes magnets' field.",
        sets=("foil, foot plates, posts and magnets: all, by adhesive",),
    )
    b.step(
        "Out of the jig",
        (0, 0, 0),
        said("Out of the jig", push=PUSH * design.magnet.diameter - 0.1),
        order=[
            Move((weight,), STILL, (OVER, ASIDE)),
            *(Move((name,), STILL, (OVER, ASIDE)) for name in (floating, upper)),
            Move((foil, *plates, *posts, *magnets), STILL, (OVER,)),
        ],
        apart=True,
    )
    return b.scene(NAME)


@fits
def jig_takes_magnets(layout: PlanarLayout) -> Iterator[Finding]:
    """Bores that can be made side by side, and pins long enough."""
    d, wide = layout.design, bore(layout) + REAMED
    what = "a magnet's hole in the bonding jig cannot be drilled"
    yield from no_less(layout, "magnet.diameter", what, round(DRILL / PUSH, 3))
    if len(layout.elements) > 1:
        what = "no wall is left between the bonding jig's bores"
        yield from no_less(layout, "planar.pitch", what, round(wide + WALL, 3))
        what = "no wall is left between the bores of the bonding jig's guide"
        most = d.planar.pitch - WALL - guide_bore(layout).upper + d.post.pad
        yield from no_more(layout, "post.pad", what, round(most, 3))
    if pin_length(layout) is None:
        most = round(dowel_lengths(DOWEL)[-1] - layout.cover_z - FILM - UNDER, 3)
        yield from no_more(layout, "magnet.height", "no pin of the bonding jig is long enough", most)
    least = round(d.housing.border + float(DOWEL) - layout.half[0], 3)
    yield from no_less(layout, "housing.border", "the bonding jig's two pins meet", least)


def requirements(layout: PlanarLayout, known: dict[str, DimensionLimits]) -> list[Requirement]:
    """Magnets in their places, by the jig's limits and the foil's; adds the variables to `known`."""
    d, n = layout.design, len(layout.elements)
    jig, foil, cut = f"{d.name}-bonding-bed", f"{d.name}-foil", layout.process.tolerance(d.planar.thickness)
    play = (bore(layout) + REAMED - d.magnet.diameter + MAGNET_LIMIT) / 2.0
    causes: tuple[tuple[str, float, int, tuple[tuple[str, str], ...]], ...] = (
        ("magnet in its bore", play, n, ()),
        ("places of the bed's bores", PLATE_ZONE / 2.0, n, ((jig, "magnet holes"),)),
        ("places of the bed's pins", PLATE_ZONE / 2.0, 1, ((jig, "pin hole holes"),)),
        ("places of islands", foil_zone(layout, layout.process) / 2.0, n, ((foil, "spigot holes"),)),
        ("foil's edges", cut, 1, ()),
    )
    known[MAGNET_BOND] = variable(MAGNET_BOND, 0.0, FILM + DEPTH + MAGNET_LIMIT)

    def placed(axis: str) -> Requirement:
        own = [f"{MAGNET_PLACE}{axis}: {what}" for what, *_ in causes]
        for name, (_, limit, pieces, stated) in zip(own, causes, strict=True):
            known[name] = variable(name, -limit, limit, pieces, stated)

        def value(a: Built) -> np.ndarray:
            return sum((a.made[name] for name in own), np.zeros(n))

        asked, fields = d.tolerance.magnet_place, ("tolerance.magnet_place",)
        return Requirement(f"bonding: magnets along {axis}", "mm", -asked, asked, value, fields=fields)

    return [placed("x"), placed("y")]


RIG = plain_rig(NAME, scene, (jig_takes_magnets,), requirements)
