"""The inspection sheet: a CSV file with one row for every dimension of every numbered element, to fill in and
send back.

The first line names the columns and every row says which design and revision it belongs to, so that a
spreadsheet can sort, filter and print it. `measured` and `uncertainty_k2` are left blank;
tactcad.lab.inspection_sheet reads it back.
"""

from __future__ import annotations

import csv
import io

from tactcad.parts.layout import Layout
from tactcad.parts.measurements import measurements

NAME = "inspection.csv"
COLUMNS = (
    "design",
    "revision",
    "element",
    "part_no",
    "characteristic",
    "key",
    "nominal",
    "lower",
    "upper",
    "unit",
    "measured",
    "uncertainty_k2",
    "where",
    "how",
)
UNIT = "mm"


def inspection_bytes(layout: Layout) -> bytes:
    """The sheet (RFC 4180, UTF-8), rows by element number."""
    text = io.StringIO(newline="")
    writer = csv.writer(text)
    writer.writerow(COLUMNS)
    identity = layout.design.design
    for place, part_no, dimensions in measurements(layout):
        for m in dimensions:
            writer.writerow(
                (
                    identity.name,
                    identity.revision,
                    place.designator,
                    part_no,
                    m.name,
                    "yes" if m.key else "",
                    m.nominal,
                    m.lower,
                    m.upper,
                    UNIT,
                    "",
                    "",
                    m.where,
                    m.how,
                )
            )
    return text.getvalue().encode()
