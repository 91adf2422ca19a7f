"""One make of each part that is bought by description, as an example: data/example_makes.csv."""

from __future__ import annotations

from fnmatch import fnmatchcase

from tactcad.design.text_values import data_rows

from ..language.description import Part

ROWS = data_rows(__file__, "example_makes")
STANDARDS = ("ISO ", "DIN ")


def example(part: Part) -> str:
    """The bill's words on a make of the part and on its drawing; "" if a standard or a maker's number names
    the part, or nobody sells it by itself."""
    order = part.purchase
    if part.process != "bought" or order is None or order.mpn or order.designation.startswith(STANDARDS):
        return ""
    row = next((row for row in ROWS if fnmatchcase(part.part_no, row["part_no"])), None)
    return f"example: {row['example']}; drawing {row['drawing']}" if row else "no example found"
