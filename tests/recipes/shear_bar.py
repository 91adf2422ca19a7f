"""Bar that pushes the pads along the arms: a plate on the array mount, its edge at the pads' sides."""

from __future__ import annotations

from collections.abc import Iterator

from tactcad.contour import rectangle
from tactcad.design.tree import Design
from tactcad.mechanics.statics import Beam

from ..array.layout import Layout
from ..array.stiffness_table import TENTH, Deflection
from ..language.description import Extrusion, Part
from ..language.finding import Finding
from ..language.stock import plate, plate_material
from ..rules.rule import at_least, fits

THICK = 2.0  # mm; chosen: under the gap between facing pads
HIGH, LONG = 30.0, 60.0


def shear_bar(design: Design) -> Part:
    """Local z along the push."""
    body = Extrusion(rectangle(-LONG / 2, 0.0, LONG / 2, HIGH), design.shear.thickness)
    return plate(design, "shear-bar", "Shear bar", body, ())


@fits
def bar_enters_the_gap(layout: Layout) -> Iterator[Finding]:
    gap = 2 * layout.pad_inner
    yield from at_least("array.row_pitch", "the shear bar does not enter", gap, layout.design.shear.thickness)


def shear_lines(design: Design) -> Iterator[Deflection]:
    alloy, s = plate_material(design), design.shear
    bar = Beam(HIGH, LONG, s.thickness, 70e3, 0.33)
    yield Deflection(
        "shear-calibration",
        f"shear bar of {alloy}",
        "held at its foot",
        s.force,
        "shear.force",
        1e3 * s.force * bar.cantilever(),
        1e3 * TENTH * s.travel,
        "a tenth of shear.travel",
        ("shear.thickness",),
    )
