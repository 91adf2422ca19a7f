"""Materials of the sensing element: the table of those known by name, a design's differences from it, and a
sheet's default thickness tolerance.
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cache
from math import isclose
from typing import Any

from .fields import present
from .messages import InputError, did_you_mean, in_brackets
from .text_values import data_records, data_rows

# A value that differs by more than this from the named material's belongs to another material.
MOST_DIFFERENCE = 0.10
# Relative deviation of a lot's Young's modulus for a label without a row: chosen, the widest of the wrought
# alloys but the cold-rolled.
LOT_SPREAD = 0.02
# mm, plus and minus, of sheet that EN 485-4 does not hold for; chosen: measure it.
OTHER_SHEET = 0.1
# Properties that a design may give, by the table's columns; a material of one's own may lack the OPTIONAL
# ones.
PROPERTIES = ("youngs_modulus", "poisson", "density", "yield_strength", "fatigue_strength")
OPTIONAL = ("tensile_strength", "conductivity", "magnetic")
MAGNETIC = ("no", "weakly", "yes")
NAMED_AFTER = {"youngs_modulus": "Young's modulus", "poisson": "Poisson's ratio"}
UNITS = {"poisson": "", "density": " kg/m3"}  # others: MPa
# kg/m3: wrought alloys of these families lie between, and no other metal that is wire-cut does.
FAMILIES = {
    "aluminium": (2600.0, 2900.0),
    "titanium": (4300.0, 4900.0),
    "steel": (7500.0, 8150.0),
    "copper": (8200.0, 9000.0),
}


@dataclass(frozen=True)
class Alloy:
    """A sheet material.

    youngs_modulus, yield_strength, fatigue_strength (fully reversed) and tensile_strength in MPa, density in
    kg/m3, conductivity in W/(m K). modulus_per_kelvin: relative fall of E per kelvin, 1/K; None for a label
    without a row. `tensile_strength` is None if it is not known; the Goodman line then ends at the yield
    strength, which is Soderberg's. spread: relative, by property.
    """

    name: str
    youngs_modulus: float
    poisson: float
    density: float
    yield_strength: float
    fatigue_strength: float
    source: str
    tensile_strength: float | None = None
    conductivity: float | None = None
    magnetic: str | None = None
    modulus_per_kelvin: float | None = None
    standard: str = ""
    temper: str = ""
    words: str = ""
    fatigue_cycles: float | None = None  # at which the fatigue strength holds
    spread: dict[str, float] = field(default_factory=dict)


@dataclass(frozen=True)
class Difference:
    """A property for which a design and the table's row of its material differ. origin: the value's
    source.
    """

    alloy: str
    name: str
    value: float
    table: float
    origin: str

    @property
    def relative(self) -> float:
        return self.value / self.table - 1.0

    def __str__(self) -> str:
        side = "above" if self.relative > 0 else "below"
        unit = UNITS.get(self.name, " MPa")
        name = NAMED_AFTER.get(self.name, self.name.replace("_", " "))
        return f"{name} {self.value:g}{unit} is {abs(self.relative):.1%} {side} {self.alloy}'s {self.table:g}"


ALLOYS = data_records(__file__, "materials", Alloy)
# What the water of a wire-cutting machine does to a metal that its supply makes the anode; trade practice,
# not measured. A supply without mean voltage (anti-electrolysis) prevents it.
ELECTROLYSIS = {"aluminium": "pits", "titanium": "discolours", "steel": "corrodes", "copper": "tarnishes"}


def family(density: float) -> str:
    """Metal with that density (kg/m3): aluminium, titanium, steel or copper; "" for none."""
    return next((name for name, (low, high) in FAMILIES.items() if low <= density <= high), "")


PLATE_ALLOYS = tuple(name for name, alloy in ALLOYS.items() if family(alloy.density) == "aluminium")


def described() -> str:
    """The names of the table, each with its description."""
    return ", ".join(f"{name} ({row.words})" if row.words else name for name, row in ALLOYS.items())


def meant(word: str) -> str:
    """ "did you mean A or B?" for alloys whose name begins so or whose description matches, else the
    nearest."""
    wanted = word.casefold()
    found = [
        n for n, row in ALLOYS.items() if n.casefold().startswith(wanted) or wanted in row.words.casefold()
    ]
    return f"did you mean {' or '.join(found)}?" if found and wanted else did_you_mean(word, ALLOYS)


def alloy(name: str, where: str = "material.alloy") -> Alloy:
    """The table's row of that name; raises InputError naming the legal ones."""
    if name not in ALLOYS:
        legal = f"one of {described()}{in_brackets(meant(name))}"
        raise InputError(where, "unknown alloy", value=name, legal=legal)
    return ALLOYS[name]


