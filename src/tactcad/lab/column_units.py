"""Warnings about columns whose unit may differ from their name. They are not refused: the data may be
right."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence

from tactcad.design.messages import CheckFailure
from tactcad.design.tree import Design
from tactcad.lab.calibration import ElementCalibration
from tactcad.lab.load_cell import LoadCell
from tactcad.lab.readings import CalibrationReadings

FORCES = {"N": 1.0, "mN": 1e-3, "kN": 1e3, "g": 9.80665e-3, "kg": 9.80665}  # N; of g and kg the weight
LENGTHS, VOLTAGES = {"mm": 1.0, "um": 1e-3, "m": 1e3, "inch": 25.4}, {"V": 1.0, "mV": 1e-3, "uV": 1e-6}
UNITS = {"displacement": LENGTHS, "force": FORCES, "load": FORCES, "signal": VOLTAGES}
# Largest unsuspicious factors from the expected value; chosen. A hinge 20 % too thick is 1.7 times as stiff;
# the amplifier in use may have another gain; some elements, or all on their stops, bear part of the load.
STIFFNESS, SIGNAL, LOAD = 5.0, 30.0, 30.0


Pairs = Sequence[tuple[float, float]]  # found and expected, of each element


def _far(pairs: Pairs, factor: float) -> tuple[float, float] | None:
    """The middle pair, if its ratio is beyond the factor."""
    if not pairs:
        return None
    found, expected = sorted(pairs, key=lambda pair: pair[0] / pair[1])[len(pairs) // 2]
    return None if 1 / factor < found / expected < factor else (found, expected)


def unlikely(
    what: str, powers: Mapping[str, int], pairs: Pairs, unit: str, factor: float, right: Collection[str] = ()
) -> list[str]:
    """A warning if a product of columns, each with its power, differs from the expected value by more than
    the factor, with the units that would explain it; columns that another product shows to be `right` are not
    blamed. The median of the `pairs` decides."""
    if (far := _far(pairs, factor)) is None:
        return []
    (found, expected), guesses = far, []
    ratio = found / expected
    for column in (name for name in powers if name not in right):
        power = powers[column]
        quantity, _, given = column.partition("_")
        own = UNITS[quantity].get(given, 1.0)
        left = {name: ratio * (size / own) ** power for name, size in UNITS[quantity].items()}
        guesses += [f"{column} in {name}" for name, rest in left.items() if 1 / 3 < rest < 3]  # kg is 10 N
    hint = f" ({' or '.join(guesses)}?)" if guesses else ""
    said = f"{what} {found:.3g} {unit}, expected about {expected:.3g} {unit}{hint}"
    return [f"columns {' and '.join(powers)}: {said}"]


def against_design(
    readings: CalibrationReadings, rows: Sequence[ElementCalibration], cell: LoadCell, design: Design
) -> list[str]:
    """Warnings where stiffness or signal of a calibration is far from what its design predicts."""
    from tactcad.lab.array_estimate import estimate  # a calibration without a design needs no part
    from tactcad.mechanics.ladder import DEFAULT_RUNG
    from tactcad.mechanics.readout import volts_per_strain
    from tactcad.parts.array.hinge_section import design_readout
    from tactcad.parts.array.layout import Layout

    force_below_yield = 1e-6  # N: no strain is estimated above yield
    try:
        estimates = {e.number: e for e in estimate(Layout(design), DEFAULT_RUNG, force_below_yield)}
    except CheckFailure:  # beyond the estimator's range
        return []
    own = [(r, estimates[r.element]) for r in rows if r.element in estimates]
    x, force, signal = readings.columns
    volts = float(volts_per_strain(design.gauge.factor, design_readout(design)))
    soft = 1 / cell.stiffness  # the load cell's compliance in series: elements stiffer than it show little
    k = [(1 / (1 / r.stiffness.value + soft), 1 / (1 / e.stiffness + soft)) for r, e in own]
    v = [(abs(r.signal_per_force.value), volts * e.gauge_strain / e.force) for r, e in own if e.gauge_strain]
    strange = [str(r.element) for r in rows if r.element not in estimates]
    absent = [f"elements {', '.join(strange)}: not in design {design.name}"] if strange else []
    # a force in another unit shows in both
    k_right = () if _far(v, SIGNAL) or not v else (force,)
    v_right = () if _far(k, STIFFNESS) or not k else (force,)
    return [
        *absent,
        *unlikely("stiffness with the load cell", {force: 1, x: -1}, k, "N/mm", STIFFNESS, k_right),
        *unlikely("sensitivity", {signal: 1, force: -1}, v, "V/N", SIGNAL, v_right),
    ]
