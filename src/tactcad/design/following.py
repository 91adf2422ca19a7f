"""Values derived from the array if the design omits them: title, tolerances of the sheet, rigs' sizes.

Each size is the published set-up's as long as the array is no longer than the published one.
"""

from __future__ import annotations

from dataclasses import replace
from math import ceil
from typing import Any

from .materials import ALLOYS, LOT_SPREAD, sheet_tolerance
from .tree import Array, Element, Sheet, SheetMaterial

# The published set-up, mm and N; the cart is chosen around its sample.
SIDE, LENGTH, WIDTH, WHEEL_BASE, VACUUM, RINGS = 32.0, 70.0, 50.0, 50.0, 26.0, 3
BESIDE_THREADS = 54.0  # mm, width of a cart whose wheels clear the stages' threads
MOVING, STACK = 3.235, 21.0  # paper: what moves with the array, N; its stack of sheets and spacers
PER_STACK = 0.05  # N for a mm of stack more; chosen: twice what aluminium weighs, trimmed by the ballast
# mm2 of sheet in both rows' bodies and spacers, as published; kg/m3, 7075; m/s2
SECTION, ALUMINIUM, GRAVITY = 290.0, 2810.0, 9.80665
RUBBER = 6.0  # of the sample beyond the pads; chosen: what the published array has beyond the ends of a row
# Lid, and the widest circle of holes over which it bends by less than 2 um (plate theory, rigs/stiffness.py).
LID, STIFF = 6.0, 44.0
LARGEST_SIDE = 80.0  # of a sample whose cart clears the post; chosen: 1 mm less than fits
# Circle of holes: the largest O-ring of the table lies around 66, a lid ten hole diameters thick bears less.
LARGEST_VACUUM = 64.0


def followed(values: dict[str, Any]) -> dict[str, Any]:
    """The tables of a design with omitted values filled in."""
    array, sheet, element = values["array"], values["sheet"], values["element"]
    sample, grasping = values.get("sample"), values.get("grasping")
    done = dict(values)
    done["design"] = _filled(done["design"], title=_title(array))
    done["tolerance"] = _filled(done["tolerance"], **_as_bought(done["material"], sheet))
    if sample is not None:
        sample = done["sample"] = _filled(sample, side=_side(array, sheet, element))
        more = max(sample.side - SIDE, 0.0)
        vacuum = min(VACUUM + more, LARGEST_VACUUM)
        wheels = {
            "length": LENGTH + more,
            "width": max(WIDTH + more, BESIDE_THREADS),
            "wheel_base": WHEEL_BASE + more,
        }
        # as stiff under its own pressure as one of LID over a plenum of STIFF: diameter^4 over thickness^3
        lid = max(LID, float(ceil(LID * (vacuum / STIFF) ** (4 / 3))))
        holes = {"vacuum_diameter": vacuum, "rings": round(RINGS * vacuum / VACUUM), "lid_thickness": lid}
        for name, sizes in (("cart", wheels), ("holder", holes)):
            if values.get(name) is not None:
                done[name] = _filled(values[name], **sizes)
    if grasping is not None:
        done["grasping"] = _filled(grasping, moving_weight=_moving(array, sheet, done["material"].density))
    return done


def _filled(table: Any, **left_out: float | str) -> Any:
    return replace(table, **{name: v for name, v in left_out.items() if getattr(table, name) is None})


def _as_bought(material: SheetMaterial, sheet: Sheet) -> dict[str, float]:
    """The sheet's tolerances: Young's modulus and thickness."""
    row = ALLOYS.get(material.alloy)
    return {
        "youngs_modulus": row.spread["youngs_modulus"] if row else LOT_SPREAD,
        "sheet_thickness": sheet_tolerance(sheet.thickness, material.density),
    }


def _title(array: Array) -> str:
    """Rows by elements a row, such as 2 x 5, or 5 + 4 if they differ."""
    counts = [len(row) for row in array.row_arms]
    size = f"{len(counts)} x {counts[0]}" if len({*counts}) == 1 else " + ".join(map(str, counts))
    return f"Tactile array {size}"


def _side(array: Array, sheet: Sheet, element: Element) -> float:
    """Side of the sample: rubber beyond every pad, in whole 2 mm."""
    along = (max(map(len, array.row_arms)) - 1) / 2 * array.pitch + sheet.thickness / 2
    across = (array.row_pitch + element.pad_length) / 2
    return min(max(SIDE, 2.0 * ceil(max(along, across) + RUBBER)), LARGEST_SIDE)


def _moving(array: Array, sheet: Sheet, density: float) -> float:
    """Weight that moves with the array, N: the published weight, more for a longer stack or a denser sheet
    (kg/m3), in whole 0.1 N."""
    spacer = array.spacer if array.spacer is not None else array.pitch - sheet.thickness
    count = max(map(len, array.row_arms))
    stack = count * sheet.thickness + (count + 1) * spacer
    denser = SECTION * stack * max(density - ALUMINIUM, 0.0) * 1e-9 * GRAVITY
    more = PER_STACK * max(stack - STACK, 0.0) + denser
    return ceil(10 * (MOVING + more) - 1e-9) / 10 if more > 1e-9 else MOVING