def leaf_conductivity(given: float | None) -> float:
    """Thermal conductivity of the sheet, W/(m K); if it is not known the table's least."""
    return given if given is not None else min(present(row.conductivity) for row in ALLOYS.values())


def modulus_per_kelvin(name: str) -> float:
    """Share of Young's modulus by which it falls per kelvin, 1/K; for a label of its own the table's largest
    one.
    """
    row = ALLOYS.get(name)
    return max(present(r.modulus_per_kelvin) for r in ([row] if row else ALLOYS.values()))


def completed(name: str, given: Mapping[str, Any]) -> dict[str, Any]:
    """The properties of a design's material: those given, else the table's. Raises InputError if the name
    is not in the table and a property is missing, or is one of the table's in another spelling."""
    row = ALLOYS.get(name)
    if row:
        return {key: getattr(row, key) if value is None else value for key, value in given.items()}
    labels = f"{described()}; or a label of its own with {', '.join(PROPERTIES)}"
    for known in ALLOYS:
        if re.search(_spelled(known), name, re.IGNORECASE):
            what = f"holds {known}, a name of the table: a label of its own must not"
            raise InputError("material.alloy", what, value=name, legal=labels)
    missing = [key for key in PROPERTIES if given[key] is None]
    if missing:
        verb = "is" if len(missing) == 1 else "are"
        what = f"not in the table of materials, and {', '.join(missing)} {verb} not given"
        raise InputError("material.alloy", what, value=name, legal=labels + in_brackets(meant(name)))
    return dict(given)


def _spelled(name: str) -> str:
    """A pattern for the name with any or no marks between its letters and digits, as a word of its own."""
    return r"(?<![0-9])" + r"[\W_]*".join(re.findall("[0-9a-zA-Z]", name)) + r"(?![0-9a-zA-Z])"


def differences(name: str, given: Mapping[str, Any], origin: Mapping[str, str]) -> tuple[Difference, ...]:
    """Differences between a design's material and the table's row of its name; none for a label without a
    row.

    Raises InputError if a value differs from the row by more than its spread without a source in `origin`,
    or by more than MOST_DIFFERENCE.
    """
    row = ALLOYS.get(name)
    if row is None:
        return ()
    if given["magnetic"] != row.magnetic:
        raise InputError(
            "material.magnetic", f"not {name}'s", value=given["magnetic"], legal=f"{row.magnetic!r}"
        )
    differing, other = [], []
    for key, spread in row.spread.items():
        value, table = given[key], getattr(row, key)
        if isclose(value, table, rel_tol=1e-9):
            continue
        path = f"material.{key}"
        difference = Difference(name, key, value, table, origin.get(path, ""))
        off = abs(difference.relative) * (1 - 1e-9)
        if off > MOST_DIFFERENCE:
            other.append(difference)
        elif off > spread and not difference.origin:
            what = f"{difference}, more than its spread of {spread:.1%}"
            legal = f'within it, or with the value\'s source in [origin] as "{path}" = "..."'
            raise InputError(path, what, value=value, legal=legal)
        differing.append(difference)
    if other:
        legal = f"within {MOST_DIFFERENCE:.0%} of {'it' if len(other) == 1 else 'each'}"
        what = f"not {name}: {'; '.join(map(str, other))}"
        legal = f"{legal}, left out ({name}'s are taken), or a label of its own in material.alloy"
        raise InputError(f"material.{other[0].name}", what, value=other[0].value, legal=legal)
    return tuple(differing)


def sheet_tolerance(thickness: float, density: float) -> float:
    """Plus and minus mm of a rolled sheet (mm) of that density (kg/m3): EN 485-4 for aluminium."""
    if family(density) != "aluminium":
        return OTHER_SHEET
    return next(tolerance for to, tolerance in _rows() if thickness <= to)


@cache
def _rows() -> tuple[tuple[float, float], ...]:
    rows = data_rows(__file__, "sheet_thickness")
    return tuple((float(row["to"]), float(row["tolerance"])) for row in rows)
