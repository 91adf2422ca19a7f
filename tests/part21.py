"""A reader of STEP text (ISO 10303-21) of our own, which shares nothing with the kernel's."""

from __future__ import annotations

import re

import numpy as np


class Text:
    """A STEP file's DATA section: entity number -> its text, with the few look-ups that the tests need."""

    def __init__(self, data: bytes) -> None:
        self.text = data.decode("ascii")
        body = self.text[self.text.index("DATA;") :]
        self.entities = {int(n): line for n, line in re.findall(r"^#(\d+)=(.*);$", body, re.MULTILINE)}

    def of(self, kind: str) -> list[int]:
        return [n for n, line in self.entities.items() if re.match(rf"\(?\s*{kind}\s*\(", line)]

    def references(self, n: int) -> list[int]:
        return [int(r) for r in re.findall(r"#(\d+)", re.sub(r"'(?:[^']|'')*'", "", self.entities[n]))]

    def words(self, n: int) -> list[str]:
        return re.findall(r"'((?:[^']|'')*)'", self.entities[n])

    def numbers(self, n: int) -> list[float]:
        return [
            float(x)
            for x in re.findall(r"[-+]?\d*\.\d*(?:E[-+]?\d+)?", re.sub(r"'[^']*'", "", self.entities[n]))
        ]

    def product_of(self, definition: int) -> str:
        formation = self.references(definition)[0]
        return self.words(self.references(formation)[0])[0]

    def axes(self, n: int) -> np.ndarray:
        """4 x 4 matrix of an AXIS2_PLACEMENT_3D."""
        at, z, x = (np.array(self.numbers(r)) for r in self.references(n))
        m = np.eye(4)
        m[:3, 0], m[:3, 1], m[:3, 2], m[:3, 3] = x, np.cross(z, x), z, at
        return m

    def placements(self) -> dict[str, tuple[str, np.ndarray]]:
        """Designator -> product, matrix: from each instance along its shape's representation relationship."""
        found = {}
        for shape in self.of("CONTEXT_DEPENDENT_SHAPE_REPRESENTATION"):
            relationship, shape_definition = self.references(shape)
            usage = next(r for r in self.references(shape_definition) if "NEXT_ASSEMBLY" in self.entities[r])
            line = self.entities[relationship]
            operator = int(
                re.search(r"REPRESENTATION_RELATIONSHIP_WITH_TRANSFORMATION\s*\(\s*#(\d+)", line)[1]
            )
            first, second = self.references(operator)
            matrix = self.axes(second) @ np.linalg.inv(self.axes(first))
            found[self.words(usage)[0]] = (self.product_of(self.references(usage)[1]), matrix)
        return found
