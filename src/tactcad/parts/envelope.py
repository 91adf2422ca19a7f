"""Detail levels: `full` for review, `envelope` for collision and layout."""

from __future__ import annotations

from dataclasses import replace

from .description import Extrusion, ModelFile, Part

DETAILS = ("full", "envelope")


def envelope(part: Part) -> Part:
    """The part without holes, pockets and limits: a shape that contains the part. Its mass stays the part's.

    It is a reference shape: no cut file or drawing is made of it.
    """
    if isinstance(part.body, ModelFile):
        return part
    body = replace(part.body, openings=()) if isinstance(part.body, Extrusion) else part.body
    return replace(
        part,
        body=body,
        features=(),
        characteristics=(),
        geometric=(),
        datums=(),
        mass_override=part.mass,
        process=part.process if part.bought else "reference",
    )
