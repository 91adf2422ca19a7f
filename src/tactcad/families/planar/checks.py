"""Checks of planar designs besides those of all families."""

from __future__ import annotations

from collections.abc import Iterator

from tactcad.checks.check import Check
from tactcad.parts.language.finding import Finding

from .cell_board import why_none
from .cell_layout import PlanarLayout
from .cell_tables import PlanarDesign
from .sensor import rows


def check_strength(design: PlanarDesign) -> Iterator[Finding]:
    """A flag for each kind of cells rated below the force asked for, for finite life at the rated force, and
    for pads whose K is not linear up to it."""
    layout = PlanarLayout(design)
    every, r = [*zip(rows(layout, "", None), layout.elements)], design.rating
    shown = {row.kind: (row, e.designator) for row, e in reversed(every)}  # the first of each kind
    for kind in layout.used:
        row, first = shown[kind.name]
        rated = row.rated_force
        if rated < r.force * (1.0 - 1e-9):
            message = (
                f"{kind.name} cells are rated at {rated:.3g} N with a shear of {r.shear:g} of it, not at the "
                f"{r.force:g} N asked for: there a beam's root would have less than its safety of "
                f"{r.yield_factor:g} against yield"
            )
            yield Finding("planar-rated-force", "flag", first, (), rated, r.force, message)
        if row.fatigue_factor < 1.0:
            endured = row.fatigue_factor * rated
            message = (
                f"{kind.name} cells have finite life at their rated force of {rated:.3g} N (Goodman factor "
                f"below 1); put on and off, {endured:.3g} N are borne as often as the fatigue strength holds"
            )
            yield Finding("planar-fatigue", "flag", first, (), endured, rated, message)
        if row.linear_force < rated:
            message = (
                f"{kind.name} cells stiffen by {100 * r.linearity:g} % at {row.linear_force:.3g} N, below "
                f"their rated force of {rated:.3g} N: readings beyond it are to be corrected"
            )
            yield Finding("planar-linear", "flag", first, (), row.linear_force, rated, message)


def check_board(design: PlanarDesign) -> Iterator[Finding]:
    """A flag where no board is laid out, with the reason."""
    if why := why_none(PlanarLayout(design)):
        yield Finding("planar-board", "flag", design.name, (), 0, 1, f"no circuit board is laid out: {why}")


CHECKS = (
    Check("planar board", "design", lambda design, _: check_board(design), place=11, quick=True),
    Check("planar strength", "design", lambda design, _: check_strength(design), place=10, quick=True),
)
