"""FreeCAD's own document of a design (`tactcad review --freecad`), opened again and compared with the bills
of materials, the manifest and the parts' colours."""

from __future__ import annotations

import json
import re
from collections import Counter
from math import isclose
from pathlib import Path

import window

from tactcad.review.freecad import profile, program

INSIDE = Path(__file__).with_name("colours_in_freecad.py")
AGREES = 1e-6  # share of a volume


def colours(path: Path) -> dict | None:
    """Colour of every part as the window program shows it; None if it ended without telling."""
    return window.asked(program(), INSIDE, [path], profile())


def document_faults(
    found: dict,
    shown: dict | None,
    bills: dict[str, list[dict]],
    parts: dict[str, dict],
    want: dict[str, str],
) -> list[str]:
    """Faults of the document.

    Parameters
    ----------
    found
        Output of `in_freecad.py` for the document.
    shown
        Output of `colours`.
    bills
        Rows of the bill of materials by scene.
    parts
        Rows of the manifest by part number.
    want
        Colours (#rrggbb) by part number.
    """
    wrong = []
    for scene, bill in bills.items():
        meant = Counter(
            (d, row["part_no"]) for row in bill if row["has_solid"] for d in row["designators"].split()
        )
        got = Counter((p["label"], p["part"]) for p in found["placed"] if scene in p["scene"])
        wrong += [f"{scene}: {d} of {number} is not in the document" for d, number in meant - got]
        wrong += [f"{scene}: the document has {d} of {number}" for d, number in got - meant]
    for p in found["placed"]:
        volume = parts[p["part"]]["volume_mm3"]
        if not p["valid"] or not isclose(p["volume"], volume, rel_tol=AGREES):
            wrong.append(f"{p['label']}: volume {p['volume']:.9g}, the manifest {volume:.9g}")
    if not any(p["at"] != p["apart"] for p in found["placed"]):
        wrong.append("nothing moves when the document is exploded")
    if shown is None:
        return [*wrong, "FreeCAD's window program ended without a report"]
    for number, colour in want.items():
        if shown["colours"].get(number) != colour:
            wrong.append(f"{number} is {shown['colours'].get(number)} in FreeCAD, meant {colour}")
    return wrong


def bills_of(folder: Path) -> dict[str, list[dict]]:
    """Rows of every bill of an export by scene."""
    return {
        re.sub(r"^bom-?", "", path.stem) or "array": json.loads(path.read_text())["rows"]
        for path in folder.glob("bom*.json")
    }
