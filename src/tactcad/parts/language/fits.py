"""Limits by the standards' codes: ISO 286-1 tolerance classes ("H7", "js15"), ISO 2768-1 general ones."""

from __future__ import annotations

import re

from .tables import rows

_GRADES, _DEVIATIONS, _GENERAL = (rows(__file__, name) for name in ("it_grades", "deviations", "general"))
_CODE = re.compile(r"(js|JS|[a-hk-pA-HK-P])(\d{1,2})")
# Shafts whose fundamental deviation is the upper one; the others' is the lower one.
_BELOW = "defgh"


def _row(table: list[dict[str, str]], size: float, what: str) -> dict[str, str]:
    if size <= 0:
        raise ValueError(f"{what}: a size of {size:g} mm; legal: more than 0")
    for row in table:
        if size <= float(row["to"]):
            return row
    raise ValueError(f"{what}: no limits for {size:g} mm; legal: up to {table[-1]['to']} mm")


def deviations(code: str, size: float) -> tuple[float, float]:
    """Lower and upper deviation of an ISO 286 tolerance class, mm.

    Parameters
    ----------
    code
        Fundamental deviation and grade, capitals for holes: d to p, D to P, js, JS.
    size
        Nominal size, mm.

    Raises
    ------
    ValueError
        If the tables do not have the code or the size.
    """
    match = _CODE.fullmatch(code)
    letter, grade = (match[1], match[2]) if match else ("", "")
    width_row, shaft_row = _row(_GRADES, size, code), _row(_DEVIATIONS, size, code)
    hole = letter.isupper()
    if grade not in width_row or letter.lower() not in {"js", *shaft_row} - {"to"}:
        raise ValueError(f"{code!r} is not in the tables; legal: d to p and D to P, js, JS, grades 5 to 16")
    width = int(width_row[grade])
    if letter.lower() == "js":
        return (-width / 2e3, width / 2e3)
    if letter == "k" and int(grade) > 7:
        return (0.0, width / 1e3)
    own = int(shaft_row[letter.lower()])
    lower, upper = (own - width, own) if letter.lower() in _BELOW else (own, own + width)
    if not hole:
        return (lower / 1e3, upper / 1e3)
    # press holes of fine grades lie higher by the step to the next finer grade (ISO 286-1, 4.1.2.3)
    fine = letter in "KMNP" and size > 3 and int(grade) <= (7 if letter == "P" else 8) and grade != "5"
    raised = width - int(width_row[str(int(grade) - 1)]) if fine else 0
    return ((raised - upper) / 1e3, (raised - lower) / 1e3)


def general(size: float, grade: str = "m") -> float:
    """Plus and minus of a linear size without its own tolerance, mm (ISO 2768-1:1989, fine, medium, coarse).

    Raises ValueError if the table ends.
    """
    return float(_row(_GENERAL, abs(size), f"ISO 2768-{grade}")[grade])
