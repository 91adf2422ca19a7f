"""Elements of many designs at once as parameters of the closed forms.

`parts.layout.Layout` says the same of one design; tests hold the two together, and that no other field of a
design reaches a section.
"""

from __future__ import annotations

import re
from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from tactcad.design.load import paths
from tactcad.design.plain_numbers import NINE_DIGITS
from tactcad.design.tree import Design
from tactcad.mechanics.section import HingeSection
from tactcad.parts.layout import Layout

Floats = NDArray[np.float64]

# Fields whose arrays `VectorDesigns` takes; all others of a design leave its sections as they are.
TAKEN = re.compile(
    r"array\.row_arms\[\d+\]\[\d+\]|array\.row_pitch|sheet\.thickness|material\.(youngs_modulus|poisson)"
    r"|element\.(override\.\d+\.)?(hinge_thickness|hinge_length|fillet_radius|arm_height)"
    r"|element\.(body_height|pad_length|pad_height|seat_length)|rating\.friction"
)


class VectorDesigns:
    """One design, with arrays of numbers for some of its fields.

    Parameters
    ----------
    design
        Whose other values are kept.
    columns
        By the path of a field, its value in every design, in its unit.
    """

    def __init__(self, design: Design, columns: Mapping[str, Floats]) -> None:
        self.layout, self.columns, self._known = Layout(design), columns, paths(design)
        self.two_sided = design.element.sides == "two"

    def of(self, path: str) -> Floats:
        """The field in every design, or the one value that all have."""
        return self.columns[path] if path in self.columns else np.asarray(self._known[path], float)

    def _overridden(self, number: int, name: str) -> bool:
        own = f"element.override.{number}.{name}"
        return own in self.columns or self._known.get(own) is not None

    def _hinge(self, number: int, name: str) -> Floats:
        own = f"override.{number}." if self._overridden(number, name) else ""
        return self.of(f"element.{own}{name}")

    def _fillet_radius(self, number: int) -> Floats:
        """A full round of [element] stays one in an element whose slot alone is of another length."""
        radius = self._hinge(number, "fillet_radius")
        if not self._overridden(number, "fillet_radius"):
            radius = _filling(radius, self.of("element.hinge_length"))
        return _filling(radius, self._hinge(number, "hinge_length"))

    def _arm(self, number: int) -> Floats:
        place = self.layout.elements[number - 1]
        path = f"array.row_arms[{place.row - 1}][{place.index}]"
        return self.columns[path] if path in self.columns else np.asarray(place.arm)

    def section(self, number: int) -> HingeSection:
        """Section of the element of that number in every design."""
        length = self._hinge(number, "hinge_length")
        hinge_x = self._pad_inner + self._arm(number)
        return HingeSection(
            hinge_thickness=self._hinge(number, "hinge_thickness"),
            hinge_length=length,
            fillet_radius=self._fillet_radius(number),
            load_arm=self._arm(number) - self.of("element.pad_length") / 2,
            arm_height=self._hinge(number, "arm_height"),
            body_height=self.of("element.body_height"),
            body_length=np.round(self._clamp_edge - hinge_x - length / 2, 9),
            poisson=self.of("material.poisson"),
            youngs_modulus=self.of("material.youngs_modulus"),
            width=self.of("sheet.thickness"),
            two_sided=np.asarray(self.two_sided),
            pad_height=self.of("element.pad_height"),
            friction=self.of("rating.friction"),
        )

    @property
    def _pad_inner(self) -> Floats:
        return (self.of("array.row_pitch") - self.of("element.pad_length")) / 2

    @property
    def _clamp_edge(self) -> Floats:
        end = np.asarray(-np.inf)
        for place in self.layout.elements:
            half = self._hinge(place.number, "hinge_length") / 2
            end = np.maximum(end, self._pad_inner + self._arm(place.number) + half)
        return np.round(end + self.of("element.seat_length"), 6)


def _filling(radius: Floats, length: Floats) -> Floats:
    """`plain_numbers.filling_radius` of arrays."""
    return np.where(np.abs(2 * radius - length) <= NINE_DIGITS * length, length / 2, radius)
