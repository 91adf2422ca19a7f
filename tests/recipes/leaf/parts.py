"""The leaf and its block, the rule on them, and what the leaf does under its force."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import asdict, dataclass

from tactcad.contour import rectangle
from tactcad.parts.array.element import sheet_material
from tactcad.parts.array.measurements import Measurement
from tactcad.parts.language.description import Extrusion, Part
from tactcad.parts.language.finding import Finding
from tactcad.parts.language.limits import FACES, within
from tactcad.parts.rules.rule import Rule, at_least, rule

from .tables import LeafLayout, LeafPlace

BLOCK, SHORTEST = 8.0, 5.0  # mm; length over thickness: below it shear counts


def leaf(layout: LeafLayout) -> Part:
    d = layout.design
    strip = rectangle(-d.leaf.held, 0.0, d.leaf.length, d.leaf.width)
    return Part(
        part_no=f"{d.name}-leaf",
        name="Leaf",
        process="wire-cut",
        material=sheet_material(d),
        body=Extrusion(strip, d.sheet.thickness),
        characteristics=(within("thickness", d.sheet.thickness, 0.02, between=FACES),),
    )


def block(layout: LeafLayout) -> Part:
    d = layout.design
    body = Extrusion(rectangle(-d.leaf.held, 0.0, 0.0, d.leaf.width), BLOCK)
    return Part(
        f"{d.name}-block",
        "Block",
        "milled",
        sheet_material(d),
        body,
        characteristics=(within("thickness", BLOCK, 0.05, between=FACES),),
    )


@rule()
def leaf_is_slender(layout: LeafLayout) -> Iterator[Finding]:
    least = SHORTEST * layout.design.sheet.thickness
    yield from at_least("leaf.length", "too short for a beam", layout.design.leaf.length, least)


def rules() -> dict[str, Rule]:
    return {leaf_is_slender.name: leaf_is_slender}


def about(layout: LeafLayout) -> str:
    return f"A leaf spring {layout.design.leaf.length:g} mm long on a block."


def measured(layout: LeafLayout) -> list[tuple[LeafPlace, str, tuple[Measurement, ...]]]:
    part = leaf(layout)
    (c,) = part.characteristics
    size = Measurement(c.name, c.nominal, c.lower, c.upper, True, "", "at the block's edge", "micrometer")
    return [(place, part.part_no, (size,)) for place in layout.elements]


@dataclass(frozen=True)
class LeafEstimate:
    """N, mm, N/mm; strain at the block's edge."""

    number: int
    arm: float
    stiffness: float
    expected_error: None
    force: float
    yield_force: float
    rated_force: float
    elastic: bool
    gauge_strain: float
    peak_strain: float


def rows(layout: LeafLayout, _rung: str, force: float | None) -> list[LeafEstimate]:
    """Euler's cantilever: K = E b t^3 / (4 l^3), strain 6 F l / (E b t^2)."""
    d, b, t = layout.design, layout.design.leaf.width, layout.design.sheet.thickness
    E, length = d.material.youngs_modulus, d.leaf.length
    at_yield = d.material.yield_strength * b * t**2 / (6 * length)
    load = d.rating.force if force is None else force
    strain = 6 * load * length / (E * b * t**2)
    rated = min(d.rating.force, at_yield / d.rating.yield_factor)
    stiffness = E * b * t**3 / (4 * length**3)
    return [LeafEstimate(1, length, stiffness, None, load, at_yield, rated, load < at_yield, strain, strain)]


def calibrate(args, design) -> int:
    """Three components at once, in a table of this family's own: a line a load, the tip's ways and forces."""
    table = [[float(v) for v in line.split(",")] for line in open(args.file, encoding="utf-8")]
    softness = [w / f for row in table for w, f in zip(row[:3], row[3:], strict=True) if f]
    print(f"{design.name}: " + ", ".join(f"{1 / c:.4g} N/mm" for c in softness))
    return 0


def golden(design) -> dict[str, dict]:
    layout = LeafLayout(design)
    (row,), no = rows(layout, "", None), leaf(layout).part_no
    return {"E1": {"part_no": no, "stiffness_n_per_mm": row.stiffness, "yield_force_n": row.yield_force}}


def strength(layout: LeafLayout) -> bytes:
    identity = layout.design.design
    row = {"design": identity.name, "revision": identity.revision} | asdict(rows(layout, "", None)[0])
    return (",".join(row) + "\r\n" + ",".join(map(str, row.values())) + "\r\n").encode()
